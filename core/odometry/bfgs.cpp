#include "core/odometry/bfgs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/odometry/line_search.hpp"

namespace mosbench::odometry {
namespace {

constexpr double kLeastValue = -1e7;  // below every cost: there are fewer points
constexpr int kMaxSteps = 1000;

/// Sum of products in the order of the elements, unlike Eigen's.
double dot(const Vector6d& a, const Vector6d& b) {
  double sum = 0;
  for (Eigen::Index i = 0; i < 6; ++i) sum += a[i] * b[i];
  return sum;
}

/// The inverse of the Hessian, learnt from steps.
class InverseHessian {
 public:
  Vector6d direction(const Vector6d& at, const Vector6d& gradient) {
    if (used_) update(at - last_at_, gradient - last_gradient_);
    used_ = true;
    last_at_ = at;
    last_gradient_ = gradient;
    return -inverse_ * gradient;
  }

 private:
  /// Fletcher's (3.2.12).
  void update(const Vector6d& step, const Vector6d& change) {
    const double curvature = dot(step, change);
    if (!scaled_) scale(curvature, dot(change, change));
    const Vector6d h_change = inverse_ * change;
    const Vector6d change_h = inverse_.transpose() * change;
    const double change_h_change = dot(change_h, change);
    if (!(change_h_change < kInfinity && curvature < kInfinity && curvature != 0)) {
      inverse_.setIdentity();
      scaled_ = false;
      return;
    }
    const Matrix6d both = step * step.transpose();
    const Matrix6d mixed = step * change_h.transpose() + h_change * step.transpose();
    inverse_ += both * ((1 + change_h_change / curvature) / curvature) - mixed * (1 / curvature);
  }

  /// Nocedal and Wright's first guess.
  void scale(double curvature, double change_sq) {
    if (change_sq <= std::numeric_limits<double>::epsilon()) return;
    inverse_ = Matrix6d::Identity() * std::clamp(curvature / change_sq, 0.01, 100.0);
    scaled_ = true;
  }

  using Matrix6d = Eigen::Matrix<double, 6, 6>;
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Matrix6d inverse_ = Matrix6d::Identity();
  Vector6d last_at_, last_gradient_;
  bool used_ = false, scaled_ = false;
};

}  // namespace

Minimum minimise(Objective& objective, const Vector6d& start, double tolerance) {
  Minimum minimum{.at = start, .value = objective.value(start)};
  InverseHessian hessian;
  double last_value = std::numeric_limits<double>::infinity();
  for (; minimum.steps < kMaxSteps; ++minimum.steps) {
    if (std::abs(minimum.value - last_value) < tolerance) {
      minimum.settled = true;
      return minimum;
    }
    last_value = minimum.value;
    const Vector6d gradient = objective.gradient(minimum.at);
    const Vector6d direction = hessian.direction(minimum.at, gradient);
    const StepValue here{0, minimum.value, dot(gradient, direction)};
    const auto trial = [&](double step) {
      minimum.value = objective.value(minimum.at + step * direction);
      return StepValue{step, minimum.value, objective.slope(minimum.at, direction, step)};
    };
    minimum.at +=
        line_search(trial, here, {kLeastValue, objective.first_step(direction)}) * direction;
  }
  return minimum;
}

}  // namespace mosbench::odometry
