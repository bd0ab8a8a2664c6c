# `cmake --install build/release --prefix DIR`: the library with its headers and package files, and the command.
include(CMakePackageConfigHelpers)

set(ferrers_cmake_dir ${CMAKE_INSTALL_LIBDIR}/cmake/ferrers)

install(TARGETS ferrers EXPORT ferrersTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
foreach(layer IN LISTS FERRERS_LAYERS)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/ferrers/${layer} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/ferrers
          FILES_MATCHING PATTERN "*.h")
endforeach()

install(EXPORT ferrersTargets NAMESPACE ferrers:: DESTINATION ${ferrers_cmake_dir})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/ferrersConfig.cmake.in ${PROJECT_BINARY_DIR}/ferrersConfig.cmake
                              INSTALL_DESTINATION ${ferrers_cmake_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/ferrersConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/ferrersConfig.cmake ${PROJECT_BINARY_DIR}/ferrersConfigVersion.cmake
        DESTINATION ${ferrers_cmake_dir})

if(TARGET ferrers_command)
  install(TARGETS ferrers_command RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} OPTIONAL)
