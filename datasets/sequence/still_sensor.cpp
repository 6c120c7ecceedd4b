#include "datasets/sequence/still_sensor.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "datasets/sequence/registration.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

constexpr std::size_t kFewestToTell = 10, kMostLookedAt = 40;
/// Scans that share less show other places.
constexpr double kLeastShared = 0.05;
/// Noise of a registration was 1.3 cm and 0.1 degrees with 16 to 64 beams, 0.36 degrees in a room
/// of 10 m, and 4 cm with an Avia in a hall.
constexpr double kStill_m = 0.05, kStill_deg = 0.5;
/// Standard deviations: sensors in streets and halls had 0.06 m and less, in corridors 0.12 and
/// more.
constexpr double kHeld_m = 0.1, kHeld_deg = 1.0;
constexpr double kDegOfRad = 180.0 / M_PI;

/// The standard deviation along the direction that is known least.
double largest_deviation(const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance);
  return std::sqrt(std::max(0.0, eigen.eigenvalues()[2]));
}

/// The scans to look at: the last one, then others from the second on.
std::vector<std::size_t> looked_at(std::size_t scans) {
  const std::size_t count = std::min(scans, kMostLookedAt);
  std::vector<std::size_t> some = {scans - 1};
  for (std::size_t i = 1; i + 1 < count; ++i) some.push_back(i * (scans - 1) / (count - 1));
  return some;
}

/// The size of cells in which scans that follow one another overlap. Thin scans need large ones, a
/// room small ones.
double fitting_size_m(const Sequence& sequence) {
  constexpr double kSmall_m = 0.7, kLarge_m = 2.0, kClearly = 1.3;
  const Frame first = sequence.read(0), second = sequence.read(1);
  const auto overlap = [&](double size_m) {
    return registered(RegisteredScan(first.points, size_m), RegisteredScan(second.points, size_m),
                      Pose::Identity())
        .overlap;
  };
  return overlap(kLarge_m) > kClearly * overlap(kSmall_m) ? kLarge_m : kSmall_m;
}

}  // namespace

StillSensor find_still_sensor(const Sequence& sequence) {
  if (sequence.size() < kFewestToTell) return {};
  const double size_m = fitting_size_m(sequence);
  const RegisteredScan first(sequence.read(0).points, size_m);
  const std::vector<std::size_t> some = looked_at(sequence.size());
  double most_m = 0.0, most_deg = 0.0;
  StillSensor unsure;
  for (const std::size_t k : some) {
    const RegisteredScan scan(sequence.read(k).points, size_m);
    const Registration found = registered(first, scan, Pose::Identity());
    const double moved_m = found.motion.translation().norm();
    const double moved_deg = kDegOfRad * Eigen::AngleAxisd(found.motion.linear()).angle();
    const double held_m = largest_deviation(found.covariance.topLeftCorner<3, 3>());
    const double held_deg =
        kDegOfRad * largest_deviation(found.covariance.bottomRightCorner<3, 3>());
    if (found.overlap < kLeastShared || moved_m > std::max(kStill_m, 3.0 * held_m)) return {};
    const bool is_near = moved_m <= kStill_m && moved_deg <= kStill_deg;
    const bool is_held = held_m <= kHeld_m && held_deg <= kHeld_deg;
    if (!(is_near && is_held) && unsure.said.empty()) {
      unsure.said = fmt::format(
          "scan matching cannot tell whether the sensor stands still: it has scan {} moved by "
          "{:.0f} cm and {:.1f} degrees, known to {:.0f} cm and {:.1f} degrees ({} if it stands)",
          sequence.stem(k), 100.0 * moved_m, moved_deg, 100.0 * held_m, held_deg,
          option("poses", kStaticPoses));
    }
    most_m = std::max(most_m, moved_m);
    most_deg = std::max(most_deg, moved_deg);
  }
  if (!unsure.said.empty()) return unsure;
  return {true, fmt::format("no poses: scan matching finds the sensor standing still ({:.1f} cm, "
                            "{:.2f} degrees over {} scans), taken as static",
                            100.0 * most_m, most_deg, some.size() + 1)};
}

}  // namespace mosbench
