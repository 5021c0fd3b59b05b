# The live page (web/) as one file, which the program carries: made by npm from what package-lock.json names.
option(ISOBATH_PAGE "Build the live page into the program; needs Node.js and npm" ${PROJECT_IS_TOP_LEVEL})

set(ISOBATH_PAGE_FILE "")
if(ISOBATH_PAGE)
  find_program(ISOBATH_NPM npm)
  if(NOT ISOBATH_NPM)
    message(FATAL_ERROR "The live page needs npm (Debian: nodejs, npm); -DISOBATH_PAGE=OFF builds the program without it")
  endif()
  set(web ${PROJECT_SOURCE_DIR}/web)
  file(GLOB_RECURSE page_sources CONFIGURE_DEPENDS ${web}/src/*)
  add_custom_command(OUTPUT ${web}/node_modules/.package-lock.json WORKING_DIRECTORY ${web} DEPENDS ${web}/package-lock.json
                     COMMAND ${ISOBATH_NPM} ci --no-audit --no-fund --loglevel=error
                     COMMAND ${CMAKE_COMMAND} -E touch node_modules/.package-lock.json COMMENT "Fetching what the live page is made of" VERBATIM)
  set(ISOBATH_PAGE_FILE ${web}/dist/index.html)
  add_custom_command(OUTPUT ${ISOBATH_PAGE_FILE} WORKING_DIRECTORY ${web}
                     DEPENDS ${page_sources} ${web}/index.html ${web}/vite.config.ts ${web}/tsconfig.json ${web}/node_modules/.package-lock.json
                     COMMAND ${ISOBATH_NPM} run --silent build -- --logLevel warn
                     COMMAND ${CMAKE_COMMAND} -E touch dist/index.html COMMENT "Building the live page" VERBATIM)
endif()
