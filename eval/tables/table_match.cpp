#include <fmt/format.h>

#include <algorithm>

#include "datasets/text/text.hpp"
#include "eval/protocols/protocol.hpp"
#include "eval/tables/table_cells.hpp"

namespace mosbench {
namespace {

void differ(const char* what, double measured, const std::optional<double>& published,
            std::vector<std::string>& reasons) {
  if (published && measured != *published) {
    reasons.push_back(fmt::format("{} {:g}, published {:g}", what, measured, *published));
  }
}

void own_mismatches(const RecordedSettings& settings, const PublishedCell& cell,
                    std::vector<std::string>& reasons) {
  const PublishedVariant published = variant_of(cell);
  const std::string value = settings.word(published.setting);
  if (value != published.value) {
    reasons.push_back(fmt::format("{} {}, published {}", published.setting, value,
                                  published.value.empty() ? "another" : published.value));
  }
  if (cell.variant.empty() && !cell.max_range_m &&
      settings.find(common_settings::kVariant) == nullptr) {
    reasons.emplace_back("the settings of the published run are not stated");
  }
  differ("voxel size in m", settings.number(common_settings::kVoxelSize_m, 0.0), cell.voxel_size_m,
         reasons);
  differ("range in m", settings.number(common_settings::kMaxRange_m, 0.0), cell.max_range_m,
         reasons);
  differ("delay in scans", settings.number(common_settings::kDelay_scans, 0.0),
         cell.delay_scans ? std::optional<double>(*cell.delay_scans) : std::nullopt, reasons);
}

/// Compares what the user of `mosbench score` says of the labels of another program.
void scored_mismatches(const Result& result, const PublishedCell& cell,
                       std::vector<std::string>& reasons) {
  if (lower_case(result.setting) != lower_case(cell.setting)) {
    reasons.push_back(fmt::format("setting '{}', published '{}'", result.setting, cell.setting));
  }
  differ("range in m", result.range.max_m, cell.max_range_m, reasons);
}

/// Returns whether a published method is the one that runs call `title`, which adds "(our reading)"
/// where no code was published.
bool is_method(const std::string& published, const std::string& title) {
  constexpr std::string_view kOurs = " (our reading)";
  const std::string_view name = title;
  const std::string_view theirs =
      name.ends_with(kOurs) ? name.substr(0, name.size() - kOurs.size()) : name;
  return lower_case(published) == lower_case(std::string(theirs));
}

/// Returns "key=value" for each published setting that the preset has otherwise.
std::vector<std::string> settings_beyond(const Preset& preset, const MethodKind& method,
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
    return settings_beyond(preset, method, published).size();
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
  std::vector<std::string> differing = settings_beyond(preset, method, published);
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

std::vector<PublishedRow> published_rows(const PaperTable& table,
                                         const std::vector<PublishedCell>& published) {
  std::vector<PublishedRow> rows;
  for (const PublishedCell& cell : published) {
    if (cell.table != table.name) continue;
    const auto row = std::ranges::find_if(rows, [&](const PublishedRow& known) {
      const PublishedCell& first = known.cells.front();
      return first.section == cell.section && first.method == cell.method &&
             first.setting == cell.setting && first.source == cell.source;
    });
    if (row == rows.end()) {
      rows.push_back({{cell}});
    } else {
      row->cells.push_back(cell);
    }
  }
  return rows;
}

const MethodKind* own_method(const PublishedCell& cell) {
  const auto found = std::ranges::find_if(methods(), [&](const MethodKind& method) {
    return is_method(cell.method, std::string(method.title));
  });
  return found == methods().end() ? nullptr : &*found;
}

std::string other_protocol(const ResultSet& run, const PublishedCell& cell) {
  const std::string_view name = run.front().protocol->name;
  return name == cell.protocol ? "" : fmt::format("protocol {}, published {}", name, cell.protocol);
}

std::vector<std::string> other_settings(const ResultSet& run, const PublishedCell& cell) {
  const Result& first = run.front();
  std::vector<std::string> reasons;
  if (first.settings) {
    own_mismatches(*first.settings, cell, reasons);
  } else {
    scored_mismatches(first, cell, reasons);
  }
  return reasons;
}

std::optional<std::size_t> nearest_row(const ResultSet& run,
                                       const std::vector<PublishedRow>& rows) {
  std::optional<std::size_t> nearest;
  std::size_t fewest = 0;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const PublishedCell& cell = rows[r].cells.front();
    if (!is_method(cell.method, run.front().method)) continue;
    const std::size_t count =
        other_settings(run, cell).size() + (other_protocol(run, cell).empty() ? 0 : 1);
    if (nearest && count >= fewest) continue;
    nearest = r;
    fewest = count;
  }
  return nearest;
}

std::vector<ResultSet> with_splits(const PaperTable& table, const std::vector<ResultSet>& runs) {
  std::vector<ResultSet> sets;
  for (const ResultSet& run : runs) {
    if (run.front().dataset != to_string(table.dataset)) continue;
    sets.push_back(run);
    const Protocol* within = find_protocol(run.front().protocol->within_split);
    if (within == nullptr) continue;
    ResultSet part = run;
    std::erase_if(part.sequences, [&](const Result& sequence) {
      return !sequence.splits.contains(std::string(within->default_split));
    });
    for (Result& sequence : part.sequences) sequence.protocol = within;
    if (!part.sequences.empty()) sets.push_back(std::move(part));
  }
  return sets;
}

std::string how_to_fill(const PaperTable& table, const TableColumn& column,
                        const PublishedCell& published) {
  return needs(table, column, command_for(table, column, published));
}

std::string how_to_fill(const PaperTable& table, const TableColumn& column, const Preset& preset) {
  return needs(table, column, "then: " + run_command(table, column, preset));
}

}  // namespace mosbench
