# isobath_discover_suites(<program> <room>): asks a GoogleTest program, when it has been built, which suites it has, and makes a ctest
# of each. A program brings the hundred libraries of GDAL along and takes a fifth of a second to start; most cases take less. A suite
# counts as skipped where all its cases are.
if(CMAKE_SCRIPT_MODE_FILE)
  execute_process(COMMAND ${PROGRAM} --gtest_list_tests OUTPUT_VARIABLE listed COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCHALL "(^|\n)[^ \n]+\\.( |\n)" suites "${listed}")
  set(tests "")
  foreach(suite IN LISTS suites)
    string(REGEX REPLACE "\\.?[ \n]" "" suite ${suite})
    string(APPEND tests "add_test([=[${ROOM}.${suite}]=] [=[${PROGRAM}]=] [=[--gtest_filter=${suite}.*]=])\n"
           "set_tests_properties([=[${ROOM}.${suite}]=] PROPERTIES WORKING_DIRECTORY [=[${FOLDER}]=] TIMEOUT ${TIMEOUT}"
           " ENVIRONMENT [=[RC_PARAMS=${RAPIDCHECK}]=]"
           " SKIP_REGULAR_EXPRESSION [=[PASSED  . 0 tests.(\n.  SKIPPED [^\n]*)+\n*$]=])\n")
  endforeach()
  file(WRITE ${OUTPUT} "${tests}")
  return()
endif()

function(isobath_discover_suites program room)
  set(tests ${CMAKE_CURRENT_BINARY_DIR}/${program}_suites.cmake)
  add_custom_command(TARGET ${program} POST_BUILD VERBATIM
    COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:${program}> -DROOM=${room} -DFOLDER=${CMAKE_CURRENT_BINARY_DIR}
            -DTIMEOUT=${ISOBATH_TEST_TIMEOUT} -DRAPIDCHECK=${ISOBATH_PROPERTIES} -DOUTPUT=${tests}
            -P ${CMAKE_CURRENT_FUNCTION_LIST_FILE})
  set(include ${CMAKE_CURRENT_BINARY_DIR}/${program}_include.cmake)
  file(WRITE ${include}
       "if(EXISTS [=[${tests}]=])\n  include([=[${tests}]=])\nelse()\n  add_test(${room}.${program}_is_not_built ${program})\nendif()\n")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${include})
endfunction()
