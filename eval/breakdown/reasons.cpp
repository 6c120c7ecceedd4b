#include "eval/breakdown/reasons.hpp"

#include <mutex>
#include <numeric>
#include <vector>

#include "core/base/thread_pool.hpp"
#include "eval/result/tell.hpp"

namespace mosbench {
namespace {

constexpr std::array<const char*, ReasonTable{}.size()> kNames = {
    "missed", "arrived", "departed", "grown", "feet", "predicted", "called moving"};

std::size_t row_of(const JudgedScan& scan, std::size_t point) {
  if (!scan.reasons.empty()) return static_cast<std::size_t>(scan.reasons[point]);
  return scan.outcomes[point] == PointOutcome::kFalseNegative ? 0 : kReasonCount;
}

void add(const JudgedScan& scan, const std::vector<ErrorScene>& scenes, ReasonTable& table) {
  for (std::size_t i = 0; i < scan.outcomes.size(); ++i) {
    ReasonCounts& counts = table.at(row_of(scan, i));
    const PointOutcome outcome = scan.outcomes[i];
    counts.tp += outcome == PointOutcome::kTruePositive ? 1U : 0U;
    counts.fp += outcome == PointOutcome::kFalsePositive ? 1U : 0U;
    counts.fn += outcome == PointOutcome::kFalseNegative ? 1U : 0U;
    ++counts.scenes.at(static_cast<std::size_t>(scenes[i]));
  }
}

}  // namespace

ReasonTable count_reasons(const ResultScans& scans, unsigned threads) {
  const std::vector<double> times_s = times_of_all(scans.sequence());
  const std::vector<std::size_t> scored = scans.scored_scans();
  ReasonTable table{};
  ThreadPool pool(threads);
  Progress progress("errors of " + scans.sequence().name(), scored.size());
  std::mutex table_mutex;
  pool.for_ranges(scored.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
    for (std::size_t i = begin; i < end; ++i) {
      const JudgedScan scan = scans.read(scored[i]);
      const std::vector<ErrorScene> scenes = error_scenes(scans, scored[i], scan, times_s);
      const std::lock_guard lock(table_mutex);
      add(scan, scenes, table);
      progress.advance();
    }
  });
  return table;
}

nlohmann::ordered_json to_json(const ReasonTable& table) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < table.size(); ++i) {
    const ReasonCounts& counts = table[i];
    if (counts.tp + counts.fp + counts.fn == 0) continue;
    nlohmann::ordered_json row = {
        {"reason", kNames[i]}, {"tp", counts.tp}, {"fp", counts.fp}, {"fn", counts.fn}};
    for (std::size_t s = 1; s < counts.scenes.size(); ++s) {
      row["scenes"][kErrorSceneNames[s]] = counts.scenes[s];
    }
    json.push_back(std::move(row));
  }
  return json;
}

Sheet reasons_sheet(const ReasonTable& table) {
  Sheet sheet{.columns = {{"decided by", Unit::kText}, {"right"}, {"wrong"}}};
  for (std::size_t s = 1; s < kErrorSceneNames.size(); ++s) {
    sheet.columns.push_back({kErrorSceneNames[s]});
  }
  for (std::size_t i = 0; i < table.size(); ++i) {
    const ReasonCounts& counts = table[i];
    if (counts.tp + counts.fp + counts.fn == 0) continue;
    std::vector<Cell>& cells = sheet.rows.emplace_back();
    cells = {kNames[i], counts.tp, counts.fp + counts.fn};
    for (std::size_t s = 1; s < counts.scenes.size(); ++s) cells.emplace_back(counts.scenes[s]);
  }
  return sheet;
}

}  // namespace mosbench
