#include "eval/trajectory/frame_check.hpp"

#include <fmt/format.h>

#include "eval/trajectory/pose_errors.hpp"

namespace mosbench {
namespace {

// Axes that are mistaken for others make errors as large as the motion.
constexpr double kFarBetter = 3.0;
constexpr double kLeastError_m = 0.01;

Pose kitti_camera_from_lidar() {
  Pose pose = Pose::Identity();
  pose.linear() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  return pose;
}

double mean_motion_error_m(const TrajectoryPair& pair, const std::vector<Pose>& estimate) {
  const auto summary = summary_of(relative_errors(pair.truth, estimate, {}).translation_m);
  return summary ? summary->mean : 0;
}

std::vector<Pose> turned(const std::vector<Pose>& poses, const Pose& other_from_own) {
  std::vector<Pose> result;
  for (const Pose& pose : poses) {
    result.push_back(other_from_own * pose * other_from_own.inverse());
  }
  return result;
}

}  // namespace

std::optional<std::string> frame_remark(const TrajectoryPair& pair,
                                        const TrajectoryOptions& options) {
  const double as_given_m = mean_motion_error_m(pair, pair.estimate);
  if (!(as_given_m > kLeastError_m)) return std::nullopt;
  const Pose camera_from_lidar = options.camera_from_lidar.value_or(kitti_camera_from_lidar());
  const bool given = options.camera != CameraFrame::kNeither;
  const auto better = [&](const Pose& turn, const char* what) -> std::optional<std::string> {
    const double error_m = mean_motion_error_m(pair, turned(pair.estimate, turn));
    if (!(kFarBetter * error_m < as_given_m)) return std::nullopt;
    return fmt::format("motions from pose to pose are {:.3f} m off, and {:.3f} m {}", as_given_m,
                       error_m, what);
  };
  const char* undo = "without --camera";
  if (auto remark = better(camera_from_lidar,
                           given ? undo : "if the truth is the camera's: --camera truth:CALIB")) {
    return remark;
  }
  return better(camera_from_lidar.inverse(),
                given ? undo : "if the estimate is the camera's: --camera estimate:CALIB");
}

}  // namespace mosbench
