#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <mosbench/scan.hpp>
#include <optional>
#include <span>
#include <vector>

namespace mosbench {

/// A labelled object in one frame.
struct TrackedBox {
  std::size_t frame = 0;
  Pose lidar_from_box = Pose::Identity();  ///< x along the length, y the width, z the height
  Eigen::Vector3d half_size_m = Eigen::Vector3d::Zero();
  std::uint32_t instance = 0;  ///< of its object; 0 where that is not known
};

/// The boxes of one object by frame, at most one in each.
using BoxTrack = std::vector<TrackedBox>;

/// Where the sensor was in one frame, and when.
struct FramePose {
  Pose map_from_lidar = Pose::Identity();
  std::int64_t stamp_ns = 0;
};

/// Returns the instance of an object that has this number, from 0 on: one more, or 0 beyond the 16
/// bits that labels have for it.
std::uint32_t instance_of_number(std::uint64_t number);

/// A box and the label of the points in it, with an instance in the upper 16 bits.
struct LabelledBox {
  Pose box_from_lidar = Pose::Identity();
  Eigen::Vector3d half_size_m = Eigen::Vector3d::Zero();
  std::uint32_t label = 0;
};

/// Boxes are compared with those of this time before and after.
inline constexpr double kTrackWindow_s = 0.5;

/// How far a box falls in one frame that `convert` and `simulate` wrote around points whose labels
/// say that they move: far enough to be fast over any time between two frames.
inline constexpr double kFall_m = 1e6;
/// Whether boxes fall so: their truth is one of labels, and no speed.
bool is_of_labels(std::span<const BoxTrack> tracks);

/// From which speed on a box moves when nothing else is asked.
inline constexpr double kBoxMovingSpeed_m_s = 0.5;

/// Returns the boxes of every frame: 251 from `moving_speed_m_s` on, 9 below, 0 for an object that
/// is seen in one frame alone, which has no instance. The speed is that of the box's centre in the
/// map between the first and the last box of its track within `kTrackWindow_s`, but at least those
/// before and after it. Where boxes overlap, moving comes last. Boxes of frames without pose are
/// left out.
std::vector<std::vector<LabelledBox>> label_boxes(std::span<const BoxTrack> tracks,
                                                  std::span<const std::optional<FramePose>> frames,
                                                  double moving_speed_m_s);

/// Whether nobody labelled a frame, as `convert` writes scans without truth: a box without label
/// holds all that a LiDAR reaches, and no box with one comes there.
bool is_unlabelled(std::span<const LabelledBox> boxes);

/// The points of a scan in the order of x, to find those in a box without looking at all.
class PointsInBoxes {
 public:
  /// Keeps `points`, which have to outlive it.
  explicit PointsInBoxes(std::span<const Point> points);

  /// Gives all points within a box, its sides included, one label.
  void label(const Pose& box_from_sensor, const Eigen::Vector3d& half_size_m, std::uint32_t label,
             std::span<std::uint32_t> labels) const;

 private:
  std::span<const Point> points_;
  std::vector<std::uint32_t> order_;
};

/// A box along the axes of the points' frame.
struct AxisBox {
  Eigen::Vector3d low_m, high_m;
};

/// Returns boxes that hold the points at the places `inside` and none of those at `outside`,
/// however they lie, unless two of both lie within some hundredths of a millimetre. Few boxes where
/// points of one kind keep together.
std::vector<AxisBox> pure_boxes(std::span<const Point> points, std::vector<std::uint32_t> inside,
                                std::vector<std::uint32_t> outside);

}  // namespace mosbench
