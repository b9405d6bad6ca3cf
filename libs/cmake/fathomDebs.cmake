# `cpack -G DEB` in the build folder, once `fathom` and `manual` are built: fathom_*.deb, the program with what it reads,
# and libfathom-dev_*.deb, headers and static libraries.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_COMPONENTS_ALL program development)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
                                                WORLD_READ WORLD_EXECUTE)
set(CPACK_PACKAGE_CONTACT "the fathom authors <fathom@packages.invalid>")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME fathom)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS gnuplot-nox)  # the reports' plots
# What the program loads itself, when a rawlog holds their observations (recording/mrpt_classes.h).
string(REGEX MATCH "^[0-9]+[.][0-9]+" mrpt_version "${mrpt-obs_VERSION}")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "libmrpt-maps${mrpt_version}, libmrpt-vision${mrpt_version}")
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "localizes underwater robots and diagnoses their sensor models
Reads recordings (MRPT rawlogs) of a dive: inertial sensor, Doppler velocity
log, pressure, camera. Estimates the robot's path, reproduces the dive in
simulation, and tells which physics the sensors' models leave out.")

# The filter's user shall not have to install a renderer: what only some rooms need is recommended.
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libfathom-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
    "libblis-serial-dev, libceres-dev, libeigen3-dev, libmrpt-obs-dev, libmrpt-topography-dev, libtbb-dev, libyaml-cpp-dev, libzstd-dev, nlohmann-json3-dev, zlib1g-dev")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_RECOMMENDS
    "libapriltag-dev, libavutil-dev, libgeometry-msgs-dev, libnav-msgs-dev, libopencv-contrib-dev, libopencv-dev, libopenmesh-dev, libosmesa6-dev, librosbag-storage-dev, libsensor-msgs-dev, libtf2-msgs-dev")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "underwater localization and its diagnosis, as libraries
Headers, static libraries and the CMake package for programs of one's own:
find_package(fathom COMPONENTS localization) and the like. Examples are in
/usr/share/doc/libfathom-dev/examples.")

# What Debian wants of every package.
configure_file(${PROJECT_SOURCE_DIR}/scripts/debian/changelog.in ${PROJECT_BINARY_DIR}/changelog)
execute_process(COMMAND gzip -9nf ${PROJECT_BINARY_DIR}/changelog)
foreach(component program development)
  string(TOUPPER ${component} upper)
  set(folder ${CMAKE_INSTALL_DATADIR}/doc/${CPACK_DEBIAN_${upper}_PACKAGE_NAME})
  install(FILES LICENSE RENAME copyright DESTINATION ${folder} COMPONENT ${component})
  install(FILES ${PROJECT_BINARY_DIR}/changelog.gz DESTINATION ${folder} COMPONENT ${component})
endforeach()

include(CPack)
