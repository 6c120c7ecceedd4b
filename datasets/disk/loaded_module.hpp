#pragma once

#include <string>

namespace mosbench {

/// A function of a module of the program, or why there is none.
struct ModuleFunction {
  void* function = nullptr;
  std::string error = "it is in none of its folders";
};

/// Loads a module (a shared library beside the program, of the same build) when it is first needed:
/// with all its libraries libhdf5 would cost every start of the program milliseconds. Looks in
/// three folders: relative to the installed program, in the installation prefix, and in the build
/// tree.
ModuleFunction load_function(const char* module, const char* function);

}  // namespace mosbench
