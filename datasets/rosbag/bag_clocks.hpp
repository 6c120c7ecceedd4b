#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "datasets/rosbag/bag_reader.hpp"
#include "datasets/sequence/pose_clock.hpp"

namespace mosbench {

/// When a message says that it was measured, and when it was recorded.
struct MessageTimes {
  std::int64_t stamp_ns = 0, recorded_ns = 0;
  std::int64_t last_ns = 0;  ///< of the points of a scan, after its stamp
};

/// Returns a doubt where scans and poses are stamped by clocks that differ, measured against the
/// recorder's: by more than 1.5 s (since boot instead of since 1970, or without leap seconds), or
/// because scans were recorded before their points were measured, or far later than poses are. Some
/// messages of each topic of poses are read. Throws DataError for damaged ones.
std::optional<ClockDoubt> doubt_about_clocks(const BagReader& bag,
                                             std::span<const MessageTimes> scans,
                                             const Reading& asked);

}  // namespace mosbench
