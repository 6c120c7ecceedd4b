#include "datasets/layouts/boxes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "datasets/formats/label_file.hpp"
#include "datasets/formats/point_range.hpp"
#include "datasets/sequence/sequence.hpp"

namespace mosbench {
namespace {

/// The centre of a box in the map.
struct Sighting {
  const TrackedBox* box;
  Eigen::Vector3d centre_m;
  double time_s;
};

std::vector<Sighting> sightings_of(const BoxTrack& track,
                                   std::span<const std::optional<FramePose>> frames) {
  std::vector<Sighting> sightings;
  std::int64_t first_ns = 0;
  for (const TrackedBox& box : track) {
    if (box.frame >= frames.size() || !frames[box.frame]) continue;
    const FramePose& pose = *frames[box.frame];
    if (sightings.empty()) first_ns = pose.stamp_ns;
    sightings.push_back({&box, pose.map_from_lidar * box.lidar_from_box.translation(),
                         static_cast<double>(pose.stamp_ns - first_ns) * 1e-9});
  }
  return sightings;
}

constexpr std::uint32_t kIdBits = 16, kIds = 1U << kIdBits;

std::uint32_t id_of(const LabelledBox& box) { return box.label % kIds; }

std::uint32_t id_at(std::span<const Sighting> track, std::size_t at, double moving_speed_m_s) {
  std::size_t first = at == 0 ? 0 : at - 1;
  std::size_t last = std::min(at + 1, track.size() - 1);
  const double time_s = track[at].time_s;
  while (first > 0 && time_s - track[first - 1].time_s <= kTrackWindow_s) --first;
  while (last + 1 < track.size() && track[last + 1].time_s - time_s <= kTrackWindow_s) ++last;
  const double span_s = track[last].time_s - track[first].time_s;
  if (!(span_s > 0.0)) return 0;
  const double speed_m_s = (track[last].centre_m - track[first].centre_m).norm() / span_s;
  return speed_m_s >= moving_speed_m_s ? kMovingLabel : kStaticLabel;
}

/// What boxes reach beyond their points, and twice that keeps others out: rounding in a file must
/// change nothing.
constexpr double kReach_m = 1e-5;

AxisBox box_around(std::span<const Point> points, std::span<const std::uint32_t> places) {
  AxisBox box{position_of(points[places.front()]), position_of(points[places.front()])};
  for (const std::uint32_t i : places) {
    box.low_m = box.low_m.cwiseMin(position_of(points[i]));
    box.high_m = box.high_m.cwiseMax(position_of(points[i]));
  }
  box.low_m.array() -= kReach_m;
  box.high_m.array() += kReach_m;
  return box;
}

bool holds_nearly(const AxisBox& box, const Eigen::Vector3d& p) {
  return (p.array() >= box.low_m.array() - kReach_m).all() &&
         (p.array() <= box.high_m.array() + kReach_m).all();
}

class BoxSplitter {
 public:
  explicit BoxSplitter(std::span<const Point> points) : points_(points) {}

  void split(std::span<std::uint32_t> inside, std::vector<std::uint32_t> outside) {
    const AxisBox box = box_around(points_, inside);
    std::erase_if(outside,
                  [&](std::uint32_t i) { return !holds_nearly(box, position_of(points_[i])); });
    if (outside.empty() || inside.size() == 1) {
      boxes_.push_back(box);
      return;
    }
    Eigen::Index axis = 0;
    (box.high_m - box.low_m).maxCoeff(&axis);
    const std::size_t half = inside.size() / 2;
    std::ranges::nth_element(inside, inside.begin() + static_cast<std::ptrdiff_t>(half), {},
                             [&](std::uint32_t i) { return position_of(points_[i])[axis]; });
    split(inside.first(half), outside);
    split(inside.subspan(half), std::move(outside));
  }
  std::vector<AxisBox> boxes() && { return std::move(boxes_); }

 private:
  std::span<const Point> points_;
  std::vector<AxisBox> boxes_;
};

}  // namespace

std::uint32_t instance_of_number(std::uint64_t number) {
  return number + 1 < kIds ? static_cast<std::uint32_t>(number + 1) : 0;
}

bool is_of_labels(std::span<const BoxTrack> tracks) {
  return std::ranges::any_of(tracks, [](const BoxTrack& track) {
    return std::ranges::any_of(track, [](const TrackedBox& box) {
      return box.lidar_from_box.translation().norm() > 0.5 * kFall_m;
    });
  });
}

std::vector<std::vector<LabelledBox>> label_boxes(std::span<const BoxTrack> tracks,
                                                  std::span<const std::optional<FramePose>> frames,
                                                  double moving_speed_m_s) {
  std::vector<std::vector<LabelledBox>> boxes(frames.size());
  for (const BoxTrack& track : tracks) {
    const std::vector<Sighting> sightings = sightings_of(track, frames);
    for (std::size_t i = 0; i < sightings.size(); ++i) {
      const TrackedBox& box = *sightings[i].box;
      const std::uint32_t id = id_at(sightings, i, moving_speed_m_s);
      boxes[box.frame].push_back({box.lidar_from_box.inverse(), box.half_size_m,
                                  id == 0 ? 0 : id | (box.instance << kIdBits)});
    }
  }
  for (auto& of_frame : boxes) std::ranges::stable_sort(of_frame, {}, id_of);
  return boxes;
}

bool is_unlabelled(std::span<const LabelledBox> boxes) {
  constexpr double kReach_m = 200.0;
  bool covers = false;
  for (const LabelledBox& box : boxes) {
    const Eigen::Vector3d sensor_m = box.box_from_lidar.translation();
    if (id_of(box) != 0 && sensor_m.norm() <= kReach_m + box.half_size_m.norm()) return false;
    const Eigen::Array3d reached_m = sensor_m.cwiseAbs().array() + kReach_m;
    covers = covers || (id_of(box) == 0 && (reached_m <= box.half_size_m.array()).all());
  }
  return covers;
}

PointsInBoxes::PointsInBoxes(std::span<const Point> points) : points_(points) {
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (!std::isnan(points[i].x)) order_.push_back(i);
  }
  std::ranges::sort(order_, {}, [&](std::uint32_t i) { return points_[i].x; });
}

void PointsInBoxes::label(const Pose& box_from_sensor, const Eigen::Vector3d& half_size_m,
                          std::uint32_t label, std::span<std::uint32_t> labels) const {
  const double x_m = box_from_sensor.inverse().translation().x();
  // A little more on either side: the rounding of the motion must lose no point.
  const double reach_m = half_size_m.norm() + 1e-5 * (1.0 + std::abs(x_m));
  const auto x_of = [&](std::uint32_t i) { return static_cast<double>(points_[i].x); };
  const double low_m = x_m - reach_m, high_m = x_m + reach_m;
  for (auto i = std::ranges::lower_bound(order_, low_m, {}, x_of); i != order_.end(); ++i) {
    if (x_of(*i) > high_m) break;
    const Eigen::Vector3d p = box_from_sensor * position_of(points_[*i]);
    if ((p.cwiseAbs().array() <= half_size_m.array()).all()) labels[*i] = label;
  }
}

std::vector<AxisBox> pure_boxes(std::span<const Point> points, std::vector<std::uint32_t> inside,
                                std::vector<std::uint32_t> outside) {
  BoxSplitter splitter(points);
  if (!inside.empty()) splitter.split(inside, std::move(outside));
  return std::move(splitter).boxes();
}

}  // namespace mosbench
