# mosbench_version.hpp: which code made a result. Included by the project it defines the target
# mosbench_version; run as a script, at every build, it writes the header when its content changed.

if(NOT CMAKE_SCRIPT_MODE_FILE)
  set(generated_dir ${PROJECT_BINARY_DIR}/generated)
  add_custom_target(mosbench_version_header
    COMMAND ${CMAKE_COMMAND}
      -D SOURCE_DIR=${PROJECT_SOURCE_DIR} -D PROJECT_VERSION=${PROJECT_VERSION}
      -D "COMPILER=${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}"
      -D HEADER=${generated_dir}/mosbench_version.hpp -P ${CMAKE_CURRENT_LIST_FILE}
    BYPRODUCTS ${generated_dir}/mosbench_version.hpp
    COMMENT "Asking git for the version"
    VERBATIM)
  add_library(mosbench_version INTERFACE)
  add_dependencies(mosbench_version mosbench_version_header)
  target_include_directories(mosbench_version INTERFACE ${generated_dir})
  return()
endif()

# Without git, or where the sources lie unpacked inside somebody else's repository, git cannot tell.
set(VERSION ${PROJECT_VERSION})
find_program(git git)
if(git AND EXISTS ${SOURCE_DIR}/.git)
  execute_process(COMMAND ${git} -C ${SOURCE_DIR} describe --always --tags
                  OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE
                  RESULT_VARIABLE git_exit ERROR_QUIET)
  if(git_exit EQUAL 0)
    string(APPEND VERSION "+${described}")
  endif()
  # Results of two different edits must not pass for those of one program; edits of what the program
  # is not made of do not matter.
  execute_process(COMMAND ${git} -C ${SOURCE_DIR} diff HEAD -- core datasets eval results/published.csv
                  OUTPUT_VARIABLE edits ERROR_QUIET)
  if(git_exit EQUAL 0 AND NOT edits STREQUAL "")
    string(SHA1 edits_hash "${edits}")
    string(SUBSTRING ${edits_hash} 0 8 edits_hash)
    string(APPEND VERSION "-dirty-${edits_hash}")
  endif()
endif()

file(CONFIGURE OUTPUT ${HEADER} @ONLY CONTENT [[
#pragma once

#include <string_view>

namespace mosbench {

/// The project's version and, when it was built from a git clone, `git describe` behind a plus.
inline constexpr std::string_view kMosbenchVersion = "@VERSION@";
/// Name and version of the compiler that built the program.
inline constexpr std::string_view kCompiler = "@COMPILER@";

}  // namespace mosbench
]])
