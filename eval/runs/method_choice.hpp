#pragma once

#include <mosbench/method.hpp>
#include <string>
#include <vector>

namespace mosbench {

/// Returns the method that --method names; of "exec:COMMAND" that of `exec_method`. Throws
/// UsageError naming the nearest one.
const MethodKind& method_named(const std::string& name);

/// Methods of a benchmark, and why others are not among them.
struct MethodChoice {
  std::vector<std::string> names;
  std::vector<std::string> notes;  ///< plain sentences
};

/// Whether --method is a list, or "all".
bool names_several_methods(const std::string& text);

/// Takes "A", "A,B,exec:COMMAND" or "all": every method but twins and those that this build lacks,
/// in the order of `methods()`. Throws UsageError for a name that is not known, empty or given
/// twice.
MethodChoice chosen_methods(const std::string& text);

}  // namespace mosbench
