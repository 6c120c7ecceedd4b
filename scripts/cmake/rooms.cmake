# mosbench_library(ROOM [FOLDER folder] [OPTIONS ...] [EXCLUDE ...] [DEPENDS ...] [PRIVATE ...])
# Makes the library mosbench_ROOM of every .cpp of the calling folder, or of a folder in it. DEPENDS names rooms and imported
# targets that its headers need, PRIVATE those that only its sources need. The files of a room are compiled
# together: most of a file's time is spent in the headers of JSON, fmt and Eigen. With MOSBENCH_WITH_PYTHON
# rooms can be linked into a shared library; calls within them stay direct and may be inlined.
set(MOSBENCH_FILES_AT_A_TIME 40 CACHE STRING "Files of a room that are compiled together")
add_library(mosbench_room_options INTERFACE)
if(MOSBENCH_WITH_PYTHON)
  target_compile_options(mosbench_room_options INTERFACE -fno-semantic-interposition)
endif()
option(MOSBENCH_PRECOMPILED_HEADERS
       "Read the standard library, Eigen, fmt and JSON once per set of options: sooner built from nothing" OFF)

# mosbench_precompile(TARGET [TESTS] [OPTIONS...]): gives the target the headers that most rooms read, for TESTS also Google
# Test's, precompiled with its options. scripts/check/headers.py finds what a header fails to include.
function(mosbench_precompile target)
  cmake_parse_arguments(arg "TESTS" "" "" ${ARGN})
  string(MAKE_C_IDENTIFIER "mosbench_headers${ARGN}" headers)
  if(NOT TARGET ${headers})
    file(GENERATE OUTPUT ${PROJECT_BINARY_DIR}/${headers}.cpp CONTENT "")
    add_library(${headers} OBJECT ${PROJECT_BINARY_DIR}/${headers}.cpp)
    target_compile_options(${headers} PRIVATE ${arg_UNPARSED_ARGUMENTS})
    target_link_libraries(${headers} PRIVATE mosbench_options Eigen3::Eigen fmt::fmt nlohmann_json::nlohmann_json)
    if(arg_TESTS)
      target_link_libraries(${headers} PRIVATE GTest::gmock GTest::gtest)
      target_precompile_headers(${headers} PRIVATE <gmock/gmock.h> <gtest/gtest.h>)
    else()
      target_link_libraries(${headers} PRIVATE mosbench_room_options)
      set_target_properties(${headers} PROPERTIES POSITION_INDEPENDENT_CODE ${MOSBENCH_WITH_PYTHON})
    endif()
    target_precompile_headers(${headers} PRIVATE <algorithm> <array> <charconv> <chrono> <cmath> <cstdint> <filesystem>
      <fstream> <functional> <iostream> <map> <memory> <mutex> <numeric> <optional> <random> <ranges> <set> <span>
      <sstream> <string> <string_view> <thread> <tuple> <unordered_map> <utility> <variant> <vector> <Eigen/Core>
      <Eigen/Geometry> <fmt/format.h> <fmt/ranges.h> <nlohmann/json.hpp>)
  endif()
  # A precompiled header is read only where the same macros are defined.
  target_compile_definitions(${target} PRIVATE $<TARGET_PROPERTY:fmt::fmt,INTERFACE_COMPILE_DEFINITIONS>)
  target_precompile_headers(${target} REUSE_FROM ${headers})
endfunction()

function(mosbench_library room)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "FOLDER" "OPTIONS;EXCLUDE;DEPENDS;PRIVATE")
  set(folder ${CMAKE_CURRENT_SOURCE_DIR}/${arg_FOLDER})
  file(GLOB sources RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} CONFIGURE_DEPENDS ${folder}/*.cpp)
  file(GLOB headers RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} CONFIGURE_DEPENDS ${folder}/*.hpp)
  list(REMOVE_ITEM sources ${arg_EXCLUDE} "")
  set(target mosbench_${room})
  add_library(${target} ${sources})
  add_library(mosbench::${room} ALIAS ${target})
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_compile_options(${target} PRIVATE ${arg_OPTIONS})
  target_sources(${target} PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${headers})
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ${MOSBENCH_WITH_PYTHON}
                        UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${MOSBENCH_FILES_AT_A_TIME})
  mosbench_targets(depends ${arg_DEPENDS})
  mosbench_targets(private ${arg_PRIVATE})
  target_link_libraries(${target} PUBLIC ${depends}
                        PRIVATE $<BUILD_INTERFACE:mosbench_options> $<BUILD_INTERFACE:mosbench_room_options>
                        ${private})
  if(MOSBENCH_PRECOMPILED_HEADERS)
    mosbench_precompile(${target} ${arg_OPTIONS})
  endif()
endfunction()

# Rooms by their name, other targets as they are.
function(mosbench_targets result)
  set(targets)
  foreach(name IN LISTS ARGN)
    if(name MATCHES "::|^mosbench")
      list(APPEND targets ${name})
    else()
      list(APPEND targets mosbench_${name})
    endif()
  endforeach()
  set(${result} ${targets} PARENT_SCOPE)
endfunction()
