# mosbench_version.cpp: which code made a result. Included by the project it defines the library
# mosbench_version; run as a script, at every build, it writes the file when its content changed. It is compiled alone,
# since its content changes with every edit.

if(NOT CMAKE_SCRIPT_MODE_FILE)
  set(version_source ${PROJECT_BINARY_DIR}/generated/mosbench_version.cpp)
  add_custom_target(mosbench_version_source
    COMMAND ${CMAKE_COMMAND}
      -D SOURCE_DIR=${PROJECT_SOURCE_DIR} -D PROJECT_VERSION=${PROJECT_VERSION}
      -D "COMPILER=${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}"
      -D WRITTEN=${version_source} -P ${CMAKE_CURRENT_LIST_FILE}
    BYPRODUCTS ${version_source}
    COMMENT "Asking git for the version"
    VERBATIM)
  add_library(mosbench_version STATIC ${version_source})
  add_dependencies(mosbench_version mosbench_version_source)
  target_compile_features(mosbench_version PRIVATE cxx_std_20)
  target_include_directories(mosbench_version PRIVATE ${PROJECT_SOURCE_DIR})
  set_target_properties(mosbench_version PROPERTIES POSITION_INDEPENDENT_CODE ${MOSBENCH_WITH_PYTHON})
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

file(CONFIGURE OUTPUT ${WRITTEN} @ONLY CONTENT [[
#include "eval/result/version.hpp"

namespace mosbench {

const std::string_view kMosbenchVersion = "@VERSION@";
const std::string_view kCompiler = "@COMPILER@";

}  // namespace mosbench
]])
