# Mesa's off-screen rendering, which Debian ships without a CMake or pkg-config file: the target OSMesa::OSMesa.
find_library(OSMESA_LIBRARY OSMesa)
find_path(OSMESA_INCLUDE GL/osmesa.h)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OSMesa REQUIRED_VARS OSMESA_LIBRARY OSMESA_INCLUDE)
if(OSMesa_FOUND AND NOT TARGET OSMesa::OSMesa)
  add_library(OSMesa::OSMesa UNKNOWN IMPORTED)
  set_target_properties(OSMesa::OSMesa PROPERTIES IMPORTED_LOCATION ${OSMESA_LIBRARY}
                                                  INTERFACE_INCLUDE_DIRECTORIES ${OSMESA_INCLUDE})
endif()
mark_as_advanced(OSMESA_LIBRARY OSMESA_INCLUDE)
