#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mosbench/scan.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "datasets/sequence/pose_source.hpp"
#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// Returns map_from_sensor at a time in nanoseconds, or nothing where it is unknown.
using PoseAt = std::function<std::optional<Pose>(std::int64_t)>;

/// Moves every point to where the sensor at `reference_ns` would have seen it; point i was measured
/// at stamp_ns + times_ns[i] (lidar_undistortion of ethz-asl, as Dynablox uses it). Count and order
/// stay, missing returns and points measured at the reference keep their bits. Returns false,
/// with part of the points moved, when a pose is missing.
bool undistort(std::span<Point> points, std::span<const std::int64_t> times_ns,
               std::int64_t stamp_ns, std::int64_t reference_ns, const PoseAt& map_from_sensor);

/// Moves the points of scans to where the sensor would have seen them at the scan's stamp.
class ScanDeskewer {
 public:
  ScanDeskewer() = default;
  /// Scans without stamps are taken to be 0.1 s apart.
  ScanDeskewer(Deskew by, const std::vector<ScanEntry>& scans);

  /// Moves the returns of a frame that has their times, and drops the times. Where the poses do not
  /// cover the times (of the first or last scan), the frame stays as it is. That of a rig is always
  /// moved, with its origins: there by the motion since the scan before.
  void apply(std::size_t scan_index, Frame& frame) const;

 private:
  struct Motion {
    Pose map_from_sensor, to_next;
    std::int64_t period_ns;
  };
  std::optional<Motion> motion_at(std::size_t scan_index) const;
  bool move_by(Deskew by, std::size_t scan_index, Frame& frame) const;

  Deskew by_ = Deskew::kNone;
  std::vector<Pose> poses_;
  std::vector<std::int64_t> stamps_ns_;
  ScanTracks tracks_;
};

/// A sequence opened with `Reading::poses of ByOdometry` whose poses are found later. Scans
/// whose points have times are undistorted by the poses.
class PosedSequence : public SequenceAround {
 public:
  /// `how` replaces what the inner sequence states about poses. Poses are the identity until
  /// `set_poses`. Scans are deskewed by `deskew`, which is stated where the user asked for it.
  PosedSequence(std::unique_ptr<Sequence> inner, PosesDone how, Deskew deskew = Deskew::kPoses,
                bool states_deskew = false);

  /// One pose per scan. `remark` is what a reader of results should know about them. To be called
  /// before scans are read from several threads.
  void set_poses(const std::vector<Pose>& map_from_sensor, std::string remark = {});

  /// The sequence as it is without poses.
  const Sequence& unposed() const { return inner(); }

  using SequenceAround::read;
  void read(std::size_t scan_index, Frame& frame) const override;

 private:
  Deskew deskew_;
  ScanDeskewer deskewer_;
};

/// When each point was measured after the stamp of its scan, by a sensor that turns clockwise once
/// in `turn_ns`, looks ahead (x) at the stamp, and behind at the beginning and end of the scan, as
/// that of KITTI does. In steps of a 10,000th of a turn; 0 for points that have no direction.
std::vector<std::int64_t> azimuth_times_ns(std::span<const Point> points, std::int64_t turn_ns);

/// Returns the point raised by 0.205 degrees in the upright plane of its ray: KITTI's calibration
/// of its HDL-64E misses that angle (Deschaud, IMLS-SLAM, ICRA 2018; CT-ICP and KISS-ICP do the
/// same). A point on the z axis, a missing return among them, stays.
Point raised_by_hdl64_correction(const Point& point);

/// Return a sequence whose scans are changed after they are read, which its recording says:
/// deskewed by its own poses; with the times of their points' azimuths, where a turn takes as long
/// as scans are apart (the median of the stamps' intervals, or 0.1 s); with points raised by
/// `raised_by_hdl64_correction`.
std::unique_ptr<Sequence> deskewed(std::unique_ptr<Sequence> inner, Deskew by);
std::unique_ptr<Sequence> with_azimuth_times(std::unique_ptr<Sequence> inner);
std::unique_ptr<Sequence> with_hdl64_correction(std::unique_ptr<Sequence> inner);

}  // namespace mosbench
