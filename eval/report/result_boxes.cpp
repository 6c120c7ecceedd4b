#include "eval/report/result_boxes.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/thread_pool.hpp"
#include "datasets/formats/point_range.hpp"

namespace mosbench {
namespace {

std::vector<Eigen::Vector3d> moving_points_of(const JudgedScan& scan) {
  std::vector<Eigen::Vector3d> positions_map_m;
  for (std::size_t i = 0; i < scan.outcomes.size(); ++i) {
    const Point& point = scan.frame.points[i];
    if (!is_labelled_moving(scan.outcomes[i])) continue;
    positions_map_m.push_back(scan.frame.map_from_sensor * position_of(point));
  }
  return positions_map_m;
}

double to_hundredths(double value) { return std::round(100.0 * value) / 100.0; }

double to_thousandths(double value) { return std::round(1000.0 * value) / 1000.0; }

nlohmann::ordered_json numbers_of(const MovingBox& box, const Pose& sensor_from_map) {
  const Pose sensor_from_box = sensor_from_map * box.map_from_box;
  const Eigen::Vector3d ahead = sensor_from_box.linear().col(0);
  nlohmann::ordered_json numbers = nlohmann::ordered_json::array();
  for (const double value : sensor_from_box.translation()) numbers.push_back(to_hundredths(value));
  numbers.push_back(to_hundredths(std::atan2(ahead.y(), ahead.x())));
  for (const double value : box.size_m) numbers.push_back(to_hundredths(value));
  numbers.push_back(box.velocity_m_s
                        ? nlohmann::ordered_json(to_thousandths(box.velocity_m_s->norm()))
                        : nlohmann::ordered_json());
  return numbers;
}

/// The scans with labels that are wanted or near to one.
std::vector<std::size_t> scans_around(const ResultScans& scans,
                                      const std::vector<std::size_t>& wanted) {
  std::vector<bool> near(scans.rows().size(), false);
  for (const std::size_t k : wanted) {
    const std::size_t last = std::min(k + kScansAroundBoxes, near.size() - 1);
    for (std::size_t i = k - std::min(k, kScansAroundBoxes); i <= last; ++i) near[i] = true;
  }
  std::vector<std::size_t> around;
  for (std::size_t k = 0; k < near.size(); ++k) {
    if (near[k] && scans.has(k)) around.push_back(k);
  }
  return around;
}

}  // namespace

bool is_labelled_moving(PointOutcome outcome) {
  return outcome == PointOutcome::kTruePositive || outcome == PointOutcome::kFalsePositive ||
         outcome == PointOutcome::kIgnoredMoving;
}

nlohmann::ordered_json boxes_json(const ResultScans& scans,
                                  const std::vector<std::size_t>& wanted) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  const std::vector<std::vector<MovingBox>> boxes = boxes_of(scans, wanted);
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    nlohmann::ordered_json& of_scan = json.emplace_back(nlohmann::ordered_json::array());
    const Pose sensor_from_map = scans.sequence().map_from_sensor(wanted[i]).inverse();
    for (const MovingBox& box : boxes[i]) of_scan.push_back(numbers_of(box, sensor_from_map));
  }
  return json;
}

std::vector<std::vector<MovingBox>> boxes_of(const ResultScans& scans,
                                             const std::vector<std::size_t>& wanted) {
  const std::vector<std::size_t> around = scans_around(scans, wanted);
  std::vector<std::vector<MovingBox>> found = moving_boxes(
      scans.sequence(), around, [&](std::size_t k) { return moving_points_of(scans.read(k)); },
      hardware_threads());
  std::vector<std::vector<MovingBox>> boxes;
  for (const std::size_t k : wanted) {
    const auto at = std::ranges::lower_bound(around, k);
    const bool has = at != around.end() && *at == k;
    boxes.push_back(has ? std::move(found[static_cast<std::size_t>(at - around.begin())])
                        : std::vector<MovingBox>());
  }
  return boxes;
}

}  // namespace mosbench
