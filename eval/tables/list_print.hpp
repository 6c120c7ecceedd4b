#pragma once

#include <string>
#include <vector>

#include "eval/answer/answer.hpp"

namespace mosbench {

/// Returns what can be listed: "all", "datasets", "methods", ...
std::vector<std::string> list_names();

/// Lists one of `list_names`; of the methods also a single one by its name, all where that is
/// empty. Throws UsageError for other names.
Answer list_answer(const std::string& what, const std::string& name);

}  // namespace mosbench
