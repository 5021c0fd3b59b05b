# isobath_headers_alone: each header that no source of its own name includes first (scripts/lint/tidy-unit sees to those), by itself.
file(GLOB_RECURSE headers CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/isobath/*.hpp)
set(sources "")
foreach(header IN LISTS headers)
  string(REGEX REPLACE "hpp$" "cpp" source ${header})
  if(NOT EXISTS ${PROJECT_SOURCE_DIR}/${source})
    file(CONFIGURE OUTPUT alone/${source} CONTENT "#include <${header}>\n")
    list(APPEND sources ${CMAKE_CURRENT_BINARY_DIR}/alone/${source})
  endif()
endforeach()
add_library(isobath_headers_alone OBJECT EXCLUDE_FROM_ALL ${sources})
target_link_libraries(isobath_headers_alone PRIVATE isobath::isobath isobath_build)
target_precompile_headers(isobath_headers_alone REUSE_FROM isobath_precompiled)
target_include_directories(isobath_headers_alone PRIVATE ${PROJECT_SOURCE_DIR}) # app has headers and is no library
