#include "eval/engine/run_execute.hpp"

#include <fmt/format.h>

#include <system_error>

#include "datasets/disk/files.hpp"
#include "datasets/doctor/doctor.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/sequence/pose_frame_mark.hpp"
#include "datasets/text/counted.hpp"
#include "eval/exec/exec_method.hpp"
#include "eval/protocols/benchmark_split.hpp"
#include "eval/protocols/metrics.hpp"
#include "eval/protocols/summary_json.hpp"
#include "eval/results/machine.hpp"
#include "eval/results/reading_json.hpp"
#include "eval/results/result_format.hpp"
#include "eval/results/simulated.hpp"
#include "eval/results/tell.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

using nlohmann::ordered_json;

std::vector<std::string> scans_without_detection(const SequenceRows& rows) {
  std::vector<std::string> stems;
  for (const ScanRow& row : rows.scans) {
    if (!row.judged) stems.push_back(row.stem);
  }
  return stems;
}

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

std::vector<std::string> all_remarks(const RunSettings& settings, const Sequence& sequence,
                                     const SequenceRows& rows) {
  std::vector<std::string> remarks = sequence.remarks();
  if (const std::size_t unjudged = scans_without_detection(rows).size(); unjudged > 0) {
    remarks.push_back(fmt::format(
        "{} of {} labelled static without detection, because the method has seen too few "
        "scans before or after them: {}",
        unjudged, counted(sequence.size(), "scan is", "scans are"), unjudged_text(rows.scans)));
  }
  remarks.insert(remarks.end(), rows.remarks.begin(), rows.remarks.end());
  std::size_t nonfinite_points = 0;
  std::uint64_t unknown_ids = 0;
  for (const ScanRow& row : rows.scans) {
    nonfinite_points += row.nonfinite_points;
    if (row.counts) unknown_ids += row.counts->unknown_ids;
  }
  if (nonfinite_points > 0) {
    remarks.push_back(fmt::format("{} NaN or infinite: left out of the map and labelled static",
                                  counted(nonfinite_points, "point is", "points are")));
  }
  if (unknown_ids > 0) {
    remarks.push_back(
        fmt::format("{} a label id that protocol {} does not know: counted as it says",
                    counted(unknown_ids, "point has", "points have"), settings.protocol->name));
  }
  return remarks;
}

ordered_json doubtful_poses(const Sequence& sequence, const std::vector<ScanPose>& poses) {
  ordered_json json = ordered_json::array();
  for (std::size_t k = 0; k < poses.size(); ++k) {
    if (!poses[k].doubtful()) continue;
    json.push_back({{"stem", sequence.stem(k)}, {"doubt", poses[k].doubt}});
  }
  return json;
}

/// `found`: the poses by odometry, if the run asked for them.
ordered_json header(const RunPlan& plan, const PlannedSequence& planned, const SequenceRows& rows,
                    const std::vector<std::string>& remarks, const std::vector<ScanPose>& found) {
  ordered_json json = {{"format", kResultFormat}};
  json.update(planned.identity);
  json["preset"] = plan.preset;
  const Sequence& sequence = *plan.dataset.sequences[planned.position];
  if (const auto origin = simulated_origin_json(plan.dataset, sequence)) {
    json["simulated"] = *origin;
  }
  json["fingerprint"] = rows.fingerprint;
  json["fingerprint_without_poses"] = rows.fingerprint_without_poses;
  json["machine"] = machine_json();
  json["remarks"] = remarks;
  json["scans_without_detection"] = scans_without_detection(rows);
  if (plan.odometry) json["doubtful_poses"] = doubtful_poses(sequence, found);
  const Recording& recording = sequence.recording();
  for (const ScanEntry& scan : recording.left_out) json["scans_left_out"].push_back(scan.stem);
  const Split* benchmark = benchmark_scans(*plan.settings.protocol, plan.dataset.splits);
  std::vector<Confusion> counts;
  for (const ScanRow* row : counted_scans(plan, planned.position, rows)) {
    counts.push_back(*row->counts);
  }
  if (const ordered_json splits = picked_stems(plan.dataset, planned.position); !splits.empty()) {
    json["splits"] = splits;
  }
  json["summary_split"] =
      benchmark == nullptr ? ordered_json(nullptr) : ordered_json(benchmark->name);
  json["summary"] =
      counts.empty() ? ordered_json(nullptr) : to_json(summarize(*plan.settings.protocol, counts));
  return json;
}

/// Where and how `report` and `render` find the points again; folders are this machine's. Of the
/// run all sequences, by which an interrupted one is known.
ordered_json clock_header(const RunPlan& plan, const PlannedSequence& planned) {
  ordered_json json = {{"file_stamp", planned.stamp},
                       {"dataset_root", fs::absolute(plan.dataset.root).string()},
                       {"sequences_of_run", ordered_json::array()}};
  for (const PlannedSequence& each : plan.sequences) {
    json["sequences_of_run"].push_back(plan.dataset.sequences[each.position]->name());
  }
  json.update(told_json(plan.reading));
  return json;
}

void keep_poses(const std::vector<Pose>& poses, const fs::path& file) {
  const std::string rows = format_poses(poses);
  mark_as_lidars(file, rows);
  write_file_atomic(file, rows);
}

/// What the scans say about the frame of poses of a file, where nobody said it.
std::vector<std::string> doubts_about_poses(const RunPlan& plan, const Sequence& sequence) {
  if (!plan.reading.poses || plan.reading.pose_frame != PoseFrame::kByCalib) return {};
  const std::optional<std::string> doubt = doubt_about_pose_frame(sequence);
  if (!doubt) return {};
  tell(fmt::format("{}: {}", sequence.name(), *doubt));
  return {*doubt};
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

SequenceOutcome run_now(const RunPlan& plan, const PlannedSequence& planned) {
  const Sequence& sequence = *plan.dataset.sequences[planned.position];
  const fs::path partial = planned.folder.begin();
  try {
    SequenceOutcome outcome;
    std::vector<ScanPose> found;
    if (plan.odometry) {
      found = take_poses(plan, planned.position);
      keep_poses(poses_of(found), partial / "poses.txt");
    }
    const std::vector<std::string> doubts = doubts_about_poses(plan, sequence);
    give_back_memory();  // of odometry, and of runs before
    outcome.rows = run_sequence(sequence, plan.settings, partial);
    outcome.remarks = all_remarks(plan.settings, sequence, outcome.rows);
    outcome.remarks.insert(outcome.remarks.begin(), doubts.begin(), doubts.end());
    outcome.folder = planned.folder.path();
    write_file_atomic(
        partial / "result.json",
        format_result(header(plan, planned, outcome.rows, outcome.remarks, found), outcome.rows,
                      plan.settings.threads, clock_header(plan, planned)));
    planned.folder.publish();
    return outcome;
  } catch (...) {
    // Unless the program is killed, a failed run leaves nothing behind; a full disk gets room back.
    std::error_code ignored;
    fs::remove_all(partial, ignored);
    throw;
  }
}

SequenceOutcome reuse(const RunPlan& plan, const PlannedSequence& planned) {
  const Sequence& sequence = *plan.dataset.sequences[planned.position];
  planned.folder.remove_leftovers();
  const bool is_program = plan.settings.method->name == kExecKind;
  tell(fmt::format("{}: finished by an earlier run, kept{}", title_of(sequence, plan.settings),
                   is_program ? "; if the program has changed, --overwrite runs it again" : ""));
  return {planned.finished->rows,
          planned.finished->content.at("remarks").get<std::vector<std::string>>(),
          planned.folder.path(), true};
}

}  // namespace

std::vector<const ScanRow*> counted_scans(const RunPlan& plan, std::size_t position,
                                          const SequenceRows& rows) {
  const Split* benchmark = benchmark_scans(*plan.settings.protocol, plan.dataset.splits);
  const auto stems = benchmark == nullptr ? std::nullopt : stems_in_split(*benchmark, position);
  std::vector<const ScanRow*> counted;
  for (const ScanRow& row : rows.scans) {
    if (row.counts && (!stems || stems->contains(row.stem))) counted.push_back(&row);
  }
  return counted;
}

RunExecution::RunExecution(const RunPlan& plan) : plan_(plan), lock_(plan.out) {
  keep_freed_memory();
  for (const std::string& note : plan.notes) tell(note);
  tell(fmt::format("results go to {}", plan.out.string()));
}

void RunExecution::advance() {
  const PlannedSequence& planned = plan_.sequences.at(outcomes_.size());
  outcomes_.push_back(planned.finished ? reuse(plan_, planned) : run_now(plan_, planned));
}

std::vector<SequenceOutcome> execute_run(const RunPlan& plan) {
  RunExecution run(plan);
  while (run.outcomes().size() < plan.sequences.size()) run.advance();
  return run.outcomes();
}

}  // namespace mosbench
