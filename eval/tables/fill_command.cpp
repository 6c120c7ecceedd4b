#include "eval/tables/fill_command.hpp"

#include <fmt/format.h>

#include "datasets/text/text.hpp"
#include "eval/protocols/protocol.hpp"
#include "eval/tables/table_match.hpp"

namespace mosbench {
namespace {

/// Returns "key=value" for each published setting that the preset has otherwise.
std::vector<std::string> other_settings(const Preset& preset, const MethodKind& method,
                                        const PublishedCell& published) {
  const Settings ours = settings_of(preset, method);
  std::vector<std::string> assignments;
  const auto compare = [&](std::string_view name, const std::optional<double>& theirs) {
    if (theirs && *theirs != ours.number(name)) {
      assignments.push_back(fmt::format("{}={:g}", name, *theirs));
    }
  };
  compare(common_settings::kVoxelSize_m, published.voxel_size_m);
  compare(common_settings::kMaxRange_m, published.max_range_m);
  compare(common_settings::kDelay_scans, published.delay_scans);
  const auto& [setting, value] = variant_of(published);
  if (!value.empty() && value != ours.choice(setting)) {
    assignments.push_back(fmt::format("{}={}", setting, value));
  }
  return assignments;
}

const Preset& nearest_preset(DatasetKind dataset, const MethodKind& method,
                             const PublishedCell& published) {
  const auto count = [&](const Preset& preset) {
    return other_settings(preset, method, published).size();
  };
  const Preset* nearest = &default_preset(dataset);
  for (const Preset& preset : presets()) {
    if (preset.kind == dataset && count(preset) < count(*nearest)) nearest = &preset;
  }
  return *nearest;
}

std::string run_command(const PaperTable& table, const TableColumn& column, const Preset& preset) {
  return fmt::format("mosbench run DIR --dataset {} --sequences {} --preset {}",
                     to_string(table.dataset),
                     shell_word(fmt::format("{}", fmt::join(column.sequences, ","))), preset.name);
}

/// A run whose folder is not named by what differs from the preset gets a folder that is.
std::string run_command(const PaperTable& table, const TableColumn& column,
                        const PublishedCell& published, const MethodKind& method) {
  const Preset& preset = nearest_preset(table.dataset, method, published);
  std::string command = run_command(table, column, preset);
  if (&method != &default_method()) command += fmt::format(" --method {}", method.name);
  std::vector<std::string> differing = other_settings(preset, method, published);
  if (!differing.empty()) command += fmt::format(" --set {}", fmt::join(differing, ","));
  if (preset.protocol != published.protocol) {
    command += " --protocol " + shell_word(published.protocol);
    differing.push_back(published.protocol);
  }
  if (differing.empty()) return command;
  return command + " --out " +
         shell_word(fmt::format("results/runs/{}-{}-{}", preset.name, method.name,
                                fmt::join(differing, "-")));
}

std::string score_command(const PaperTable& table, const PublishedCell& published) {
  std::string command =
      fmt::format("mosbench score DIR --dataset {} --predictions LABELS", to_string(table.dataset));
  if (find_protocol(published.protocol) != nullptr)
    command += " --protocol " + shell_word(published.protocol);
  return command + " --method " + shell_word(published.method);
}

std::string command_for(const PaperTable& table, const TableColumn& column,
                        const PublishedCell& published) {
  const MethodKind* method = own_method(published);
  if (method == nullptr) return "then: " + score_command(table, published);
  const bool has_variants = method->defaults.find(common_settings::kVariant) != nullptr;
  if (has_variants && published.variant.empty()) return "no variant of this program is that one";
  return "then: " + run_command(table, column, published, *method);
}

std::string needs(const PaperTable& table, const TableColumn& column, const std::string& then) {
  return fmt::format("needs {} of {}; {}", fmt::join(column.sequences, ", "), table.download, then);
}

}  // namespace

std::string how_to_fill(const PaperTable& table, const TableColumn& column,
                        const PublishedCell& published) {
  return needs(table, column, command_for(table, column, published));
}

std::string how_to_fill(const PaperTable& table, const TableColumn& column, const Preset& preset) {
  return needs(table, column, "then: " + run_command(table, column, preset));
}

}  // namespace mosbench
