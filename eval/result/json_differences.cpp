#include "eval/result/json_differences.hpp"

#include <fmt/format.h>

namespace mosbench {
namespace {

using nlohmann::ordered_json;

/// Nothing flattens to an unnamed null, which is no member.
ordered_json flat(const ordered_json& object) {
  return object.empty() ? ordered_json::object() : object.flatten();
}

std::string text_at(const ordered_json& members, const std::string& key) {
  if (!members.contains(key)) return "nothing";
  return members[key].dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace

std::vector<JsonDifference> json_differences(const ordered_json& first,
                                             const ordered_json& second) {
  const ordered_json theirs = flat(first);
  const ordered_json ours = flat(second);
  std::vector<JsonDifference> differences;
  for (const ordered_json* side : {&ours, &theirs}) {
    for (const auto& [key, unused] : side->items()) {
      if (side == &theirs && ours.contains(key)) continue;
      JsonDifference difference{key.substr(key.starts_with('/') ? 1 : 0), text_at(theirs, key),
                                text_at(ours, key)};
      if (difference.first != difference.second) differences.push_back(std::move(difference));
    }
  }
  return differences;
}

std::string changed_members(const ordered_json& there, const ordered_json& now) {
  ordered_json same_keys;
  ordered_json compared = now;
  // Settings of another method are no changes of these.
  if (there.contains("method") && now.contains("method") && there["method"] != now["method"]) {
    compared.erase("settings");
  }
  for (const auto& [key, unused] : compared.items()) {
    if (there.contains(key)) same_keys[key] = there[key];
  }
  for (ordered_json* side : {&same_keys, &compared}) {
    // How long a program may take decides no label.
    const auto settings = side->find("settings");
    if (settings != side->end() && settings->is_object()) settings->erase("timeout_s");
  }
  std::string text;
  for (const JsonDifference& difference : json_differences(same_keys, compared)) {
    text += fmt::format("{}{} is {} there and {} now", text.empty() ? "" : "; ", difference.key,
                        difference.first, difference.second);
  }
  return text;
}

}  // namespace mosbench
