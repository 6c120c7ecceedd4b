#include <fmt/format.h>

#include <algorithm>

#include "datasets/doctor/doctor.hpp"
#include "datasets/doctor/pose_fit.hpp"
#include "datasets/sequence/pose_track.hpp"
#include "datasets/sequence/still_sensor.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

/// A sweep may be as long as the step; stamps of sensors jitter by some percent.
constexpr double kLongestSweep_steps = 1.5;

/// The time to the next scan; 0 where it is not known.
std::int64_t step_ns(const Sequence& sequence, std::size_t scan_index) {
  if (scan_index + 1 >= sequence.size()) return 0;
  const auto stamp = sequence.stamp_ns(scan_index), next = sequence.stamp_ns(scan_index + 1);
  return stamp && next ? *next - *stamp : 0;
}

/// Scans that cannot be read show nothing.
bool is_seen_standing(const Sequence& sequence) {
  try {
    return find_still_sensor(sequence).stands;
  } catch (const DataError&) {
    return false;
  }
}

}  // namespace

std::vector<std::string> doubts_of(const Sequence& sequence) {
  std::vector<std::string> doubts = sequence.recording().doubts;
  if (std::string disturbed = disturbed_doubt(mark_as_read(sequence)); !disturbed.empty()) {
    doubts.insert(doubts.begin(), std::move(disturbed));
  }
  Facts facts;
  examine_stamps(sequence, facts);
  const std::vector<ScanEntry>& scans = sequence.recording().scans;
  const auto is_first = [&](const ScanEntry& scan) {
    return scan.map_from_sensor.matrix() == scans.front().map_from_sensor.matrix();
  };
  const bool is_still = std::ranges::all_of(scans, is_first);
  const std::string& source = sequence.reading().poses.source;
  const bool has_poses = !source.empty() && source != kStaticPoses && source != kNoPoses;
  if (is_still && has_poses && !is_seen_standing(sequence)) facts["equal_poses"] = scans.size();
  for (const Subject subject : {Subject::kStamps, Subject::kStill}) {
    for (Symptom& symptom : judged(checks(), subject, facts, sequence.name())) {
      doubts.push_back(std::move(symptom.what));
    }
  }
  return doubts;
}

std::vector<std::string> add_doubts_of_scans(DatasetKind kind, Sequence& sequence,
                                             bool has_given_poses) {
  constexpr std::size_t kScansRead = 8;
  if (sequence.reading().perturb) return {};
  std::vector<std::string> found;
  const auto add = [&](std::string doubt) { found.push_back(std::move(doubt)); };
  SequenceCheckup seen;
  examine_content(sequence, layout_of(kind).files, kScansRead, seen);
  for (const Subject subject : {Subject::kPoints, Subject::kLabelIds}) {
    for (Symptom& symptom : judged(checks(), subject, seen.facts, sequence.name())) {
      add(std::move(symptom.what));
    }
  }
  if (found.empty() && has_given_poses) {
    auto doubt = doubt_about_pose_frame(sequence);
    if (!doubt) doubt = doubt_about_pose_fit(sequence);
    if (doubt) add(std::move(*doubt));
  }
  const std::vector<std::string>& known = sequence.recording().doubts;
  std::erase_if(found,
                [&](const auto& doubt) { return std::ranges::find(known, doubt) != known.end(); });
  for (const std::string& doubt : found) sequence.add_doubt(doubt);
  return found;
}

void SweepWatch::add(std::size_t scan_index, const Frame& frame) {
  const std::int64_t step = step_ns(sequence_, scan_index);
  if (step <= 0 || frame.point_times_ns.empty()) return;
  const auto [first, last] = std::ranges::minmax(frame.point_times_ns);
  if (static_cast<double>(last - first) <= kLongestSweep_steps * static_cast<double>(step)) return;
  if (long_sweeps_++ > 0) return;
  first_ = scan_index;
  first_sweep_ns_ = last - first;
}

std::optional<std::string> SweepWatch::doubt() const {
  if (long_sweeps_ == 0) return std::nullopt;
  return fmt::format(
      "{} measured over longer than the time to the next scan, first scan {}: {:g} s, the next "
      "follows after {:g} s",
      counted(long_sweeps_, "scan was", "scans were"), sequence_.stem(first_),
      seconds_of(first_sweep_ns_), seconds_of(step_ns(sequence_, first_)));
}

}  // namespace mosbench
