# One static library a room, named isobath::<room>: every .cpp that stands in its folder, and the rooms below it.
include(GNUInstallDirs)
set(ISOBATH_ROOMS "" CACHE INTERNAL "targets of all rooms")

set(ISOBATH_NO_FALSE_ALARM "")
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  list(APPEND ISOBATH_NO_FALSE_ALARM -Wno-restrict) # of "text" + string: https://gcc.gnu.org/PR105651
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND ISOBATH_SANITIZE)
  # GCC's manual, -fsanitize: instrumentation confuses the warnings that follow the flow of values
  list(APPEND ISOBATH_NO_FALSE_ALARM -Wno-maybe-uninitialized -Wno-stringop-overflow -Wno-stringop-overread -Wno-array-bounds)
endif()
set(ISOBATH_SHADOW -Wshadow)
if(CMAKE_UNITY_BUILD) # what stands in another source of the unit is no shadow, what stands in the unit no header
  set(ISOBATH_SHADOW $<$<CXX_COMPILER_ID:GNU>:-Wshadow=local> $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endif()
add_library(isobath_build INTERFACE) # flags of our own code; never handed to users of the library
target_compile_options(isobath_build INTERFACE -Wall -Wextra -Wpedantic ${ISOBATH_SHADOW} -Wconversion -Wno-sign-conversion
                       $<$<CXX_COMPILER_ID:GNU>:-Wno-psabi> ${ISOBATH_NO_FALSE_ALARM} $<$<BOOL:${ISOBATH_WERROR}>:-Werror>)
if(ISOBATH_SANITIZE)
  add_compile_options(-fsanitize=${ISOBATH_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${ISOBATH_SANITIZE})
endif()

# Unity builds: most of the time that a source takes goes into the headers of the standard library and Eigen, which a unit
# reads once. A source goes into the unit that the hash of its path names, so that a new source moves no other; units double
# in number as a folder grows. Sources that use the same name for things of their own stand alone (cmake/alone.txt).
file(STRINGS ${CMAKE_CURRENT_LIST_DIR}/alone.txt ISOBATH_ALONE REGEX "^[^#]")
set_property(DIRECTORY ${PROJECT_SOURCE_DIR} APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/alone.txt)
function(isobath_units target)
  list(LENGTH ARGN count)
  set(units 1)
  while(units LESS_EQUAL 32 AND count GREATER 12)
    math(EXPR units "2 * ${units}")
    math(EXPR count "(${count} + 1) / 2")
  endwhile()
  foreach(source IN LISTS ARGN)
    file(RELATIVE_PATH path ${PROJECT_SOURCE_DIR} ${source})
    string(MD5 hash ${path})
    string(SUBSTRING ${hash} 0 4 hash)
    math(EXPR unit "0x${hash} % ${units}")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP unit${unit})
    if(path IN_LIST ISOBATH_ALONE)
      set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    endif()
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
endfunction()

# isobath_room(<name> USES <targets that its headers need> PRIVATE <targets that only its sources need>)
function(isobath_room name)
  cmake_parse_arguments(ARG "" "" "USES;PRIVATE" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  file(GLOB headers CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.hpp)
  add_library(isobath_${name} STATIC ${sources} ${headers})
  isobath_units(isobath_${name} ${sources})
  add_library(isobath::${name} ALIAS isobath_${name})
  set_target_properties(isobath_${name} PROPERTIES EXPORT_NAME ${name} LINKER_LANGUAGE CXX)
  target_compile_features(isobath_${name} PUBLIC cxx_std_20)
  target_include_directories(isobath_${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                             $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(isobath_${name} PUBLIC ${ARG_USES} PRIVATE ${ARG_PRIVATE} $<BUILD_INTERFACE:isobath_build>)
  install(TARGETS isobath_${name} EXPORT isobath ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(FILES ${headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/isobath/${name})
  set(ISOBATH_ROOMS ${ISOBATH_ROOMS} isobath_${name} CACHE INTERNAL "targets of all rooms")
endfunction()

# isobath_tests(<room> USES <targets>): one executable of all *_test.cpp in the current folder; each case a ctest of its own.
function(isobath_tests room)
  cmake_parse_arguments(ARG "" "" "USES" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  add_executable(${room}_test ${sources})
  isobath_units(${room}_test ${sources})
  target_link_libraries(${room}_test PRIVATE isobath_test_support ${ARG_USES} isobath_build)
  gtest_discover_tests(${room}_test TEST_PREFIX ${room}. DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 120 ENVIRONMENT RC_PARAMS=seed=1)
endfunction()
