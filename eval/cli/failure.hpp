#pragma once

#include <string>

namespace mosbench {

/// How the program ends after an error, and what it says.
struct Failure {
  int exit_code;
  std::string message;
};

/// Returns that of the exception that is being handled.
Failure current_failure();

}  // namespace mosbench
