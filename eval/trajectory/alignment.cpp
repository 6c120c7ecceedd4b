#include "eval/trajectory/alignment.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <array>

namespace mosbench {
namespace {

constexpr std::array<std::string_view, 4> kAlignmentNames = {"none", "origin", "rigid",
                                                             "similarity"};
// Singular values below this share of the largest are none.
constexpr double kOnALine = 1e-12;

using Positions = Eigen::Matrix<double, 3, Eigen::Dynamic>;

Positions positions_of(std::span<const Pose> poses) {
  Positions positions(3, static_cast<Eigen::Index>(poses.size()));
  for (std::size_t i = 0; i < poses.size(); ++i) {
    positions.col(static_cast<Eigen::Index>(i)) = poses[i].translation();
  }
  return positions;
}

bool has_single_answer(const Positions& from, const Positions& to) {
  const Positions from_mean = from.colwise() - from.rowwise().mean();
  const Positions to_mean = to.colwise() - to.rowwise().mean();
  const Eigen::Vector3d singular =
      Eigen::JacobiSVD<Eigen::Matrix3d>(to_mean * from_mean.transpose()).singularValues();
  return singular[1] > kOnALine * singular[0];
}

}  // namespace

std::string_view to_string(PathAlignment alignment) {
  return kAlignmentNames[static_cast<std::size_t>(alignment)];
}

std::optional<PathAlignment> path_alignment_from_string(std::string_view name) {
  const auto found = std::ranges::find(kAlignmentNames, name);
  if (found == kAlignmentNames.end()) return std::nullopt;
  return static_cast<PathAlignment>(found - kAlignmentNames.begin());
}

std::optional<AlignedPath> aligned(std::span<const Pose> estimate, std::span<const Pose> truth,
                                   PathAlignment alignment) {
  AlignedPath result{.poses = {estimate.begin(), estimate.end()}};
  if (alignment == PathAlignment::kNone) return result;
  if (alignment == PathAlignment::kOrigin) {
    const Pose move = truth.front() * estimate.front().inverse();
    for (Pose& pose : result.poses) pose = move * pose;
    return result;
  }
  const Positions from = positions_of(estimate), to = positions_of(truth);
  if (estimate.size() < 3 || !has_single_answer(from, to)) return std::nullopt;
  const Eigen::Matrix4d move = Eigen::umeyama(from, to, alignment == PathAlignment::kSimilarity);
  result.scale = std::cbrt(move.topLeftCorner<3, 3>().determinant());
  const Eigen::Matrix3d rotation = move.topLeftCorner<3, 3>() / result.scale;
  for (Pose& pose : result.poses) {
    pose.translation() =
        result.scale * (rotation * pose.translation()) + move.topRightCorner<3, 1>();
    pose.linear() = rotation * pose.linear();
  }
  return result;
}

}  // namespace mosbench
