#pragma once

#include <Eigen/Core>
#include <functional>

namespace mosbench::odometry {

/// Value and derivative at a step.
struct StepValue {
  double step = 0, value = 0, slope = 0;
};

struct LineSearchOptions {
  double least_value;  ///< a bound that the function never falls below
  double first_step = 1;
};

/// Returns a step that decreases a function enough by the conditions of Wolfe (rho 0.01, sigma
/// 0.9), after Fletcher, Practical Methods of Optimization, 2.6.2 (bracketing) and 2.6.4
/// (sectioning), with the choices of dlib 19.24. `at` evaluates the function at a step; `start` is
/// its value at step 0.
double line_search(const std::function<StepValue(double step)>& at, const StepValue& start,
                   const LineSearchOptions& options);

using Vector6d = Eigen::Matrix<double, 6, 1>;

/// A function of six numbers to be minimised.
class Objective {
 public:
  virtual ~Objective() = default;
  virtual double value(const Vector6d& at) = 0;
  virtual Vector6d gradient(const Vector6d& at) = 0;
  /// Derivative of value(at + step * direction) by `step`.
  virtual double slope(const Vector6d& at, const Vector6d& direction, double step) = 0;
  /// The first step to try along a direction, in (0, 1].
  virtual double first_step(const Vector6d& /*direction*/) const { return 1; }
};

struct Minimum {
  Vector6d at;
  double value = 0;
  int steps = 0;
  bool settled = false;  ///< false: stopped by the limit of steps
};

/// Minimises by the method of Broyden, Fletcher, Goldfarb and Shanno with Fletcher's line search
/// (Practical Methods of Optimization, 2.6.2 and 2.6.4), step for step as dlib 19.24 does, which
/// SiMpLE's authors use. Stops when a step changes the value by less than `tolerance`.
Minimum minimise(Objective& objective, const Vector6d& start, double tolerance);

}  // namespace mosbench::odometry
