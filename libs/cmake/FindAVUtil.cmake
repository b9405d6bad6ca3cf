# AVUtil::AVUtil: the library by which FFmpeg, which OpenCV reads videos with, says what is wrong with one.
find_path(AVUTIL_INCLUDE_DIR libavutil/log.h)
find_library(AVUTIL_LIBRARY avutil)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(AVUtil REQUIRED_VARS AVUTIL_LIBRARY AVUTIL_INCLUDE_DIR)
if(AVUtil_FOUND AND NOT TARGET AVUtil::AVUtil)
  add_library(AVUtil::AVUtil UNKNOWN IMPORTED)
  set_target_properties(AVUtil::AVUtil PROPERTIES IMPORTED_LOCATION ${AVUTIL_LIBRARY}
                                                  INTERFACE_INCLUDE_DIRECTORIES ${AVUTIL_INCLUDE_DIR})
endif()
mark_as_advanced(AVUTIL_LIBRARY AVUTIL_INCLUDE_DIR)
