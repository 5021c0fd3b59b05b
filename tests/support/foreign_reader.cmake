# What we write, read by somebody else's reader, which npm installs.
#
# isobath_foreign_reader_test(NAME WRITER READER [ARGUMENT...]) adds a test: the target WRITER fills a folder, the
# script READER of this folder reads it with the packages of package.json beside it; @WRITTEN@ in an argument is the
# folder. Without a writer ("") the script itself starts what it tests. Skipped with a notice where npm cannot give the packages.
#
# As a script (cmake -P) it is that test; the packages are installed into WORK once.
if(NOT CMAKE_SCRIPT_MODE_FILE)
  set(ISOBATH_FOREIGN_READER ${CMAKE_CURRENT_LIST_FILE} CACHE INTERNAL "")
  function(isobath_foreign_reader_test name writer reader)
    find_program(ISOBATH_NODE node)
    find_program(ISOBATH_NPM npm)
    mark_as_advanced(ISOBATH_NODE ISOBATH_NPM)
    set(work ${CMAKE_CURRENT_BINARY_DIR})
    string(REPLACE "@WRITTEN@" "${work}/written" arguments "${ARGN}")
    if(writer)
      set(writer $<TARGET_FILE:${writer}>)
    endif()
    add_test(NAME ${name}
             COMMAND ${CMAKE_COMMAND} -DNODE=${ISOBATH_NODE} -DNPM=${ISOBATH_NPM} -DWRITER=${writer}
                     -DREADER=${reader} "-DARGUMENTS=${arguments}" -DSOURCE=${CMAKE_CURRENT_SOURCE_DIR} -DWORK=${work}
                     -P ${ISOBATH_FOREIGN_READER})
    set_tests_properties(${name} PROPERTIES SKIP_REGULAR_EXPRESSION "SKIPPED: " TIMEOUT 300)
  endfunction()
  return()
endif()

file(MAKE_DIRECTORY ${WORK})
if(NOT NODE OR NOT NPM)
  message("SKIPPED: node and npm are not here, so no other reader is")
  return()
endif()
file(COPY ${SOURCE}/package.json ${SOURCE}/package-lock.json ${SOURCE}/${READER} DESTINATION ${WORK})
file(SHA256 ${WORK}/package-lock.json lock)
if(NOT EXISTS ${WORK}/installed-${lock})
  execute_process(COMMAND ${NPM} ci --ignore-scripts --no-audit --no-fund WORKING_DIRECTORY ${WORK} RESULT_VARIABLE problem)
  if(problem)
    message("SKIPPED: npm could not install the reader")
    return()
  endif()
  file(TOUCH ${WORK}/installed-${lock})
endif()
if(WRITER)
  execute_process(COMMAND ${WRITER} ${WORK}/written COMMAND_ERROR_IS_FATAL ANY)
endif()
execute_process(COMMAND ${NODE} ${WORK}/${READER} ${ARGUMENTS} COMMAND_ERROR_IS_FATAL ANY)
