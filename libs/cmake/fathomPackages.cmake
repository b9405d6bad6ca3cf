# Which package brings the target that a room is linked to. One table for the build and for who uses the installed
# libraries.

# fathom_package_of(TARGET VARIABLE): "Ceres" of "Ceres::ceres"; what find_package() takes.
function(fathom_package_of target variable)
  if(target MATCHES "^(mrpt)::(.*)$")
    set(package mrpt-${CMAKE_MATCH_2})
  elseif(target MATCHES "^opencv_(.*)$")
    set(package OpenCV COMPONENTS ${CMAKE_MATCH_1})
  elseif(target MATCHES "^(.*)::")
    set(package ${CMAKE_MATCH_1})
  elseif(target STREQUAL "ceres")
    set(package Ceres)
  elseif(target STREQUAL "OpenMeshCore")
    set(package OpenMesh)
  else()
    set(package ${target})
  endif()
  set(${variable} ${package} PARENT_SCOPE)
endfunction()
