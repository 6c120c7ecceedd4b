# What the program says about itself, made by it and installed: completion for bash and zsh and, where
# help2man is there, the manual pages.
set(manual ${PROJECT_BINARY_DIR}/manual)
set(made ${manual}/mosbench ${manual}/_mosbench)
add_custom_command(
  OUTPUT ${made}
  COMMAND mosbench help --completion bash > ${manual}/mosbench
  COMMAND mosbench help --completion zsh > ${manual}/_mosbench
  DEPENDS mosbench
  VERBATIM)
file(MAKE_DIRECTORY ${manual})
# Where the program alone was built, there is no manual to install.
install(FILES ${manual}/mosbench DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions OPTIONAL)
install(FILES ${manual}/_mosbench DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions OPTIONAL)

find_program(MOSBENCH_HELP2MAN help2man)
mark_as_advanced(MOSBENCH_HELP2MAN)
if(MOSBENCH_HELP2MAN)
  list(APPEND made ${manual}/man1/mosbench.1)
  add_custom_command(
    OUTPUT ${manual}/man1/mosbench.1
    COMMAND ${PROJECT_SOURCE_DIR}/scripts/docs/man_pages.sh $<TARGET_FILE:mosbench> ${manual}/man1
    DEPENDS mosbench ${PROJECT_SOURCE_DIR}/scripts/docs/man_pages.sh
    VERBATIM)
  install(DIRECTORY ${manual}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} OPTIONAL)
endif()
add_custom_target(manual ALL DEPENDS ${made})
