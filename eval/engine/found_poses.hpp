#pragma once

#include <cstdint>
#include <filesystem>
#include <mosbench/odometry.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// The poses of one sequence, with all that is known of them as --json prints it.
struct FoundPoses {
  const Sequence& sequence;
  std::filesystem::path file;
  nlohmann::ordered_json scans;
};

/// What is known of every scan's pose, as `FoundPoses::scans`.
nlohmann::ordered_json scans_json(const Sequence& sequence, const std::vector<ScanPose>& poses);

/// Throws UsageError unless every scan has a stamp, and a later one than the scan before: rows of
/// TUM are found by their stamps.
void check_stamps_of_tum(const Sequence& sequence);

/// The rows of a TUM file of poses with these stamps, one for each.
std::string tum_rows(const std::vector<std::int64_t>& stamps_ns, const std::vector<Pose>& poses);

/// The rows of a file of poses, of KITTI or, for scans with stamps, of TUM. Throws a JSON exception
/// for scans that `scans_json` did not write.
std::string pose_rows(const FoundPoses& found, bool as_tum);

std::size_t doubtful_scans(const FoundPoses& found);

/// How many poses there are and why the first of the doubtful ones are doubtful.
std::string found_text(const FoundPoses& found, std::string_view odometry);
nlohmann::ordered_json found_json(const FoundPoses& found);

}  // namespace mosbench
