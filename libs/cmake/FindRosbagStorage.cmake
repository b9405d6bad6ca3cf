# Reading and writing ROS 1 bags: the target RosbagStorage::RosbagStorage. rosbag_storage's own CMake file runs a
# Python package generator; its libraries are all that is needed.
set(parts rosbag_storage cpp_common rostime roscpp_serialization console_bridge roslz4 bz2)
# Its header includes pluginlib's, whose Debian packages each lie one folder deeper than they are included by.
set(headers pluginlib/class_loader.hpp class_loader/class_loader.hpp rcpputils/shared_library.hpp rcutils/logging_macros.h
            ament_index_cpp/get_resource.hpp)

set(libraries "")
foreach(part ${parts})
  find_library(ROSBAG_${part} ${part})
  list(APPEND libraries ROSBAG_${part})
  mark_as_advanced(ROSBAG_${part})
endforeach()
set(includes "")
foreach(header ${headers})
  get_filename_component(package ${header} DIRECTORY)
  find_path(ROSBAG_${package}_INCLUDE ${header} PATH_SUFFIXES ${package})
  list(APPEND includes ROSBAG_${package}_INCLUDE)
  mark_as_advanced(ROSBAG_${package}_INCLUDE)
endforeach()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(RosbagStorage REQUIRED_VARS ${libraries} ${includes})
if(RosbagStorage_FOUND AND NOT TARGET RosbagStorage::RosbagStorage)
  add_library(RosbagStorage::RosbagStorage INTERFACE IMPORTED)
  foreach(library ${libraries})
    target_link_libraries(RosbagStorage::RosbagStorage INTERFACE ${${library}})
  endforeach()
  foreach(include ${includes})
    target_include_directories(RosbagStorage::RosbagStorage INTERFACE ${${include}})
  endforeach()
endif()
