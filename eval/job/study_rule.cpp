#include <fmt/format.h>

#include <algorithm>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/job/study_cells.hpp"
#include "eval/protocols/protocol_list.hpp"

namespace mosbench {
namespace {

/// The cells that one rule scores.
struct RuledCells {
  ScoreRule rule;
  std::vector<const StudyCell*> cells;
};

std::optional<ScoreRule> rule_unless_refused(const StudyCell& cell) {
  try {
    return rule_of(cell.job, cell.kind);
  } catch (const UsageError&) {
    return std::nullopt;
  }
}

std::vector<RuledCells> by_rule(const std::vector<StudyCell>& cells) {
  std::vector<RuledCells> groups;
  for (const StudyCell& cell : cells) {
    const auto rule = rule_unless_refused(cell);
    if (!rule) continue;
    auto group = std::ranges::find(groups, *rule, &RuledCells::rule);
    if (group == groups.end()) group = groups.insert(group, {*rule, {}});
    group->cells.push_back(&cell);
  }
  return groups;
}

/// "room-1", or where only some cells of the data have the rule, "room-1, near, max_range_m=9".
std::string subject(const StudyCell& cell, const std::vector<RuledCells>& groups) {
  const auto has_data = [&](const RuledCells& group) {
    return std::ranges::find(group.cells, cell.data, &StudyCell::data) != group.cells.end();
  };
  if (std::ranges::count_if(groups, has_data) == 1) return cell.data->name;
  std::string text = fmt::format("{}, {}", cell.data->name, cell.method->name);
  if (cell.axis != nullptr) text += fmt::format(", {}={}", cell.axis->name, cell.value);
  return text;
}

std::string subjects(const RuledCells& group, const std::vector<RuledCells>& groups) {
  constexpr std::size_t kNamed = 4;
  std::vector<std::string> names;
  for (const StudyCell* cell : group.cells) {
    const std::string name = mosbench::quoted(subject(*cell, groups));
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  }
  const std::size_t more = names.size() - std::min(names.size(), kNamed);
  names.resize(names.size() - more);
  return fmt::format("{}{}", fmt::join(names, ", "),
                     more == 0 ? "" : fmt::format(" and {} more", more));
}

/// The keys that make the rules one.
std::string missing_keys(const Study& study, const std::vector<RuledCells>& groups) {
  const Protocol* first = groups.front().rule.protocol;
  const bool same_protocol = std::ranges::all_of(
      groups, [&](const RuledCells& group) { return group.rule.protocol == first; });
  if (!same_protocol) {
    return fmt::format("give the key \"protocol:\", as `protocol: {}`", first->name);
  }
  const std::string range = "give the key \"range_m:\", as `range_m: [0.5, 20]`";
  return study.rule.protocol != nullptr ? range
                                        : fmt::format("{}, and `protocol: {}`", range, first->name);
}

[[noreturn]] void refuse(const Study& study, const std::vector<RuledCells>& groups) {
  std::string rules;
  for (const RuledCells& group : groups) {
    rules += fmt::format("{}{} by {}", rules.empty() ? "" : "; ", subjects(group, groups),
                         rule_name(group.rule));
  }
  throw UsageError(fmt::format(
      "{}: averages what different rules count: {}, expected the same for all: {}, or make a "
      "study of each",
      study.file.string(), rules, missing_keys(study, groups)));
}

}  // namespace

std::optional<ScoreRule> shared_rule(const Study& study, const std::vector<StudyCell>& cells) {
  const std::vector<RuledCells> groups = by_rule(cells);
  if (groups.empty()) return std::nullopt;
  if (groups.size() > 1) refuse(study, groups);
  return groups.front().rule;
}

}  // namespace mosbench
