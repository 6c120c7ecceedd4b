#include "eval/tables/table_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "datasets/sequence/simulated_origin.hpp"
#include "datasets/text/errors.hpp"
#include "eval/engine/run_execute.hpp"
#include "eval/job/method_choice.hpp"
#include "eval/result/tell.hpp"
#include "eval/tables/table_print.hpp"

namespace mosbench {
namespace {

/// A method of a table's rows, their protocol and ranges.
struct TableMethod {
  const MethodKind* kind;
  std::optional<std::string> protocol;  ///< nothing: that of the preset
  std::vector<double> ranges_m = {};    ///< empty: that of any preset

  /// Returns whether a row has the range of the preset.
  bool has_row_for(const Preset& preset) const {
    const double range_m = settings_of(preset, *kind).number(common_settings::kMaxRange_m);
    return ranges_m.empty() || std::ranges::find(ranges_m, range_m) != ranges_m.end();
  }
};

/// The paper's method, then every other method of mosbench that has a row in the table, and the one
/// of preset `best`.
std::vector<TableMethod> methods_of(const PaperTable& table,
                                    const std::vector<PublishedCell>& cells) {
  std::vector<TableMethod> found = {{&default_method(), std::nullopt}};
  for (const PublishedCell& cell : cells) {
    const MethodKind* kind = cell.table == table.name ? own_method(cell) : nullptr;
    if (kind == nullptr || kind == found.front().kind) continue;
    auto method = std::ranges::find(found, kind, &TableMethod::kind);
    if (method == found.end()) method = found.insert(method, {kind, cell.protocol});
    if (cell.max_range_m) method->ranges_m.push_back(*cell.max_range_m);
  }
  found.push_back({find_method(preset_named("best").method), std::nullopt});
  return found;
}

/// Says whether the recognised layout can be the wanted data set: Sipailou looks like
/// SemanticKITTI, the layout of anything without a mark of its own.
bool can_be(DatasetKind found, DatasetKind wanted, const std::filesystem::path& root) {
  return found == wanted || (found == DatasetKind::kSemanticKitti && !simulated_origin(root));
}

/// Throws DataError unless a sequence of the table is there, before hours are spent on no cell of
/// it.
void check_is_in_table(const DataWords& data, const PaperTable& table) {
  std::optional<DatasetKind> found;
  std::vector<std::string> names;
  for (const SequenceFolder& folder :
       find_sequences(data.input, {.sequences = data.sequences}, found)) {
    names.push_back(folder.name);
  }
  const auto in_table = [&](const std::string& name) { return contains(table, name); };
  if (can_be(*found, table.dataset, data.input) && std::ranges::any_of(names, in_table)) return;
  std::vector<std::string_view> wanted;
  for (const TableColumn& column : table.columns) {
    for (const std::string_view name : column.sequences) {
      if (std::ranges::find(wanted, name) == wanted.end()) wanted.push_back(name);
    }
  }
  throw DataError(
      data.input,
      fmt::format("holds data set {} with {}", to_string(*found), fmt::join(names, ", ")),
      fmt::format("{} with one or more of {} for table {}: {}", to_string(table.dataset),
                  fmt::join(wanted, ", "), table.name, table.download));
}

Job job_for(const DataWords& data, const Preset& preset, const TableMethod& method) {
  Job job;
  job.data = data_of(data);
  job.data.kind = preset.kind;
  job.segment = {.method = method.kind, .preset = &preset};
  if (method.protocol) job.rule.protocol = &protocol_named(*method.protocol);
  return job;
}

std::string folder_for(const Preset& preset, const TableMethod& method) {
  const bool is_papers = method.kind == &default_method();
  return is_papers ? std::string(preset.name)
                   : fmt::format("{}-{}", preset.name, method.kind->name);
}

}  // namespace

const PaperTable& table_to_run(const std::string& name) {
  for (const char* number : {"I", "II", "III"}) {
    const PaperTable& table = paper_table_named(number);
    if (name == number || name == to_string(table.dataset)) return table;
  }
  throw UsageError(
      fmt::format("table:{}: is not known, expected table:I, table:II or table:III", name));
}

Answer run_table(const PaperTable& table, const DataWords& words, const RunPlace& place) {
  check_is_in_table(words, table);
  const std::filesystem::path out =
      place.out.value_or(fmt::format("results/runs/reproduce-{}", to_string(table.dataset)));
  const std::vector<PublishedCell> cells = built_in_cells();
  std::vector<ResultSet> runs;
  for (const TableMethod& method : methods_of(table, cells)) {
    for (const Preset& preset : presets()) {
      if (preset.kind != table.dataset || !method.has_row_for(preset)) continue;
      const RunPlace one{.out = out / folder_for(preset, method), .threads = place.threads};
      tell(fmt::format("method {}, preset {}", method.kind->name, preset.name));
      execute_run(plan_run(job_for(words, preset, method), one));
      runs.push_back(load_result_set(*one.out));
    }
  }
  for (const std::string& sentence : left_out(table, runs)) tell(sentence);
  return table_answer(fill_table(table, cells, runs));
}

}  // namespace mosbench
