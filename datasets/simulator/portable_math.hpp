#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <mosbench/scan.hpp>

namespace mosbench {

/// Sine and cosine by additions and multiplications only. Those of libm differ in the last bit
/// between machines and versions, and a simulation has to be the same bits everywhere.
struct SinCos {
  double sin, cos;
};

/// Angle in radians, within +-1e9; absolute error below 1e-15 for small angles.
inline SinCos sin_cos(double angle_rad) {
  // pi/2 in two parts (Cody and Waite): the first has trailing zeros, so quarter * part is exact.
  constexpr double kHalfPiHigh = 1.57079632673412561417e+00;
  constexpr double kHalfPiLow = 6.07710050650619224932e-11;
  const double quarter = std::floor(angle_rad * 0.63661977236758134308 + 0.5);
  const double x = (angle_rad - quarter * kHalfPiHigh) - quarter * kHalfPiLow;
  const double xx = x * x;
  // Taylor series around 0; |x| <= pi/4 makes the next term smaller than one ulp.
  const double sine =
      x * (1 + xx * (-1.0 / 6 +
                     xx * (1.0 / 120 +
                           xx * (-1.0 / 5040 + xx * (1.0 / 362880 +
                                                     xx * (-1.0 / 39916800 +
                                                           xx * (1.0 / 6227020800 +
                                                                 xx * (-1.0 / 1307674368000))))))));
  const double cosine =
      1 + xx * (-0.5 +
                xx * (1.0 / 24 +
                      xx * (-1.0 / 720 + xx * (1.0 / 40320 +
                                               xx * (-1.0 / 3628800 +
                                                     xx * (1.0 / 479001600 +
                                                           xx * (-1.0 / 87178291200 +
                                                                 xx * (1.0 / 20922789888000))))))));
  switch (static_cast<std::int64_t>(quarter) & 3) {
    case 0:
      return {sine, cosine};
    case 1:
      return {cosine, -sine};
    case 2:
      return {-sine, -cosine};
    default:
      return {-cosine, sine};
  }
}

/// Finalizer of SplitMix64 (Steele, Lea, Flood 2014): a bijection that scatters every input bit.
constexpr std::uint64_t scatter_bits(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15u;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}

/// Returns a random word that depends on its arguments only, so that results cannot depend on the
/// order in which scans and rays are computed.
constexpr std::uint64_t random_word(std::uint64_t seed, std::uint64_t counter) {
  return scatter_bits(scatter_bits(seed) ^ counter);
}

/// Returns a number uniform in [0, 1), 53 bits.
constexpr double uniform(std::uint64_t word) { return static_cast<double>(word >> 11) * 0x1p-53; }

/// Returns a number of mean 0 and standard deviation 1: the sum of four uniform 16-bit numbers,
/// hence bounded by kNormalBound.
constexpr double nearly_normal(std::uint64_t word) {
  const std::uint64_t sum =
      (word & 0xFFFF) + ((word >> 16) & 0xFFFF) + ((word >> 32) & 0xFFFF) + (word >> 48);
  constexpr double kScale = 1.73205080756887729353 / 65536.0;
  return (static_cast<double>(sum) - 2.0 * 65535.0) * kScale;
}

inline constexpr double kNormalBound = 3.4642;  // sqrt(12), rounded up

/// Products of poses, element by element: Eigen may add in another order, or fuse, on another
/// machine.
inline Eigen::Vector3d rotated(const Eigen::Matrix3d& r, const Eigen::Vector3d& v) {
  return {r(0, 0) * v.x() + r(0, 1) * v.y() + r(0, 2) * v.z(),
          r(1, 0) * v.x() + r(1, 1) * v.y() + r(1, 2) * v.z(),
          r(2, 0) * v.x() + r(2, 1) * v.y() + r(2, 2) * v.z()};
}

inline Pose compose(const Pose& a, const Pose& b) {
  const Eigen::Matrix3d a_rotation = a.linear();
  Pose product = Pose::Identity();
  for (int column = 0; column < 3; ++column) {
    product.linear().col(column) = rotated(a_rotation, b.linear().col(column));
  }
  product.translation() = a.translation() + rotated(a_rotation, b.translation());
  return product;
}

inline Pose inverse_of(const Pose& pose) {
  Pose inverse = Pose::Identity();
  inverse.linear() = pose.linear().transpose();
  inverse.translation() = -rotated(inverse.linear(), pose.translation());
  return inverse;
}

}  // namespace mosbench
