#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace mosbench {

/// A value that two JSON objects do not share.
struct JsonDifference {
  std::string key;            ///< "settings/max_range_m"
  std::string first, second;  ///< JSON text, "nothing" where there is none
};

/// All of them, in the order of the second object and then what only the first has.
std::vector<JsonDifference> json_differences(const nlohmann::ordered_json& first,
                                             const nlohmann::ordered_json& second);

/// "settings/max_range_m is 50.0 there and 30.0 now; ..." of the members that `now` has; empty when
/// `there` has the same. The member `settings` counts only where both are of one `method`.
std::string changed_members(const nlohmann::ordered_json& there, const nlohmann::ordered_json& now);

}  // namespace mosbench
