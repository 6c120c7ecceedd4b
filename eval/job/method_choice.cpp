#include "eval/job/method_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "datasets/text/errors.hpp"
#include "datasets/text/nearest_name.hpp"
#include "eval/exec/exec_method.hpp"
#include "eval/job/presets.hpp"

namespace mosbench {
namespace {

constexpr std::string_view kExec = "exec:";

/// Adds a method to those of a benchmark, unless this build cannot run it.
void add_if_runnable(const MethodKind& method, MethodChoice& choice) {
  try {
    method.check(method.defaults);
    choice.names.emplace_back(method.name);
  } catch (const std::invalid_argument& error) {
    choice.notes.push_back(fmt::format("{} is left out: {}", method.name, error.what()));
  }
}

MethodChoice all_methods() {
  MethodChoice choice;
  for (const MethodKind& method : methods()) {
    if (!method.is_twin) add_if_runnable(method, choice);
  }
  return choice;
}

}  // namespace

const MethodKind& method_named(const std::string& name) {
  if (name.starts_with(kExec)) return exec_method(name.substr(kExec.size()));
  if (const MethodKind* method = find_method(name)) return *method;
  std::vector<std::string_view> names;
  for (const MethodKind& method : methods()) names.push_back(method.name);
  throw UsageError(
      fmt::format("--method: '{}' is not known, expected one of {} or exec:COMMAND (nearest: {})",
                  name, fmt::join(names, ", "), nearest_name(name, names)));
}

const MethodKind& method_of(const std::optional<std::string>& method,
                            const std::optional<std::string>& preset) {
  const MethodKind* named = method ? &method_named(*method) : nullptr;
  const std::string_view of_preset = preset ? preset_named(*preset).method : "";
  if (of_preset.empty()) return named != nullptr ? *named : default_method();
  if (named == nullptr || named->name == of_preset) return *find_method(of_preset);
  throw UsageError(fmt::format("--preset {}: is of method {}, expected no --method or this one",
                               *preset, of_preset));
}

bool names_several_methods(const std::string& text) {
  return text == "all" || (!text.starts_with(kExec) && text.find(',') != std::string::npos);
}

MethodChoice chosen_methods(const std::string& text) {
  if (text == "all") return all_methods();
  MethodChoice choice;
  for (std::size_t begin = 0; begin <= text.size();) {
    // A command may hold commas.
    const bool is_command = std::string_view(text).substr(begin).starts_with(kExec);
    const std::size_t end = is_command ? text.size() : std::min(text.find(',', begin), text.size());
    const std::string name = text.substr(begin, end - begin);
    method_named(name);
    if (std::ranges::find(choice.names, name) != choice.names.end()) {
      throw UsageError(fmt::format("--method: names {} twice, expected each method once", name));
    }
    choice.names.push_back(name);
    begin = end + 1;
  }
  return choice;
}

}  // namespace mosbench
