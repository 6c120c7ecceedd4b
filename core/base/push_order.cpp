#include "core/base/push_order.hpp"

#include <stdexcept>

namespace mosbench {

void check_rigid(const Pose& pose) {
  // Wider than what readers accept, so that no pose of a file is refused here.
  constexpr double kTolerance = 2e-3;
  const Eigen::Matrix3d rotation = pose.linear();
  const double departure =
      (rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  // Negated, so that NaN fails as well.
  if (!pose.matrix().allFinite() || !(departure <= kTolerance) || !(rotation.determinant() > 0)) {
    throw std::range_error(
        "pose: is not a rigid motion, expected finite numbers and an orthonormal rotation");
  }
}

}  // namespace mosbench
