#include "eval/engine/study_plan.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/thread_pool.hpp"
#include "datasets/disk/claim.hpp"
#include "datasets/disk/files.hpp"
#include "datasets/text/counted.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/json_text.hpp"
#include "eval/protocols/metrics.hpp"
#include "eval/result/result_file.hpp"
#include "eval/result/tell.hpp"
#include "eval/result/version.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

/// The worst of the scans that count. Those whose map is still empty show nothing but that, and are
/// left out of longer sequences. Of scans with the same IoU, one with more wrong points is worse.
std::optional<BadScan> worst_scan(const Result& result) {
  constexpr std::size_t kWarmUpScans = 10;
  const std::size_t skipped = result.scans.size() > 2 * kWarmUpScans ? kWarmUpScans : 0;
  std::optional<BadScan> worst;
  for (const ScanRow* row : counted_scans(result)) {
    const std::optional<double> iou = moving_iou(*row->counts);
    if (row < result.scans.data() + skipped || !iou) continue;
    const auto wrong = static_cast<std::int64_t>(row->counts->fp + row->counts->fn);
    if (worst && std::pair(worst->iou, -worst->wrong) <= std::pair(*iou, -wrong)) continue;
    worst = BadScan{row->stem, *iou, wrong};
  }
  return worst;
}

/// What a file says of a cell; nothing where it is missing, damaged or of another cell, which is
/// then computed again.
template <typename Read>
auto unless_damaged(const fs::path& file, Read&& read) -> decltype(read()) {
  if (!is_there(file)) return std::nullopt;
  try {
    return read();
  } catch (const DataError&) {
  } catch (const nlohmann::json::exception&) {
  }
  return std::nullopt;
}

std::optional<CellNumbers> result_in(const fs::path& file, const std::string& key) {
  return unless_damaged(file, [&]() -> std::optional<CellNumbers> {
    const Result result = read_result(file);
    if (result.key != key) return std::nullopt;
    return numbers_of(result);
  });
}

std::optional<std::string> failure_in(const fs::path& file, const std::string& key) {
  return unless_damaged(file, [&]() -> std::optional<std::string> {
    const ordered_json json = parse_json(read_file(file), file);
    if (json.at("key") != key) return std::nullopt;
    return json.at("failure").get<std::string>();
  });
}

/// Tells of what an earlier mosbench kept as one file per cell.
void note_old_records(const fs::path& out) {
  std::size_t records = 0;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(out / "cells", ignored)) {
    records += entry.path().extension() == ".json" ? 1U : 0U;
  }
  if (records == 0) return;
  tell(fmt::format("{}: {} of an earlier mosbench, not used: cells have folders now; remove them",
                   (out / "cells").string(), counted(records, "record is", "records are")));
}

}  // namespace

CellNumbers numbers_of(const Result& result) {
  CellNumbers numbers;
  numbers.version = result.from.version;
  numbers.simulated = result.is_simulated();
  const SequenceCounts counts = counts_of(result);
  numbers.scored = !counts.empty();
  if (numbers.scored) {
    const Summary summary = summarize(*result.protocol, counts);
    for (std::size_t i = 0; i < kBriefMetrics.size(); ++i) {
      numbers.metrics[i] = summary[kBriefMetrics[i]];
    }
  }
  numbers.ms_per_scan = method_ms_per_scan(result);
  if (result.timing) {
    numbers.wall_s = result.timing->wall_s;
    numbers.core_s = result.timing->core_s;
  }
  numbers.worst = worst_scan(result);
  return numbers;
}

void look_up(PlannedCell& planned, const fs::path& out) {
  const std::string& key = planned.cell.key;
  const fs::path folder = cell_folder(out, key);
  const auto result = result_in(folder / "result.json", key);
  const auto failure = result ? std::nullopt : failure_in(folder / "failure.json", key);
  planned.numbers = result.value_or(CellNumbers{});
  planned.failure = failure.value_or("");
  if (result) {
    const bool is_own = result->version == kMosbenchVersion;
    planned.state = is_own ? CellState::kDone : CellState::kOtherVersion;
  } else {
    planned.state = failure ? CellState::kFailed : CellState::kMissing;
  }
}

StudyPlan plan_study(const Study& study, const fs::path& out,
                     const std::vector<std::string>& only) {
  StudyPlan plan{&study, out, {}, std::nullopt};
  std::vector<StudyCell> cells = cells_of(study);
  plan.rule = shared_rule(study, cells);
  for (StudyCell& cell : cells) {
    const bool wanted = only.empty() || std::ranges::find(only, cell.key) != only.end();
    if (wanted) plan.cells.push_back({.cell = std::move(cell)});
  }
  if (!is_there(out / "cells")) return plan;
  note_old_records(out);
  ThreadPool pool(hardware_threads());
  pool.for_ranges(plan.cells.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
    for (std::size_t i = begin; i < end; ++i) look_up(plan.cells[i], out);
  });
  return plan;
}

std::string_view to_string(CellState state) {
  static constexpr std::array<std::string_view, 4> kStates = {"missing", "failed", "other version",
                                                              "done"};
  return kStates[static_cast<std::size_t>(state)];
}

fs::path cell_folder(const fs::path& out, const std::string& key) { return out / "cells" / key; }

fs::path place_of(const fs::path& out, const Data& data) {
  return data.simulation ? out / "data" / simulation_key(*data.simulation) : data.path;
}

void clear_study(const fs::path& out) {
  for (const fs::path& folder : {out, out / "cells", out / "data"}) remove_abandoned(folder);
}

}  // namespace mosbench
