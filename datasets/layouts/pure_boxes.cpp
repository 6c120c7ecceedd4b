#include "datasets/layouts/pure_boxes.hpp"

#include <algorithm>
#include <utility>

#include "datasets/formats/point_range.hpp"

namespace mosbench {
namespace {

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

std::vector<AxisBox> pure_boxes(std::span<const Point> points, std::vector<std::uint32_t> inside,
                                std::vector<std::uint32_t> outside) {
  BoxSplitter splitter(points);
  if (!inside.empty()) splitter.split(inside, std::move(outside));
  return std::move(splitter).boxes();
}

}  // namespace mosbench
