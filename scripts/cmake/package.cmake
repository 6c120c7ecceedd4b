# `cmake --build --target package` (or scripts/package.sh, which builds no tests for it) makes mosbench_*.deb
# (program, library, headers, manual), mosbench-hdf5_*.deb (the module for .h5 files) and
# python3-mosbench_*.deb. dpkg-shlibdeps finds what they depend on.

# Run by CPack on what it has gathered: Debian's manual pages are compressed.
if(CPACK_TEMPORARY_INSTALL_DIRECTORY)
  file(GLOB_RECURSE pages ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/mosbench*.1)
  if(pages)
    execute_process(COMMAND gzip -9n ${pages} COMMAND_ERROR_IS_FATAL ANY)
  endif()
  return()
endif()

find_program(MOSBENCH_DPKG_SHLIBDEPS dpkg-shlibdeps)
mark_as_advanced(MOSBENCH_DPKG_SHLIBDEPS)
if(NOT MOSBENCH_DPKG_SHLIBDEPS)
  return()
endif()
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "The mosbench authors <mosbench@localhost>")
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_OUTPUT_FILE_PREFIX packages)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "moving object segmentation of LiDAR scans")
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_FILE})
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

# What Debian wants of every package: its licence and what changed, in a format of its own.
set(documents ${PROJECT_BINARY_DIR}/generated/package)
configure_file(LICENSE ${documents}/copyright COPYONLY)
configure_file(CHANGELOG.md ${documents}/NEWS COPYONLY)
string(TIMESTAMP today "%a, %d %b %Y 00:00:00 +0000" UTC)
file(WRITE ${documents}/changelog
     "mosbench (${PROJECT_VERSION}) unstable; urgency=medium\n\n  * See NEWS.\n\n -- ${CPACK_PACKAGE_CONTACT}  ${today}\n")
execute_process(COMMAND gzip -9nf ${documents}/NEWS ${documents}/changelog COMMAND_ERROR_IS_FATAL ANY)

# mosbench_package(COMPONENT NAME SECTION DEPENDS DESCRIPTION)
macro(mosbench_package component name section depends description)
  install(FILES ${documents}/copyright ${documents}/changelog.gz ${documents}/NEWS.gz DESTINATION share/doc/${name}
          COMPONENT ${component} EXCLUDE_FROM_ALL)
  string(TOUPPER ${component} key)
  set(CPACK_DEBIAN_${key}_PACKAGE_NAME ${name})
  set(CPACK_DEBIAN_${key}_PACKAGE_SECTION ${section})
  set(CPACK_DEBIAN_${key}_PACKAGE_DEPENDS "${depends}")
  set(CPACK_DEBIAN_${key}_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_${key}_DESCRIPTION "${description}")
  list(APPEND CPACK_COMPONENTS_ALL ${component})
endmacro()

set(CPACK_COMPONENTS_ALL)
mosbench_package(Unspecified mosbench science ""
  "Finds the moving points in LiDAR scans, and scores the labels of any method\nby each benchmark's own rules. Holds the program and the C++ library.")
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_SUGGESTS "mosbench-hdf5, python3-mosbench, libeigen3-dev")
if(TARGET mosbench_hdf5_module)
  mosbench_package(hdf5 mosbench-hdf5 science "mosbench (= ${PROJECT_VERSION}) | python3-mosbench (= ${PROJECT_VERSION})"
    "The module that mosbench and python3-mosbench load when they open the\nfirst .h5 file.")
endif()
if(TARGET mosbench_python)
  math(EXPR next_minor "${Python3_VERSION_MINOR} + 1")
  mosbench_package(python python3-mosbench python
    "python3 (>= ${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}), python3 (<< ${Python3_VERSION_MAJOR}.${next_minor}), python3-numpy"
    "Labels scans that are given as numpy arrays, reads data sets, and scores the\nlabels of any method by each benchmark's own rules.")
endif()
include(CPack)
