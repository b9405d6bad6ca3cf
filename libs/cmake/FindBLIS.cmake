# BLIS::BLIS: the BLAS that picks its kernels by what the processor can do (of AMD's newer ones core/linear_algebra.cpp
# does), and may be called by several threads at once.
find_path(BLIS_INCLUDE_DIR cblas.h)
find_library(BLIS_LIBRARY blis)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(BLIS REQUIRED_VARS BLIS_LIBRARY BLIS_INCLUDE_DIR)
if(BLIS_FOUND AND NOT TARGET BLIS::BLIS)
  add_library(BLIS::BLIS UNKNOWN IMPORTED)
  set_target_properties(BLIS::BLIS PROPERTIES IMPORTED_LOCATION ${BLIS_LIBRARY}
                                              INTERFACE_INCLUDE_DIRECTORIES ${BLIS_INCLUDE_DIR})
endif()
mark_as_advanced(BLIS_LIBRARY BLIS_INCLUDE_DIR)
