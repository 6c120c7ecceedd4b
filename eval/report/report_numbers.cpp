#include "eval/report/report_numbers.hpp"

#include <algorithm>

#include "core/base/thread_pool.hpp"
#include "datasets/text/errors.hpp"
#include "eval/breakdown/breakdown.hpp"
#include "eval/statistics/scan_spacing.hpp"
#include "eval/statistics/statistics_report.hpp"
#include "eval/tables/score_report.hpp"
#include "eval/tables/table_print.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kListed = 50;  // objects, and false positives

/// Every protocol with its default range, that of the run with the run's range.
std::vector<ScoreRule> rules_beside(const ScoreRule& own) {
  std::vector<ScoreRule> rules;
  for (const Protocol& protocol : protocols()) {
    rules.push_back({&protocol, &protocol == own.protocol ? own.range : protocol.default_range});
  }
  return rules;
}

bool is_measured(const FilledTable& table) {
  return std::ranges::any_of(table.rows, [](const TableRow& row) {
    return std::ranges::any_of(row.cells,
                               [](const TableCell& cell) { return cell.measured.has_value(); });
  });
}

/// Returns the runs of recorded data; none of a folder that holds the same sequence and run twice,
/// because it is unclear which of the two a table should show.
std::vector<ResultSet> recorded_runs(const std::vector<std::filesystem::path>& inputs) {
  std::vector<ResultSet> runs;
  for (const std::filesystem::path& input : inputs) {
    try {
      for (ResultSet& run : load_result_sets(input)) {
        if (!run.front().is_simulated()) runs.push_back(std::move(run));
      }
    } catch (const DataError&) {
      continue;
    }
  }
  return runs;
}

}  // namespace

ordered_json estimates_of(const Result& result) {
  const std::vector<SequenceCounts> counts = {counts_of(result)};
  if (counts.front().empty()) return nullptr;
  return to_json(estimate(*result.protocol, counts, spacing_of(result)));
}

ordered_json breakdown_of(const ResultScans& scans) {
  const std::vector<std::size_t> wanted = scans.scored_scans();
  if (wanted.empty()) return nullptr;
  return to_json(break_down(scans.sequence(), wanted, scans.labels(),
                            {scans.rule().protocol, scans.rule().range, hardware_threads()}),
                 kListed);
}

ordered_json protocols_of(const ResultScans& scans) {
  const std::size_t labelled = scans_with_truth(scans.sequence()).size();
  if (labelled == 0 || scans.scored_scans().size() < labelled) return nullptr;
  const std::vector<ScoreRule> rules = rules_beside(scans.rule());
  const ScoreTask task{scans.source().path, scans.source().options, rules, std::nullopt,
                       hardware_threads()};
  const auto scores = score_dataset(scans.dataset(), task);
  return side_by_side_json(scans.dataset(), rules, scores).at("protocols");
}

ordered_json covered_tables(const std::vector<std::filesystem::path>& inputs) {
  const std::vector<ResultSet> runs = recorded_runs(inputs);
  const auto published = built_in_cells();
  ordered_json tables = ordered_json::array();
  for (const PaperTable& table : paper_tables()) {
    const bool about_these = std::ranges::any_of(runs, [&](const ResultSet& run) {
      return run.front().dataset == to_string(table.dataset);
    });
    if (!about_these) continue;
    const FilledTable filled = fill_table(table, published, runs);
    if (is_measured(filled)) tables.push_back(to_json(filled));
  }
  return tables;
}

}  // namespace mosbench
