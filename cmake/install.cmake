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

# The manual page, and the completion for shells: the program prints them from the definitions of its own options.
if(NOT CMAKE_CROSSCOMPILING AND NOT ISOBATH_SANITIZE)
  set(pages ${PROJECT_BINARY_DIR}/pages)
  file(MAKE_DIRECTORY ${pages})
  add_custom_command(OUTPUT ${pages}/isobath.1 ${pages}/isobath ${pages}/_isobath ${pages}/isobath.fish DEPENDS isobath_app
                     COMMAND isobath_app help --man > ${pages}/isobath.1
                     COMMAND isobath_app help --completion bash > ${pages}/isobath
                     COMMAND isobath_app help --completion zsh > ${pages}/_isobath
                     COMMAND isobath_app help --completion fish > ${pages}/isobath.fish
                     COMMENT "Printing the manual page and the completion scripts" VERBATIM)
  add_custom_target(isobath_pages ALL DEPENDS ${pages}/isobath.1)
  install(FILES ${pages}/isobath.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
  install(FILES ${pages}/isobath DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
  install(FILES ${pages}/_isobath DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
  install(FILES ${pages}/isobath.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
endif()
