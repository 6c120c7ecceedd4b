#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "datasets/doctor/pose_evidence.hpp"
#include "datasets/doctor/pose_scatter.hpp"

namespace mosbench {

// Each returns plain sentences about one kind of fault, or nothing.

struct FrozenRows {
  std::string finding;
  std::size_t longest = 0;  ///< rows of the longest run of equal ones
  std::size_t at_end = 0;   ///< rows of the only run, if it is at the end; else 0
};
/// Equal rows while the scans show that the sensor moves.
std::optional<FrozenRows> frozen_rows(const PoseEvidence& evidence);
/// Equal rotations while the scans show that the sensor turns.
std::optional<std::string> missing_rotation(const PoseEvidence& evidence);
/// No motion in height although the poses roll and pitch. Straight roads have no y, so that other
/// axes say nothing.
std::optional<std::string> deleted_axis(const PoseEvidence& evidence);
struct LostScan {
  std::string finding;
  std::size_t rows = 0;
};
/// A scan from which on the poses are shifted by other rows than before, which explains the
/// measured motions better than anything else, of `best_gain`.
std::optional<LostScan> lost_scan(const PoseEvidence& evidence, double best_gain);
/// Single steps over which poses and scans move differently.
std::vector<std::string> jumps(const PoseEvidence& evidence);
/// Poses that move faster than any vehicle.
std::string too_fast(double speed_m_s);
/// Poses that do not fit for a reason that is not known: noise, or another sequence.
std::string unexplained(const PoseEvidence& evidence, const PoseScatter& scatter);
/// What is odd about the rows and may well be right.
std::vector<std::string> remarks_on_rows(const PoseEvidence& evidence);

// What the thresholds of the findings are compared with, by name.

std::map<std::string, double> row_measures(const PoseEvidence& evidence);
std::map<std::string, double> jump_measures(const PoseEvidence& evidence);

}  // namespace mosbench
