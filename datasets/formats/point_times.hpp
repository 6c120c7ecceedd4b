#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

/// Units in which recordings keep times.
enum class TimeUnit : std::uint8_t {
  kSeconds,
  kMilliseconds,
  kMicroseconds,
  kNanoseconds,
  kSteps  ///< shares of the time between scans
};
inline constexpr std::array<std::string_view, 5> kTimeUnitNames = {"s", "ms", "us", "ns", "steps"};
inline std::string_view to_string(TimeUnit unit) {
  return kTimeUnitNames[static_cast<std::size_t>(unit)];
}

/// Returns s, ms, us or ns: the one in which `number` is a time from `lowest_s` up to `highest_s`,
/// which is below 1000 times that; nothing when there is none.
std::optional<TimeUnit> unit_within(double number, double lowest_s, double highest_s);

/// Returns the unit in which a number is a time since 1970, of the years from 1990 to 2110.
std::optional<TimeUnit> unit_since_1970(double number);

/// Returns the median, or another quantile, of the steps that lead on; 0 where none does.
double usual_step(std::span<const double> stamps, double q = 0.5);

/// No sensor is slower, but recordings may keep few scans.
inline constexpr double kLongestKept_s = 20.0;

/// Returns the unit of stamps that should be in seconds, of scans or poses.
TimeUnit unit_of_stamps(std::span<const double> stamps);

/// What the points of a scan say, as it is stored.
struct StoredTimes {
  std::vector<double> times;
  std::optional<std::int64_t> stamp_ns;  ///< of the scan
};

/// Of points whose times are not to be believed.
inline constexpr std::int64_t kNoTime = std::numeric_limits<std::int64_t>::min();

/// How the points of a recording keep their times: in which unit, and since when. Both are judged
/// by whole scans: a sweep lasts at most as long as scans are apart, and single points may hold
/// anything.
class PointClock {
 public:
  /// `scans` are some of the recording's, `step_s` is the usual time between scans; `told` is the
  /// unit if the user said it.
  PointClock(std::span<const StoredTimes> scans, std::optional<double> step_s,
             std::optional<TimeUnit> told = std::nullopt);
  /// Knows no unit.
  PointClock() = default;

  /// Returns the times of a scan's points after its stamp, kNoTime for those that are off; nothing
  /// at all where most are, or where no unit fits the recording.
  std::vector<std::int64_t> after_stamp_ns(const StoredTimes& scan) const;

  bool knows_unit() const { return unit_.has_value(); }
  /// Whether the times differ in no unit of time, or are all the same but not 0.
  bool is_odd() const { return is_odd_; }
  /// "us since the scan's stamp, span 99.8 ms", or why the times are not used.
  const std::string& text() const { return text_; }
  /// How many of the points and scans that were judged are left as they were measured; empty when
  /// all are used.
  const std::string& doubt() const { return doubt_; }

 private:
  enum class Origin : std::uint8_t { kStamp, kClockOfStamp, kFirst };
  /// The times of most points, as stored.
  struct Sweep {
    double first = 0.0, last = 0.0;
  };
  double longest_s() const;
  double seconds_of(TimeUnit unit) const;
  std::optional<Sweep> sweep_of(std::span<const double> times, TimeUnit unit) const;
  bool fits(std::span<const double> times, TimeUnit unit) const;
  void judge_unit(std::span<const StoredTimes> scans);
  void judge_origin(std::span<const StoredTimes> scans);
  void count_bad(std::span<const StoredTimes> scans);
  double origin_ns(const Sweep& sweep, const StoredTimes& scan) const;

  std::optional<double> step_s_;
  std::optional<TimeUnit> unit_;
  Origin origin_ = Origin::kStamp;
  bool is_odd_ = false;
  std::string text_ = "none", doubt_;
};

/// Replaces kNoTime by a time at which points are not moved.
void settle_times(std::vector<std::int64_t>& times_ns, std::int64_t reference_ns);

}  // namespace mosbench
