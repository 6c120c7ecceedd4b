#include "eval/engine/run_execute.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <iterator>

#include "core/base/stage_clock.hpp"
#include "datasets/disk/files.hpp"
#include "datasets/disk/partial_file.hpp"
#include "datasets/doctor/doctor.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/sequence/pose_mark.hpp"
#include "datasets/sequence/rig_fit.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/exec/child_process.hpp"
#include "eval/job/study_drives.hpp"
#include "eval/job/tuned_preset.hpp"
#include "eval/result/machine.hpp"
#include "eval/result/result.hpp"
#include "eval/result/result_file.hpp"
#include "eval/result/tell.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

using Clock = std::chrono::steady_clock;

/// "000000 to 000009, 000058": the scans that were not judged, as far as there is room.
std::string unjudged_text(const std::vector<ScanRow>& rows) {
  constexpr std::size_t kMostRanges = 4;
  std::vector<std::string> ranges;
  for (std::size_t first = 0; first < rows.size(); ++first) {
    if (rows[first].judged) continue;
    std::size_t last = first;
    while (last + 1 < rows.size() && !rows[last + 1].judged) ++last;
    ranges.push_back(last == first ? rows[first].stem
                                   : rows[first].stem + " to " + rows[last].stem);
    first = last;
  }
  if (ranges.size() > kMostRanges) {
    ranges.resize(kMostRanges);
    ranges.emplace_back("...");
  }
  return fmt::format("{}", fmt::join(ranges, ", "));
}

std::vector<std::string> all_remarks(const Sequence& sequence, const Result& result) {
  std::vector<std::string> remarks = sequence.remarks();
  if (!result.settings_from.empty()) remarks.push_back("settings of " + result.settings_from);
  if (const auto unjudged = std::ranges::count(result.scans, false, &ScanRow::judged);
      unjudged > 0) {
    remarks.push_back(fmt::format(
        "{} of {} labelled static without detection, because the method has seen too few "
        "scans before or after them: {}",
        unjudged, counted(sequence.size(), "scan is", "scans are"), unjudged_text(result.scans)));
  }
  remarks.insert(remarks.end(), result.remarks.begin(), result.remarks.end());
  std::size_t nonfinite_points = 0;
  for (const ScanRow& row : result.scans) nonfinite_points += row.nonfinite_points;
  if (nonfinite_points > 0) {
    remarks.push_back(fmt::format("{} NaN or infinite: left out of the map and labelled static",
                                  counted(nonfinite_points, "point is", "points are")));
  }
  return remarks;
}

/// Where and how `report` and `render` find the points again; folders are this machine's. Of the
/// run all sequences, by which an interrupted one is known.
Places places_of(const RunPlan& plan, const PlannedSequence& planned) {
  Places places{
      fs::absolute(plan.dataset.root), plan.job.data.reading, std::nullopt, planned.stamp, {}};
  for (const PlannedSequence& each : plan.sequences) {
    places.sequences_of_run.push_back(plan.dataset.sequences[each.position]->name());
  }
  return places;
}

/// Adds to what the runner found what is known of the plan; `found` are the poses by odometry.
Result completed(const RunPlan& plan, const PlannedSequence& planned, Result ran,
                 const std::vector<ScanPose>& found) {
  const Sequence& sequence = *plan.dataset.sequences[planned.position];
  Result result = planned.asked;
  result.scans = std::move(ran.scans);
  result.timing = std::move(ran.timing);
  result.remarks = std::move(ran.remarks);
  result.doubts = doubts_of(sequence);
  std::ranges::move(ran.doubts, std::back_inserter(result.doubts));
  if (plan.job.segment.is_program() && !sequence.recording().lidars.empty()) {
    result.doubts.emplace_back("the program is not told at which LiDAR each ray starts");
  }
  result.remarks = all_remarks(sequence, result);
  result.from.fingerprint = std::move(ran.from.fingerprint);
  result.from.fingerprint_without_poses = std::move(ran.from.fingerprint_without_poses);
  result.from.machine = this_machine();
  result.from.simulated = sequence.simulated();
  if (plan.job.segment.tuned) {
    std::string doubt =
        tuning_doubt(*plan.job.segment.tuned, result, scan_hashes(plan.job.data, sequence.name()));
    if (!doubt.empty()) result.doubts.push_back(std::move(doubt));
  }
  if (plan.odometry) result.doubtful_poses = doubtful_poses(sequence, found);
  for (const ScanEntry& scan : sequence.recording().left_out) {
    result.scans_left_out.push_back(scan.stem);
  }
  result.places = places_of(plan, planned);
  return result;
}

/// Finds and sets the poses of a sequence.
std::vector<ScanPose> take_poses(const RunPlan& plan, std::size_t position) {
  Sequence& sequence = *plan.dataset.sequences[position];
  const unsigned threads = plan.settings.threads;
  std::vector<ScanPose> found =
      plan.shared ? plan.shared->poses_of(position, sequence, *plan.odometry, threads)
                  : find_poses(sequence, *plan.odometry, threads);
  set_poses(sequence, *plan.odometry, found);
  return found;
}

}  // namespace

ComputedSequence compute_sequence(const RunPlan& plan, const PlannedSequence& planned) {
  Sequence& sequence = *plan.dataset.sequences[planned.position];
  for (const auto& doubt : add_doubts_of_scans(plan.dataset.kind, sequence, !plan.odometry)) {
    tell(fmt::format("{}: {}", sequence.name(), doubt));
  }
  const Clock::time_point start = Clock::now();
  const double start_cpu_ms = process_cpu_ms();
  take_cost_of_commands();  // of commands before this one
  const RunSettings& settings = plan.settings;
  ComputedSequence computed{planned.folder.begin(), settings.keeps_labels, {}};
  const fs::path& partial = computed.claim->path();
  std::vector<ScanPose> found;
  if (plan.odometry) {
    found = take_poses(plan, planned.position);
    for (const std::string& doubt : doubts_about_mounts(sequence)) {
      tell(fmt::format("{}: {}", sequence.name(), doubt));
      sequence.add_doubt(doubt);
    }
    if (settings.keeps_labels) {
      const std::string rows = format_poses(poses_of(found));
      mark_poses(partial / "poses.txt", rows, mark_of_poses(sequence));
      write_file_atomic(partial / "poses.txt", rows);
    }
  }
  give_back_memory();  // of odometry, and of runs before
  Result ran = run_sequence(sequence, settings,
                            settings.keeps_labels ? std::optional(partial) : std::nullopt);
  Result& result = computed.outcome.result;
  result = completed(plan, planned, std::move(ran), found);
  computed.outcome.folder = planned.folder.path();
  if (result.timing) {
    const double cpu_s = 1e-3 * (process_cpu_ms() - start_cpu_ms);
    result.timing->core_s = cpu_s;
    // A program of the user's is another process, and may wait for a GPU.
    if (plan.job.segment.is_program()) {
      result.timing->core_s = std::chrono::duration<double>(Clock::now() - start).count();
      result.timing->program_cpu_s = cpu_s + take_cost_of_commands().cpu_s;
    }
    result.timing->calibration_ms = calibration_ms();
  }
  return computed;
}

/// A folder that is removed meanwhile is made anew for the next file: what was there is lost.
void check_kept(const fs::path& folder, const Result& result) {
  std::size_t lost = 0;
  for (const ScanRow& row : result.scans) {
    if (!is_there(folder / "labels" / (row.stem + ".label"))) ++lost;
  }
  if (lost == 0) return;
  throw DataError(folder,
                  fmt::format("{} of {} were removed during the run", lost,
                              counted(result.scans.size(), "label file")),
                  "a folder that nobody else changes");
}

SequenceOutcome put(ComputedSequence computed) {
  const fs::path& partial = computed.claim->path();
  if (computed.has_labels) check_kept(partial, computed.outcome.result);
  commit_file(partial / "result.json", format_result(computed.outcome.result));
  if (computed.has_labels) sync_file_system_of(partial);
  computed.claim->put();
  return std::move(computed.outcome);
}

RunExecution::RunExecution(const RunPlan& plan) : plan_(plan), lock_(plan.out) {
  keep_freed_memory();
  for (const std::string& note : plan.notes) tell(note);
  tell(fmt::format("results go to {}", plan.out.string()));
}

void RunExecution::advance() {
  advance_one();
  if (outcomes_.size() < plan_.sequences.size()) return;
  for (const SequenceOutcome& outcome : outcomes_) {
    if (is_there(outcome.folder / "result.json")) continue;
    throw DataError(outcome.folder / "result.json", "was removed during the run",
                    "a folder that nobody else changes");
  }
}

void RunExecution::advance_one() {
  const PlannedSequence& planned = plan_.sequences.at(outcomes_.size());
  if (!planned.finished) {
    outcomes_.push_back(put(compute_sequence(plan_, planned)));
    return;
  }
  planned.folder.remove_leftovers();
  tell(fmt::format("{}: finished by an earlier run, kept{}",
                   title_of(*plan_.dataset.sequences[planned.position], plan_.settings),
                   plan_.job.segment.is_program()
                       ? "; if the program has changed, --overwrite runs it again"
                       : ""));
  outcomes_.push_back({*planned.finished, planned.folder.path(), true});
}

std::vector<SequenceOutcome> execute_run(const RunPlan& plan) {
  RunExecution run(plan);
  while (run.outcomes().size() < plan.sequences.size()) run.advance();
  return run.outcomes();
}

}  // namespace mosbench
