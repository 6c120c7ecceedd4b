# What `cmake --install` puts where: the program, and the method as mosbench::core for
# find_package(mosbench).
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/mosbench)
foreach(room interface ${MOSBENCH_CORE_ROOMS} core)
  set_target_properties(mosbench_${room} PROPERTIES EXPORT_NAME ${room})
  # An exported library must say where its headers would go. Those of rooms are not public.
  set(unless_public COMPONENT internal EXCLUDE_FROM_ALL)
  if(room STREQUAL interface)
    set(unless_public)
  endif()
  install(TARGETS mosbench_${room} EXPORT mosbench
          FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/mosbench ${unless_public})
endforeach()
install(FILES core/include/mosbench/pcl.hpp DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/mosbench/mosbench)
install(EXPORT mosbench NAMESPACE mosbench:: FILE mosbenchTargets.cmake DESTINATION ${package_dir})
if(TARGET mosbench)
  install(TARGETS mosbench)
  if(TARGET mosbench_hdf5_module)
    install(TARGETS mosbench_hdf5_module LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/mosbench COMPONENT hdf5)
  endif()
endif()

configure_package_config_file(scripts/cmake/mosbenchConfig.cmake.in
  ${PROJECT_BINARY_DIR}/generated/mosbenchConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/generated/mosbenchConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/generated/mosbenchConfig.cmake
              ${PROJECT_BINARY_DIR}/generated/mosbenchConfigVersion.cmake
        DESTINATION ${package_dir})
