#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace mosbench::odometry {

/// The time between scans.
class ScanClock {
 public:
  explicit ScanClock(double default_period_s);

  struct Interval {
    std::int64_t period_ns;  ///< usual time between scans
    double periods = 1;      ///< since the scan before; 1 unless scans are missing
    std::string doubt;       ///< what is wrong with the stamp; empty when nothing is
  };
  /// Takes the stamp of the next scan. Intervals up to 2.5 times the usual one are taken as usual.
  Interval tick(std::optional<std::int64_t> stamp_ns);

 private:
  std::optional<std::int64_t> last_ns_;
  std::int64_t period_ns_;
  bool measured_ = false;
};

}  // namespace mosbench::odometry
