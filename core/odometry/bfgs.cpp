#include "core/odometry/bfgs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mosbench::odometry {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kEnoughDecrease = 0.01;                 // rho
constexpr double kEnoughFlattening = 0.9;                // sigma
constexpr double kLeastGrowth = 1.4, kMostGrowth = 9.0;  // tau 1 of the book, split in two
constexpr double kNearFirst = 0.1, kNearLast = 0.5;      // tau 2 and tau 3
constexpr int kMaxTrials = 100;

double within(double a, double b, double x) {
  return a < b ? std::clamp(x, a, b) : std::clamp(x, b, a);
}

/// Minimiser in [0, limit] of the cubic with these values and derivatives at 0 and 1.
double cubic_minimiser(const StepValue& from, const StepValue& to, double limit) {
  const double n = 3 * (to.value - from.value) - 2 * from.slope - to.slope;
  const double e = from.slope + to.slope - 2 * (to.value - from.value);
  if (std::abs(e) <= kEpsilon) return 0.5;
  const double root = std::sqrt(std::max(n * n - 3 * e * from.slope, 0.0));
  const auto cubic = [&](double x) {
    return from.value + from.slope * x + n * x * x + e * x * x * x;
  };
  const double x1 = (root - n) / (3 * e);
  const double x2 = -(root + n) / (3 * e);
  return within(0, limit, cubic(x1) < cubic(x2) ? x1 : x2);
}

class Search {
 public:
  Search(const std::function<StepValue(double)>& at, const StepValue& start,
         const LineSearchOptions& options)
      : at_(at),
        start_(start),
        first_(options.first_step),
        most_((options.least_value - start.value) / (kEnoughDecrease * start.slope)) {}

  double run() {
    if (std::abs(start_.slope) <= std::abs(start_.value) * kEpsilon) return 0;
    StepValue last = start_;
    double step = within(0, 0.65 * most_, most_ < 0 ? -first_ : first_);
    while (true) {
      const StepValue trial = try_step(step);
      if (too_high(trial) || trial.value >= last.value) return section(last, trial);
      if (flat(trial) || last.step == step || trials_ >= kMaxTrials) return step;
      if (trial.slope >= 0) return section(trial, last);
      step = extrapolate(last, trial);
      last = trial;
    }
  }

 private:
  StepValue try_step(double step) {
    ++trials_;
    return at_(step);
  }
  bool too_high(const StepValue& trial) const {
    return trial.value > start_.value + kEnoughDecrease * trial.step * start_.slope;
  }
  bool flat(const StepValue& trial) const {
    return std::abs(trial.slope) <= std::abs(kEnoughFlattening * start_.slope);
  }

  double extrapolate(const StepValue& last, const StepValue& trial) const {
    const double length = trial.step - last.step;
    const auto at_most = [&](double step) {
      return most_ > 0 ? std::min(most_, step) : std::max(most_, step);
    };
    const double first = at_most(trial.step + kLeastGrowth * length);
    const double farthest = at_most(trial.step + kMostGrowth * length);
    const double step = last.step < trial.step
                            ? last.step + length * cubic_minimiser(last, trial, 1e10)
                            : trial.step - length * cubic_minimiser(trial, last, 1e10);
    return within(first, farthest, step);
  }

  double section(StepValue a, StepValue b) {
    while (true) {
      const double length = b.step - a.step;
      const double first = a.step + kNearFirst * length;
      const double last = b.step - kNearLast * length;
      // The derivatives are not scaled to the bracket; dlib does not either.
      const double step = within(first, last, a.step + length * cubic_minimiser(a, b, 1.0));
      const StepValue trial = try_step(step);
      if (trials_ >= kMaxTrials) return step;
      if (a.step == first || b.step == last) return b.step;
      const double longest = std::max(std::abs(a.step), std::abs(b.step));
      if (std::abs(longest * start_.slope) <= std::abs(start_.value) * kEpsilon) return step;
      if (too_high(trial) || trial.value >= a.value) {
        b = trial;
        continue;
      }
      if (flat(trial)) return step;
      if (length * trial.slope >= 0) b = a;
      a = trial;
    }
  }

  const std::function<StepValue(double)>& at_;
  const StepValue start_;
  const double first_;
  const double most_;  // no step beyond this can be needed
  int trials_ = 0;
};

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

double line_search(const std::function<StepValue(double)>& at, const StepValue& start,
                   const LineSearchOptions& options) {
  return Search(at, start, options).run();
}

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
