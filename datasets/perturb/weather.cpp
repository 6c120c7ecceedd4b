#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "datasets/formats/point_range.hpp"
#include "datasets/perturb/perturbation.hpp"

namespace mosbench {
namespace {

constexpr double kPi = 3.14159265358979323846;

double squared(double x) { return x * x; }

/// The light that a target sends back, in units of what it returns from 1 m in clear air.
double target_power(double range_m, double extinction_per_m) {
  return exponential(-2 * extinction_per_m * range_m) / squared(range_m);
}

/// Returns the strength of a return that is just seen: that of a target at the sensor's range in
/// clear air.
double least_power(const Perturbation& shared) { return 1 / squared(shared.sensor_range_m); }

/// The droplets that scatter light before a target.
struct Scatterer {
  double range_m, power;  ///< in units of `target_power`
};

/// Replaces each target by the scatterer if that returns more light, and loses targets that are too
/// weak. `scatterer` gives the strongest one before a target at some range.
template <typename StrongestBefore>
void weaken(Frame& frame, double extinction_per_m, double least,
            StrongestBefore&& strongest_before) {
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    Point& point = frame.points[i];
    if (!is_return(point)) continue;
    const double target_m = range_m(point);
    const double power = target_power(target_m, extinction_per_m);
    const std::optional<Scatterer> before = strongest_before(i, target_m, std::max(power, least));
    const bool hidden = before && before->power > power;
    if (std::max(power, hidden ? before->power : 0) < least) {
      lose_point(frame, i);
    } else if (hidden) {
      set_range(point, target_m, before->range_m);
      if (frame.truth) (*frame.truth)[i] = 0;
      if (!frame.radial_velocity_m_s.empty()) {
        frame.radial_velocity_m_s[i] = std::numeric_limits<float>::quiet_NaN();
      }
    }
  }
}

/// Drops by Marshall and Palmer: N(D) = N0 exp(-slope D), D in mm. Kilic et al. sample them in the
/// whole cone of each beam. Here the cone ends where the largest drop, which would break up,
/// returns less than the target.
struct Rain {
  static constexpr double kN0 = 8000;  // per m^3 and mm
  static constexpr double kSmallest_mm = 0.05, kLargest_mm = 6;
  static constexpr double kNearest_m = 1.5;        // LISA's blind range
  static constexpr double kHalfBeam_rad = 0.0015;  // LISA's divergence of 3 mrad
  // Reflectance of water ((n - 1) / (n + 1))^2, n = 1.328, against a weak target's 0.1.
  static constexpr double kReflectance = 0.0198520 / 0.1;

  double slope_per_mm, drops_per_m3, extinction_per_m;

  explicit Rain(double mm_per_h)
      : slope_per_mm(4.1 * exponential(-0.21 * natural_log(mm_per_h))),
        drops_per_m3(kN0 / slope_per_mm * exponential(-slope_per_mm * kSmallest_mm)),
        // Drops far larger than the wavelength take twice their cross section out of the beam.
        extinction_per_m(kPi * kN0 / (squared(slope_per_mm) * slope_per_mm) * 1e-6) {}

  double power(double range_m, double diameter_mm) const {
    const double beam_mm = 2000 * kHalfBeam_rad * range_m;
    return kReflectance * target_power(range_m, extinction_per_m) *
           std::min(squared(diameter_mm / beam_mm), 1.0);
  }

  /// Returns the range beyond which no drop returns `target` or more.
  double farthest_m(double target) const {
    const double beam_mm_at_1m = 2000 * kHalfBeam_rad;
    const double fourth = kReflectance * squared(kLargest_mm / beam_mm_at_1m) / target;
    return std::sqrt(std::sqrt(fourth));
  }

  std::optional<Scatterer> strongest_before(const Draws& draws, double target_m,
                                            double target) const {
    const double end_m = std::min(target_m, farthest_m(target));
    if (end_m <= kNearest_m) return std::nullopt;
    const double cone_m3 = kPi / 3 * squared(kHalfBeam_rad) * squared(end_m) * end_m;
    const auto drops = static_cast<std::uint64_t>(drops_per_m3 * cone_m3 + draws.uniform(0));
    std::optional<Scatterer> strongest;
    for (std::uint64_t drop = 0; drop < drops; ++drop) {
      const auto draw = [&](std::uint64_t n) { return draws.uniform(1 + 4 * drop + n); };
      // The largest of three uniform numbers is as far as a point is in a cone.
      const double range_m = end_m * std::max({draw(0), draw(1), draw(2)});
      const double diameter_mm = kSmallest_mm - natural_log(1 - draw(3)) / slope_per_mm;
      if (range_m < kNearest_m || diameter_mm > kLargest_mm) continue;
      const double drop_power = power(range_m, diameter_mm);
      if (!strongest || drop_power > strongest->power) strongest = {range_m, drop_power};
    }
    return strongest;
  }
};

/// Response of fog alone to a pulse, Hahner et al. (2021), equation of the soft target, over range.
class FogResponse {
 public:
  explicit FogResponse(double extinction_per_m) {
    constexpr double kBackscatterOfMor = 0.046, kLn20 = 2.99573227355399099343;
    constexpr double kBeta0 = 1e-6 / kPi;
    const double beta = kBackscatterOfMor * extinction_per_m / kLn20;
    double sum = 0;
    for (std::size_t step = 0; step < kSteps; ++step) {
      powers_[step] = beta / kBeta0 * pulse_response(range_of(step), extinction_per_m);
      sum += powers_[step];
      sums_[step] = sum;
      peaks_[step] = std::max(step == 0 ? 0 : peaks_[step - 1], powers_[step]);
    }
  }

  /// The peak before a target. Its place is drawn in proportion to the response, because peaks
  /// alone would put all fog on one sphere.
  std::optional<Scatterer> strongest_before(const Draws& draws, double target_m) const {
    const std::size_t end = static_cast<std::size_t>(
        std::clamp((target_m - kFirst_m) / kStep_m, 0.0, static_cast<double>(kSteps)));
    if (end == 0) return std::nullopt;
    const double wanted = draws.uniform(0) * sums_[end - 1];
    const auto step = static_cast<std::size_t>(
        std::lower_bound(sums_.begin(), sums_.begin() + static_cast<std::ptrdiff_t>(end - 1),
                         wanted) -
        sums_.begin());
    return Scatterer{range_of(step), peaks_[end - 1]};
  }

 private:
  static constexpr double kFirst_m = 1, kStep_m = 0.1;
  static constexpr std::size_t kSteps = 300;  // beyond 31 m fog returns next to nothing

  static double range_of(std::size_t step) {
    return kFirst_m + kStep_m * static_cast<double>(step);
  }

  /// Integral over the pulse of 20 ns (half power), sin^2 in shape.
  static double pulse_response(double range_m, double extinction_per_m) {
    constexpr double kHalfPower_s = 20e-9, kLight_m_s = 299792458;
    constexpr int kParts = 200;
    constexpr double kPart_s = 2 * kHalfPower_s / kParts;
    double sum = 0;
    for (int part = 0; part < kParts; ++part) {
      const double time_s = (part + 0.5) * kPart_s;
      const double at_m = range_m - kLight_m_s * time_s / 2;
      // Transmitter and receiver begin to see the same at 0.9 m, and do from 1 m on.
      const double overlap = std::clamp((at_m - 0.9) / 0.1, 0.0, 1.0);
      if (overlap == 0) continue;
      sum += squared(sin_cos(kPi / (2 * kHalfPower_s) * time_s).sin) * overlap *
             target_power(at_m, extinction_per_m);
    }
    return sum * kPart_s;
  }

  std::array<double, kSteps> powers_, sums_, peaks_;
};

}  // namespace

ChangePoints rain(const PerturbContext& context) {
  const Rain falling(context.strength);
  return [falling, draws = context.draws, least = least_power(context.shared)](std::size_t source,
                                                                               Frame& frame) {
    const Draws of_scan = draws.of(source);
    weaken(frame, falling.extinction_per_m, least,
           [&](std::size_t i, double target_m, double power) {
             return falling.strongest_before(of_scan.of(i), target_m, power);
           });
  };
}

ChangePoints fog(const PerturbContext& context) {
  const auto response = std::make_shared<const FogResponse>(context.strength);
  return [response, extinction_per_m = context.strength, draws = context.draws,
          least = least_power(context.shared)](std::size_t source, Frame& frame) {
    const Draws of_scan = draws.of(source);
    weaken(frame, extinction_per_m, least, [&](std::size_t i, double target_m, double) {
      return response->strongest_before(of_scan.of(i), target_m);
    });
  };
}

}  // namespace mosbench
