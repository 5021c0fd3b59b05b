# install and find_package(isobath): see examples.
include(CMakePackageConfigHelpers)
install(TARGETS isobath EXPORT isobath)
install(EXPORT isobath NAMESPACE isobath:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/isobath)
configure_package_config_file(cmake/isobath-config.cmake.in ${PROJECT_BINARY_DIR}/isobath-config.cmake
                              INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/isobath)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/isobath-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/isobath-config.cmake ${PROJECT_BINARY_DIR}/isobath-config-version.cmake
              cmake/dependencies.cmake DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/isobath)
install(DIRECTORY scenarios vehicles DESTINATION ${CMAKE_INSTALL_DATADIR}/isobath)
