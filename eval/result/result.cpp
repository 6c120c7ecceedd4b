#include "eval/result/result.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "datasets/disk/folder_listing.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/result/result_file.hpp"
#include "eval/result/result_json.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

/// Objects stay in view for so many scans, 3 s at 10 Hz. A measured cell of DOALS holds scans that
/// are 72 to 200 scans apart.
constexpr double kInViewScans = 30.0;
/// Longer numbers are stamps in nanoseconds.
constexpr std::uint64_t kLargestScanNumber = 1'000'000'000'000;
constexpr double kNsPerScan = 1e8;

double number_difference(const std::string& earlier, const std::string& later) {
  const auto from = stem_number(earlier), to = stem_number(later);
  if (!from || !to || *to < *from) return 0.0;
  const auto difference = static_cast<double>(*to - *from);
  return *from > kLargestScanNumber ? difference / kNsPerScan : difference;
}

bool same_run(const Result& a, const Result& b) {
  return a.dataset == b.dataset && a.method == b.method && a.setting == b.setting &&
         a.protocol == b.protocol && a.range == b.range && a.from.odometry == b.from.odometry &&
         a.settings == b.settings && disturbance_of(a) == disturbance_of(b);
}

void add_to_runs(Result result, std::vector<ResultSet>& sets, const fs::path& path) {
  const auto set = std::ranges::find_if(
      sets, [&](const ResultSet& known) { return same_run(known.front(), result); });
  if (set == sets.end()) {
    sets.push_back({path, {std::move(result)}});
    return;
  }
  const auto twin = std::ranges::find(set->sequences, result.sequence, &Result::sequence);
  if (twin != set->sequences.end()) {
    throw DataError(result.file,
                    "scores sequence " + result.sequence.text() + " like " + twin->file.string(),
                    "one result per sequence of a run");
  }
  set->sequences.push_back(std::move(result));
}

/// Whether two runs have the same sequence.
bool has_twins(const std::vector<ResultSet>& runs) {
  std::set<SequenceName> names;
  for (const ResultSet& run : runs) {
    for (const Result& sequence : run.sequences) {
      if (!names.insert(sequence.sequence).second) return true;
    }
  }
  return false;
}

/// One run of several, as jobs of a cluster leave a folder each.
ResultSet joined(std::vector<ResultSet> runs) {
  ResultSet whole = std::move(runs.front());
  for (std::size_t i = 1; i < runs.size(); ++i) {
    std::ranges::move(runs[i].sequences, std::back_inserter(whole.sequences));
  }
  std::ranges::sort(whole.sequences, {}, &Result::sequence);
  return whole;
}

/// Runs that have sequences in common: those of one simulation are one, others stay as they are.
std::vector<ResultSet> joined_by_simulation(std::vector<ResultSet> runs) {
  std::map<std::string, std::vector<ResultSet>> of_simulation;
  for (ResultSet& run : runs) of_simulation[simulation_of(run.front())].push_back(std::move(run));
  std::vector<ResultSet> all;
  for (auto& [simulation, same] : of_simulation) {
    if (!simulation.empty() && !has_twins(same)) same = {joined(std::move(same))};
    std::ranges::move(same, std::back_inserter(all));
  }
  return all;
}

/// The folders to give instead of the one that holds them all: ": one of a, b"; nothing where runs
/// share a folder.
std::string folders_text(const std::vector<ResultSet>& sets) {
  std::set<std::string> folders;
  for (const ResultSet& set : sets) {
    folders.insert(folder_of_run(set.front().folder(), set.front().sequence).string());
  }
  return folders.size() < sets.size() ? "" : fmt::format(": one of {}", fmt::join(folders, ", "));
}

/// Names the file and what tells its run from others.
std::string run_text(const Result& result) {
  return fmt::format("{} ({}; {})", result.file.string(), method_words(result),
                     result.protocol->name);
}

}  // namespace

bool are_labels_of(const ScanRow& row, std::span<const std::uint32_t> labels) {
  if (row.label_hash) return hash_of_labels(labels) == row.label_hash;
  const auto moving = static_cast<std::size_t>(std::ranges::count(labels, kMovingLabel));
  return moving == row.predicted_moving_points;
}

void add_stages(const std::vector<StageTime>& stages, Timing& timing, ScanCost& cost) {
  for (const StageTime& stage : stages) {
    const auto found = std::ranges::find(timing.stages, stage.name);
    const auto position = static_cast<std::size_t>(found - timing.stages.begin());
    if (found == timing.stages.end()) timing.stages.emplace_back(stage.name);
    if (cost.stages_ms.size() <= position) cost.stages_ms.resize(position + 1);
    cost.stages_ms[position] += stage.wall_ms;
  }
}

std::optional<double> method_ms_per_scan(const Result& result) {
  if (!result.timing || result.timing->costs.empty()) return std::nullopt;
  double sum_ms = 0.0;
  for (const ScanCost& cost : result.timing->costs) sum_ms += cost.push_ms;
  return sum_ms / static_cast<double>(result.timing->costs.size());
}

std::optional<double> most_resident_mib(const Result& result) {
  std::optional<double> most;
  if (!result.timing) return most;
  for (const ScanCost& cost : result.timing->costs) {
    most = std::max(most, std::optional(cost.resident_mib));
  }
  return most;
}

std::string method_words(const Result& result) {
  return result.method + (result.setting.empty() ? "" : ", ") + result.setting;
}

std::optional<std::string> only_split(const Result& result) {
  const bool is_own = result.summary_split == std::string(result.protocol->default_split);
  return is_own ? std::nullopt : result.summary_split;
}

std::string disturbance_of(const Result& result) { return reading_statement(result, "perturb"); }

std::string reading_statement(const Result& result, std::string_view name) {
  const auto found =
      std::ranges::find(result.from.reading, name, &ReadingMembers::value_type::first);
  return found == result.from.reading.end() ? "" : found->second;
}

std::string simulation_of(const Result& result) {
  const std::optional<SimulatedOrigin>& origin = result.from.simulated;
  return origin ? fmt::format("{} {} {}", origin->scene, origin->seed, origin->perturb.value_or(""))
                : "";
}

std::optional<RunCost> run_cost(const Result& result) {
  const bool is_program = find_method(result.kind) == nullptr;  // the user's
  if (result.cost || !result.timing || result.scans.empty()) {
    std::optional<RunCost> accepted = result.cost;
    // Versions that told no machine took the time of programs by the wall.
    if (accepted && is_program && !accepted->machine) accepted->core_ms_per_scan.reset();
    return accepted;
  }
  const auto& cpu_s = is_program ? result.timing->program_cpu_s : result.timing->core_s;
  RunCost cost{.calibration_ms = result.timing->calibration_ms,
               .most_resident_mib = most_resident_mib(result).value_or(0.0),
               .machine = result.from.machine};
  if (cpu_s) cost.core_ms_per_scan = 1e3 * *cpu_s / static_cast<double>(result.scans.size());
  std::error_code error;
  for (fs::recursive_directory_iterator it(result.folder(), error), end; !error && it != end;
       it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (name == "result.json") continue;
    if (it.depth() == 0) cost.what_written.push_back(name);
    if (it->is_regular_file(error)) cost.bytes_written += it->file_size(error);
  }
  std::ranges::sort(cost.what_written);
  return cost;
}

std::vector<const ScanRow*> counted_scans(const Result& result) {
  const std::string own_split(result.protocol->default_split);
  const auto split = result.splits.find(own_split);
  std::vector<const ScanRow*> scans;
  // Of a sequence outside of the split nothing counts.
  if (split == result.splits.end() && result.summary_split == own_split) return scans;
  for (const ScanRow& row : result.scans) {
    if (!row.counts) continue;
    if (split == result.splits.end() || split->second.contains(row.stem)) scans.push_back(&row);
  }
  return scans;
}

SequenceCounts counts_of(const Result& result) {
  SequenceCounts counts;
  for (const ScanRow* row : counted_scans(result)) counts.push_back(*row->counts);
  return counts;
}

std::vector<ResultSet> sorted_into_runs(std::vector<Result> results, const fs::path& path) {
  std::vector<ResultSet> sets;
  for (Result& result : results) add_to_runs(std::move(result), sets, path);
  for (ResultSet& set : sets) std::ranges::sort(set.sequences, {}, &Result::sequence);
  return sets;
}

std::vector<ResultSet> load_result_sets(const fs::path& path) {
  return sorted_into_runs(read_results(path), path);
}

std::vector<ResultSet> load_runs_of_folders(const fs::path& path) {
  std::map<fs::path, std::vector<Result>> places;
  for (Result& result : read_results(path)) {
    const fs::path folder = folder_of_run(result.folder(), result.sequence);
    places[folder].push_back(std::move(result));
  }
  std::vector<std::vector<ResultSet>> of_setting;
  for (auto& [folder, results] : places) {
    for (ResultSet& run : sorted_into_runs(std::move(results), path)) {
      const auto known = std::ranges::find_if(of_setting, [&](const auto& runs) {
        return same_run(runs.front().front(), run.front());
      });
      auto& runs = known == of_setting.end() ? of_setting.emplace_back() : *known;
      runs.push_back(std::move(run));
    }
  }
  std::vector<ResultSet> all;
  for (std::vector<ResultSet>& runs : of_setting) {
    runs = has_twins(runs) ? joined_by_simulation(std::move(runs))
                           : std::vector{joined(std::move(runs))};
    std::ranges::move(runs, std::back_inserter(all));
  }
  return all;
}

ResultSet load_result_set(const fs::path& path) {
  std::vector<ResultSet> sets = load_result_sets(path);
  if (sets.size() == 1) return std::move(sets.front());
  throw DataError(path,
                  fmt::format("holds {} runs: {} differs from {}", sets.size(),
                              run_text(sets[1].front()), run_text(sets[0].front())),
                  "the results of one run" + folders_text(sets));
}

fs::path folder_of_run(const fs::path& result_folder, const SequenceName& sequence) {
  fs::path run = result_folder;
  fs::path rest = sequence.folder();
  while (!rest.empty() && run.filename() == rest.filename()) {
    run = run.parent_path();
    rest = rest.parent_path();
  }
  return rest.empty() && run.has_filename() ? run : result_folder;
}

std::vector<SequenceCounts> counts_of(std::span<const Result> sequences) {
  std::vector<SequenceCounts> counts;
  for (const Result& result : sequences) counts.push_back(counts_of(result));
  return counts;
}

ScanGaps& ScanGaps::operator+=(const ScanGaps& other) {
  neighbours += other.neighbours;
  shared += other.shared;
  return *this;
}

ScanGaps gaps_of(const Result& result) {
  ScanGaps gaps;
  const std::vector<const ScanRow*> scans = counted_scans(result);
  for (std::size_t k = 1; k < scans.size(); ++k) {
    // Scans that have no row lie between others by their names only.
    const double apart_scans = std::max(static_cast<double>(scans[k] - scans[k - 1]),
                                        number_difference(scans[k - 1]->stem, scans[k]->stem));
    gaps += {1.0, std::exp(-apart_scans / kInViewScans)};
  }
  return gaps;
}

}  // namespace mosbench
