# One static library a room, named isobath::<room>: every .cpp that stands in its folder or in one of its sub-rooms, and the rooms below.
include(GNUInstallDirs)
# The law: ISOBATH_LAW has the rooms from the ground up, ISOBATH_LAW_<room> the rooms that it and its sub-rooms may include,
# ISOBATH_FOLDERS_<room> its sub-rooms.
file(STRINGS ${PROJECT_SOURCE_DIR}/isobath/rooms.toml ISOBATH_LAW_LINES REGEX "^[a-z\"]")
set_property(DIRECTORY ${PROJECT_SOURCE_DIR} APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/isobath/rooms.toml)
set(ISOBATH_LAW "")
foreach(line IN LISTS ISOBATH_LAW_LINES)
  string(REGEX MATCHALL "[a-z/]+" words "${line}")
  list(POP_FRONT words folder)
  string(REGEX REPLACE "/.*" "" room ${folder})
  list(TRANSFORM words REPLACE "/.*" "")
  list(APPEND ISOBATH_LAW ${room})
  list(APPEND ISOBATH_LAW_${room} ${words})
  list(REMOVE_DUPLICATES ISOBATH_LAW_${room})
  list(REMOVE_ITEM ISOBATH_LAW_${room} ${room})
  if(NOT folder STREQUAL room)
    list(APPEND ISOBATH_FOLDERS_${room} ${folder})
  endif()
endforeach()
list(REMOVE_DUPLICATES ISOBATH_LAW)

set(ISOBATH_ROOMS "" CACHE INTERNAL "targets of all rooms")

set(ISOBATH_NO_FALSE_ALARM "")
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  list(APPEND ISOBATH_NO_FALSE_ALARM -Wno-restrict -Wno-stringop-overflow -Wno-array-bounds) # of "text" + string: https://gcc.gnu.org/PR105651
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
  if(ISOBATH_SANITIZE MATCHES undefined) # the address sanitizer sees what these see; without them a unit compiles in two thirds
    add_compile_options(-fno-sanitize=null,object-size,vptr)
  endif()
endif()

# Unity builds: most of the time that a source takes goes into the headers of the standard library and Eigen, which a unit
# reads once. A source goes into the unit that the hash of its path names, so that a new source moves no other; units double
# in number as a folder grows. Sources that use the same name for things of their own stand alone (cmake/alone.txt).
file(STRINGS ${CMAKE_CURRENT_LIST_DIR}/alone.txt ISOBATH_ALONE REGEX "^[^#]")
set_property(DIRECTORY ${PROJECT_SOURCE_DIR} APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/alone.txt)
# Precompiled headers: one for the rooms, one for the tests. What they hide of the standard library, Floors.EverySourceIncludes... sees.
function(isobath_precompiled name header)
  cmake_parse_arguments(ARG "" "" "USES;FLAGS" ${ARGN})
  file(CONFIGURE OUTPUT ${name}.cpp CONTENT "")
  add_library(${name} OBJECT EXCLUDE_FROM_ALL ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
  target_link_libraries(${name} PRIVATE ${ARG_USES} isobath_build)
  target_compile_options(${name} PRIVATE ${ARG_FLAGS})
  target_precompile_headers(${name} PRIVATE ${header})
  target_compile_options(${name} PRIVATE $<$<CXX_COMPILER_ID:Clang>:SHELL:-Xclang -fno-pch-timestamp>) # for ccache
endfunction()
isobath_precompiled(isobath_precompiled ${CMAKE_CURRENT_LIST_DIR}/precompiled.hpp USES fmt::fmt tl::expected Eigen3::Eigen)

function(isobath_units target precompiled)
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
  if(TARGET ${precompiled})
    target_precompile_headers(${target} REUSE_FROM ${precompiled})
    target_compile_options(${target} PRIVATE -fPIC) # as the headers are, programs too
  endif()
endfunction()

# Where a sanitizer makes the compiler slow, the rooms that reckon little are not optimised: they compile in half the time. With the
# address sanitizer none is: optimising its checks takes the compiler three times as long as all else.
set(ISOBATH_QUICK_ROOMS "")
if(ISOBATH_SANITIZE)
  set(ISOBATH_QUICK_ROOMS mission world onboard configuration scenario display recording report run evaluation studies server app)
  if(ISOBATH_SANITIZE MATCHES address)
    set(ISOBATH_QUICK_ROOMS ${ISOBATH_LAW})
  endif()
  isobath_precompiled(isobath_quick_precompiled ${CMAKE_CURRENT_LIST_DIR}/precompiled.hpp USES fmt::fmt tl::expected Eigen3::Eigen
                      FLAGS -O0)
endif()
function(isobath_room_units target name)
  if(name IN_LIST ISOBATH_QUICK_ROOMS)
    isobath_units(${target} isobath_quick_precompiled ${ARGN})
    target_compile_options(${target} PRIVATE -O0)
  else()
    isobath_units(${target} isobath_precompiled ${ARGN})
  endif()
endfunction()

# isobath_room(<name> USES <other libraries that its headers need> PRIVATE <targets that only its sources need>)
function(isobath_room name)
  cmake_parse_arguments(ARG "" "" "USES;PRIVATE" ${ARGN})
  set(sources "")
  set(headers "")
  foreach(folder IN ITEMS ${name} ${ISOBATH_FOLDERS_${name}})
    file(GLOB found CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/isobath/${folder}/*.cpp)
    list(APPEND sources ${found})
    file(GLOB found CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/isobath/${folder}/*.hpp)
    list(APPEND headers ${found})
    install(FILES ${found} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/isobath/${folder})
  endforeach()
  add_library(isobath_${name} STATIC ${sources} ${headers})
  isobath_room_units(isobath_${name} ${name} ${sources})
  add_library(isobath::${name} ALIAS isobath_${name})
  set_target_properties(isobath_${name} PROPERTIES EXPORT_NAME ${name} LINKER_LANGUAGE CXX)
  target_compile_features(isobath_${name} PUBLIC cxx_std_20)
  target_include_directories(isobath_${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                             $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  list(TRANSFORM ISOBATH_LAW_${name} PREPEND isobath_ OUTPUT_VARIABLE rooms)
  target_link_libraries(isobath_${name} PUBLIC ${rooms} ${ARG_USES} PRIVATE ${ARG_PRIVATE} $<BUILD_INTERFACE:isobath_build>)
  install(TARGETS isobath_${name} EXPORT isobath ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  set(ISOBATH_ROOMS ${ISOBATH_ROOMS} isobath_${name} CACHE INTERNAL "targets of all rooms")
endfunction()

# The tests ask the library for much and themselves for little: optimised less, they compile in half the time.
set(ISOBATH_TEST_FLAGS $<$<CONFIG:Debug>:-O0> $<$<CONFIG:Release>:-Og>
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>) # of optionals

# isobath_tests(<room> USES <targets>): an executable of all sources in the current folder; each suite a ctest of its own. Those that
# start threads stand in the folder threads, which the thread sanitizer runs and no other; those of whole runs in the folder long, which
# no sanitizer runs. Both are executables of their own, and their tests carry the name of the folder as label. Of both, and of the
# program (room app), each case is a ctest: a suite of them would take minutes.
function(isobath_tests room)
  cmake_parse_arguments(ARG "" "" "USES" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  isobath_test_program(${room}_test ${room} "" SOURCES ${sources} USES ${ARG_USES})
  add_custom_target(${room}_tests DEPENDS ${room}_test)
  set(labels threads long)
  if(ISOBATH_SANITIZE STREQUAL thread)
    set(labels threads)
  elseif(ISOBATH_SANITIZE)
    set(labels "")
  endif()
  list(FILTER sources EXCLUDE REGEX "_test\\.cpp$")
  foreach(label IN LISTS labels)
    file(GLOB labelled CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${label}/*.cpp)
    if(labelled)
      isobath_test_program(${room}_${label}_test ${room} ${label} SOURCES ${labelled} ${sources} USES ${ARG_USES})
      add_dependencies(${room}_tests ${room}_${label}_test)
    endif()
  endforeach()
endfunction()

set(ISOBATH_TEST_TIMEOUT 300)
set(ISOBATH_PROPERTIES "seed=1") # of rapidcheck
if(ISOBATH_SANITIZE)
  set(ISOBATH_TEST_TIMEOUT 600)
  string(APPEND ISOBATH_PROPERTIES " max_success=25")
  list(APPEND ISOBATH_TEST_FLAGS -DISOBATH_SANITIZED)
endif()
function(isobath_test_program name room label)
  cmake_parse_arguments(ARG "" "" "SOURCES;USES" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  isobath_units(${name} isobath_test_precompiled ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE isobath_test_support ${ARG_USES} isobath_build)
  target_compile_options(${name} PRIVATE ${ISOBATH_TEST_FLAGS})
  if(label OR room STREQUAL app)
    set(labels)
    if(label)
      set(labels LABELS ${label})
    endif()
    gtest_discover_tests(${name} TEST_PREFIX ${room}. DISCOVERY_TIMEOUT 60
                         PROPERTIES TIMEOUT ${ISOBATH_TEST_TIMEOUT} ${labels} ENVIRONMENT "RC_PARAMS=${ISOBATH_PROPERTIES}")
  else()
    isobath_discover_suites(${name} ${room})
  endif()
  set_property(GLOBAL APPEND PROPERTY ISOBATH_TEST_PROGRAMS_${label} ${name})
endfunction()
