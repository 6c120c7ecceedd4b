#pragma once

#include <mosbench/method.hpp>
#include <optional>
#include <string>
#include <vector>

namespace mosbench {

/// Returns the method that --method names; of "exec:COMMAND" that of `exec_method`. Throws
/// UsageError naming the nearest one.
const MethodKind& method_named(const std::string& name);

/// Returns the method that is named, else that of the preset, else the paper's. Throws UsageError
/// where the preset is of another method than the one that is named.
const MethodKind& method_of(const std::optional<std::string>& method,
                            const std::optional<std::string>& preset);

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
