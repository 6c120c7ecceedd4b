#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <mosbench/scan.hpp>

#include "datasets/text/numbers.hpp"

namespace mosbench {

/// All functions here use operations that IEEE 754 rounds in one way only (+ - * / and square
/// root). Those of libm differ in the last bit between machines and versions, and what is simulated
/// has to be the same bits everywhere.

/// Sine and cosine of an angle.
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

/// Natural logarithm of a positive normal number by the series of the area tangent; relative error
/// below 1e-15.
inline double natural_log(double x) {
  constexpr double kLn2 = 0.693147180559945309417;
  constexpr double kHalfRoot2 = 0.707106781186547524401;
  constexpr int kTerms = 11;
  int exponent = 0;
  double mantissa = std::frexp(x, &exponent);  // exact, in [0.5, 1)
  if (mantissa < kHalfRoot2) {
    mantissa *= 2;
    --exponent;
  }
  const double s = (mantissa - 1) / (mantissa + 1);
  double series = 0;
  for (int n = kTerms; n >= 0; --n) series = 1.0 / (2 * n + 1) + s * s * series;
  return 2 * s * series + exponent * kLn2;
}

/// e^x, 0 where it would be below 1e-304; relative error below 1e-15. x at most 700.
inline double exponential(double x) {
  constexpr double kLn2High = 6.93147180369123816490e-01, kLn2Low = 1.90821492927058770002e-10;
  constexpr int kTerms = 14;
  if (x < -700) return 0;
  const double doublings = std::floor(x * 1.44269504088896340736 + 0.5);
  const double rest = (x - doublings * kLn2High) - doublings * kLn2Low;
  double series = 1;
  for (int n = kTerms; n >= 1; --n) series = 1 + rest / n * series;
  return std::ldexp(series, static_cast<int>(doublings));  // exact
}

/// Angle of (x, y) in (-pi, pi], 0 for the origin; absolute error below 1e-15.
inline double angle_of(double y, double x) {
  constexpr double kPi = 3.14159265358979323846, kTanOfEighth = 0.414213562373095048802;
  constexpr int kTerms = 22;
  const double a = std::abs(x), b = std::abs(y);
  if (a == 0 && b == 0) return 0;
  const double ratio = a > b ? b / a : a / b;  // in [0, 1]
  const bool above = ratio > kTanOfEighth;
  const double t = above ? (ratio - 1) / (ratio + 1) : ratio;
  double series = 0;
  for (int n = kTerms; n >= 0; --n) series = 1.0 / (2 * n + 1) - t * t * series;
  double angle = t * series + (above ? kPi / 4 : 0);
  if (a <= b) angle = kPi / 2 - angle;
  if (x < 0) angle = kPi - angle;
  return y < 0 ? -angle : angle;
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

/// Returns a normal number of mean 0 and standard deviation 1 (Box and Muller 1958) that depends on
/// its arguments only. Uses the words of counters 2 `counter` and 2 `counter` + 1.
inline double normal(std::uint64_t seed, std::uint64_t counter) {
  const double radius = std::sqrt(-2 * natural_log(1 - uniform(random_word(seed, 2 * counter))));
  return radius * sin_cos(6.28318530717958647692 * uniform(random_word(seed, 2 * counter + 1))).cos;
}

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

/// Returns the rotation by |v| radians about v (Rodrigues).
inline Eigen::Matrix3d rotation_of(const Eigen::Vector3d& v) {
  const double angle_sq = v.x() * v.x() + v.y() * v.y() + v.z() * v.z();
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  if (angle_sq == 0) return rotation;
  const double angle_rad = std::sqrt(angle_sq);
  const SinCos turn = sin_cos(angle_rad);
  const double x = v.x() / angle_rad, y = v.y() / angle_rad, z = v.z() / angle_rad;
  const double rest = 1 - turn.cos;
  rotation << turn.cos + x * x * rest, x * y * rest - z * turn.sin, x * z * rest + y * turn.sin,
      y * x * rest + z * turn.sin, turn.cos + y * y * rest, y * z * rest - x * turn.sin,
      z * x * rest - y * turn.sin, z * y * rest + x * turn.sin, turn.cos + z * z * rest;
  return rotation;
}

/// Returns axis times angle in radians of a rotation by less than pi, the inverse of `rotation_of`.
inline Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& r) {
  const double x = r(2, 1) - r(1, 2), y = r(0, 2) - r(2, 0), z = r(1, 0) - r(0, 1);
  const double twice_sine = std::sqrt(x * x + y * y + z * z);
  if (twice_sine == 0) return Eigen::Vector3d::Zero();
  const double angle_rad = angle_of(twice_sine, r(0, 0) + r(1, 1) + r(2, 2) - 1);
  const double scale = angle_rad / twice_sine;
  return {x * scale, y * scale, z * scale};
}

}  // namespace mosbench
