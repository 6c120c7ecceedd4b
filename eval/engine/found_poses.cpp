#include "eval/engine/found_poses.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "datasets/formats/pose_file.hpp"
#include "datasets/formats/times_file.hpp"
#include "datasets/text/counted.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

template <typename Matrix>
nlohmann::ordered_json rows_json(const Matrix& matrix) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    nlohmann::ordered_json& row = rows.emplace_back(nlohmann::ordered_json::array());
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) row.push_back(matrix(i, j));
  }
  return rows;
}

}  // namespace

void check_stamps_of_tum(const Sequence& sequence) {
  for (std::size_t k = 0; k < sequence.size(); ++k) {
    const auto stamp_ns = sequence.stamp_ns(k);
    if (!stamp_ns) {
      throw UsageError(fmt::format(
          "TUM rows (a file called *.tum, or tum:FILE) have stamps, but the scans of {} have "
          "none, expected kitti:FILE or a file called *.txt",
          sequence.name()));
    }
    if (k == 0 || *stamp_ns > *sequence.stamp_ns(k - 1)) continue;
    throw UsageError(
        fmt::format("TUM rows (a file called *.tum, or tum:FILE) are in the order of their "
                    "stamps, but that of scan {} of {} is not after the one before, expected "
                    "kitti:FILE or a file called *.txt, which have no stamps",
                    sequence.stem(k), sequence.name()));
  }
}

nlohmann::ordered_json scans_json(const Sequence& sequence, const std::vector<ScanPose>& poses) {
  nlohmann::ordered_json scans = nlohmann::ordered_json::array();
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const ScanPose& pose = poses[k];
    scans.push_back({{"stem", sequence.stem(k)},
                     {"map_from_sensor", rows_json(pose.map_from_sensor.matrix().topRows<3>())},
                     {"covariance", rows_json(pose.covariance)},
                     {"geometry", pose.geometry},
                     {"condition", pose.condition},
                     {"overlap", pose.overlap},
                     {"registered_points", pose.registered_points},
                     {"doubt", pose.doubtful() ? nlohmann::ordered_json(pose.doubt) : nullptr}});
  }
  return scans;
}

std::string tum_rows(const std::vector<std::int64_t>& stamps_ns, const std::vector<Pose>& poses) {
  std::string rows;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const Pose& pose = poses[k];
    const Eigen::Quaterniond q = Eigen::Quaterniond(pose.linear()).normalized();
    rows += fmt::format("{} {} {} {} {} {} {} {}\n", seconds_text(stamps_ns.at(k)),
                        pose.translation().x(), pose.translation().y(), pose.translation().z(),
                        q.x(), q.y(), q.z(), q.w());
  }
  return rows;
}

std::string pose_rows(const FoundPoses& found, bool as_tum) {
  std::vector<Pose> poses;
  for (const auto& scan : found.scans) {
    Pose& pose = poses.emplace_back(Pose::Identity());
    for (std::size_t i = 0; i < 12; ++i) {
      pose.matrix()(static_cast<Eigen::Index>(i / 4), static_cast<Eigen::Index>(i % 4)) =
          scan.at("map_from_sensor").at(i / 4).at(i % 4).get<double>();
    }
  }
  if (!as_tum) return format_poses(poses);
  std::vector<std::int64_t> stamps_ns;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    stamps_ns.push_back(found.sequence.stamp_ns(k).value());
  }
  return tum_rows(stamps_ns, poses);
}

std::size_t doubtful_scans(const FoundPoses& found) {
  return static_cast<std::size_t>(std::ranges::count_if(
      found.scans, [](const auto& scan) { return !scan.at("doubt").is_null(); }));
}

std::string found_text(const FoundPoses& found, std::string_view odometry) {
  constexpr std::size_t kListed = 10;
  const std::size_t doubtful = doubtful_scans(found);
  std::string text =
      fmt::format("{}: {} by {} in {}, {} doubtful\n", found.sequence.name(),
                  counted(found.scans.size(), "pose"), odometry, found.file.string(), doubtful);
  std::size_t listed = 0;
  for (const auto& scan : found.scans) {
    if (scan.at("doubt").is_null() || listed == kListed) continue;
    text += fmt::format("  scan {}: {}\n", scan.at("stem").get<std::string>(),
                        scan.at("doubt").get<std::string>());
    ++listed;
  }
  if (doubtful > listed) text += fmt::format("  and {} more\n", doubtful - listed);
  return text;
}

nlohmann::ordered_json found_json(const FoundPoses& found) {
  return {{"sequence", found.sequence.name()},
          {"file", found.file.string()},
          {"doubtful", doubtful_scans(found)},
          {"scans", found.scans}};
}

}  // namespace mosbench
