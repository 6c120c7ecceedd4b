#pragma once

#include <mosbench/scan.hpp>

namespace mosbench {

/// Throws std::range_error for a pose that is not finite, or whose rotation departs from an
/// orthonormal right-handed one by more than a thousandth.
void check_rigid(const Pose& pose);

}  // namespace mosbench
