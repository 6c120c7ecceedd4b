#include "datasets/layouts/corrections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "datasets/formats/point_range.hpp"
#include "datasets/sequence/corrected_sequence.hpp"
#include "datasets/sequence/ego_points.hpp"
#include "datasets/sequence/scan_range.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

/// Whether several LiDARs were merged.
bool is_rig(const Sequence& sequence) { return !sequence.reading().lidars.empty(); }

/// The sequence with the times of its points, and deskewed by them unless its poses are found
/// later.
std::unique_ptr<Sequence> with_point_times(std::unique_ptr<Sequence> sequence,
                                           const Reading& reading) {
  if (!reading.undistorts() && !is_rig(*sequence)) return sequence;
  const ReadingDone& done = sequence->reading();
  if (reading.deskew && !reading.point_times && done.point_times.empty() && !done.undistortion &&
      !is_rig(*sequence)) {
    throw UsageError(fmt::format("{}: the points of {} have no times, expected {} or azimuth",
                                 option("deskew"), sequence->name(),
                                 option("point_times", "column")));
  }
  if (reading.point_times == PointTimes::kAzimuth) {
    sequence = with_azimuth_times(std::move(sequence));
  }
  const bool later = reading.is_by_odometry() || deskews_by_refined_poses(reading);
  const std::optional<Deskew> by = deskew_of(*sequence, reading);
  return later || !by ? std::move(sequence) : deskewed(std::move(sequence), *by);
}

/// No LiDAR sees as far: drivers store such numbers for missing returns. Every point of every scan
/// is asked, and most are so near that the way along the axes tells.
bool is_beyond_sight(const Point& point) {
  constexpr double kFarthest_m = 1e6;
  constexpr float kNear_m = 9e5F;
  if (!(std::abs(point.x) + std::abs(point.y) + std::abs(point.z) > kNear_m)) return false;
  return is_finite(point) && range_m(point) > kFarthest_m;
}

/// A sequence whose points beyond sight are missing returns.
class WithinSight : public SequenceAround {
 public:
  explicit WithinSight(std::unique_ptr<Sequence> inner) : SequenceAround(std::move(inner)) {
    constexpr std::size_t kLooked = 8;
    std::size_t points = 0, beyond = 0;
    for (std::size_t i = 0; i < std::min(kLooked, size()); ++i) {
      const Frame frame = scan_or_none(i * size() / std::min(kLooked, size()));
      points += frame.points.size();
      beyond += static_cast<std::size_t>(std::ranges::count_if(frame.points, is_beyond_sight));
    }
    if (beyond == 0) return;
    add_doubt(
        fmt::format("{} of {} looked at are more than 1000 km away: such points are taken for "
                    "missing returns",
                    beyond, counted(points, "point")));
  }

  using Sequence::read;
  void read(std::size_t scan_index, Frame& frame) const override {
    SequenceAround::read(scan_index, frame);
    for (Point& point : frame.points) {
      // Runs count those that are not finite, in whichever scan they are.
      constexpr float kNowhere = std::numeric_limits<float>::quiet_NaN();
      if (is_beyond_sight(point)) point = {kNowhere, kNowhere, kNowhere, 0};
    }
  }

 private:
  /// Returns nothing of a damaged scan, which reading it says.
  Frame scan_or_none(std::size_t scan_index) const {
    try {
      return inner().read(scan_index);
    } catch (const DataError&) {
      return {};
    }
  }
};

}  // namespace

void check_lidars(const Reading& asked, bool is_recording) {
  if (!asked.lidars) return;
  lidar_names(asked);
  const auto refuse = [](const std::string& what, const std::string& expected) {
    throw UsageError(fmt::format("{}: {}, expected {}", option("lidars"), what, expected));
  };
  if (!is_recording) refuse("is for recordings of your own", "one of these");
  if (asked.topic) refuse("and " + option("topic") + " name topics", "one of both");
  if (!asked.is_rig()) return;
  if (asked.point_times == PointTimes::kAzimuth || asked.hdl64_correction) {
    refuse("merges several, and azimuths and the correction of an HDL-64E are those of one", "one");
  }
}

std::optional<Deskew> deskew_of(const Sequence& sequence, const Reading& reading) {
  const ReadingDone& done = sequence.reading();
  const Deskew by = reading.deskew.value_or(Deskew::kPoses);
  if (is_rig(sequence)) return by;
  const bool has_times = reading.point_times == PointTimes::kAzimuth || by == Deskew::kVelocity ||
                         (!done.point_times.empty() && !done.undistortion);
  return by != Deskew::kNone && has_times ? std::optional(by) : std::nullopt;
}

bool deskews_by_refined_poses(const Reading& reading) {
  return reading.refine_poses && !reading.perturb && !reading.is_rig();
}

std::unique_ptr<Sequence> corrected(std::unique_ptr<Sequence> sequence, const Reading& reading) {
  sequence = std::make_unique<WithinSight>(std::move(sequence));
  if (reading.drop_scans == Drop::kAuto) sequence = without_useless_scans(std::move(sequence));
  if (reading.hdl64_correction) sequence = with_hdl64_correction(std::move(sequence));
  // What is mounted stays in the frame in which points were measured.
  if (reading.drop_ego == Drop::kAuto) sequence = without_ego(std::move(sequence));
  return with_point_times(std::move(sequence), reading);
}

}  // namespace mosbench
