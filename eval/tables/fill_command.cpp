#include "eval/tables/fill_command.hpp"

#include <fmt/format.h>

#include "eval/protocols/protocol.hpp"
#include "eval/runs/presets.hpp"
#include "eval/tables/table_match.hpp"

namespace mosbench {
namespace {

/// "key=value" for each published setting that the preset has otherwise.
std::vector<std::string> other_settings(const Preset& preset, const PublishedCell& published) {
  std::vector<std::string> assignments;
  const auto compare = [&](const char* key, double ours, const std::optional<double>& theirs) {
    if (theirs && *theirs != ours) assignments.push_back(fmt::format("{}={:g}", key, *theirs));
  };
  compare("voxel_size_m", preset.config.voxel_size_m, published.voxel_size_m);
  compare("max_range_m", preset.config.max_range_m, published.max_range_m);
  compare("delay_scans", preset.config.delay_scans, published.delay_scans);
  return assignments;
}

const Preset& nearest_preset(DatasetKind dataset, const PublishedCell& published) {
  const Preset* nearest = &default_preset(dataset);
  for (const Preset& preset : presets()) {
    if (preset.kind != dataset) continue;
    const std::size_t count = other_settings(preset, published).size();
    if (count < other_settings(*nearest, published).size()) nearest = &preset;
  }
  return *nearest;
}

std::string run_command(const PaperTable& table, const TableColumn& column,
                        const PublishedCell& published) {
  const Preset& preset = nearest_preset(table.dataset, published);
  std::string command =
      fmt::format("mosbench run DIR --dataset {} --sequences {} --preset {}",
                  to_string(table.dataset), fmt::join(column.sequences, ","), preset.name);
  if (published.variant != "paper-2024") command += " --variant " + published.variant;
  if (preset.protocol != published.protocol) command += " --protocol " + published.protocol;
  const std::vector<std::string> assignments = other_settings(preset, published);
  if (assignments.empty()) return command;
  return command + fmt::format(" --set {}", fmt::join(assignments, " "));
}

std::string command_for(const PaperTable& table, const TableColumn& column,
                        const PublishedCell& published) {
  if (is_own(published)) {
    if (published.variant.empty()) return "no variant of this program is that one";
    return "then: " + run_command(table, column, published);
  }
  std::string command = fmt::format("then: mosbench score DIR --dataset {} --predictions LABELS",
                                    to_string(table.dataset));
  if (find_protocol(published.protocol) != nullptr) command += " --protocol " + published.protocol;
  return command + " --method " + published.method;
}

}  // namespace

std::string how_to_fill(const PaperTable& table, const TableColumn& column,
                        const PublishedCell& published) {
  return fmt::format("needs {} of {}; {}", fmt::join(column.sequences, ", "), table.download,
                     command_for(table, column, published));
}

}  // namespace mosbench
