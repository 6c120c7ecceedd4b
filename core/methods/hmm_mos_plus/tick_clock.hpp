#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace mosbench::hmm_mos_plus {

/// When a scan was measured, in tenths of a second, so that histories of 5 and of 20 Hz are like
/// those of 10 Hz.
struct Tick {
  std::uint32_t at = 0;       ///< since the first scan; wraps around
  std::uint32_t steps = 1;    ///< since the scan before
  std::uint32_t periods = 1;  ///< since the scan before, in scans, missing ones counted
  double period_s = 0.1;      ///< of the scans
};

/// Gives each scan its tick. The period is the median distance of the stamps, and 0.08 to 0.125 s
/// count as 0.1 s: jitter changes nothing, a scan that is missing counts as if it had been there.
class TickClock {
 public:
  static constexpr double kSeconds = 0.1;

  /// `stamps_ns` of all scans; without any, and behind the last, scans are 0.1 s apart.
  explicit TickClock(std::span<const std::int64_t> stamps_ns);

  Tick of(std::uint32_t scan_index) const;

 private:
  std::vector<Tick> ticks_;
};

}  // namespace mosbench::hmm_mos_plus
