#pragma once

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

}  // namespace mosbench::odometry
