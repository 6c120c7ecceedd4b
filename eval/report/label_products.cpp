#include "eval/report/label_products.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <set>
#include <string_view>

#include "core/base/thread_pool.hpp"
#include "datasets/formats/point_range.hpp"
#include "datasets/text/errors.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/report/point_planes.hpp"
#include "eval/result/result_file.hpp"
#include "eval/result/tell.hpp"
#include "eval/store/store.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr double kMapVoxel_m = 0.1;

std::vector<Eigen::Vector3d> moving_points_of(const JudgedScan& scan) {
  std::vector<Eigen::Vector3d> positions_map_m;
  for (std::size_t i = 0; i < scan.outcomes.size(); ++i) {
    const Point& point = scan.frame.points[i];
    if (!is_labelled_moving(scan.outcomes[i])) continue;
    positions_map_m.push_back(scan.frame.map_from_sensor * position_of(point));
  }
  return positions_map_m;
}

/// To the hundredth, or to another part of 1.
double rounded_to_part(double value, double parts = 100.0) {
  return std::round(parts * value) / parts;
}

ordered_json numbers_of(const MovingBox& box, const Pose& sensor_from_map) {
  const Pose sensor_from_box = sensor_from_map * box.map_from_box;
  const Eigen::Vector3d ahead = sensor_from_box.linear().col(0);
  ordered_json numbers = ordered_json::array();
  for (const double value : sensor_from_box.translation())
    numbers.push_back(rounded_to_part(value));
  numbers.push_back(rounded_to_part(std::atan2(ahead.y(), ahead.x())));
  for (const double value : box.size_m) numbers.push_back(rounded_to_part(value));
  const auto& velocity_m_s = box.velocity_m_s;
  numbers.push_back(velocity_m_s ? ordered_json(rounded_to_part(velocity_m_s->norm(), 1e3))
                                 : nullptr);
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

ordered_json triple(const Eigen::Vector3d& vector) { return {vector.x(), vector.y(), vector.z()}; }

ordered_json box_json(const MovingBox& box) {
  const Eigen::Vector3d ahead = box.map_from_box.linear().col(0);
  return {{"track", box.track},
          {"points", box.points},
          {"centre_map_m", triple(box.map_from_box.translation())},
          {"yaw_map_rad", std::atan2(ahead.y(), ahead.x())},
          {"size_m", triple(box.size_m)},
          {"velocity_map_m_s", box.velocity_m_s ? triple(*box.velocity_m_s) : ordered_json()}};
}

std::string boxes_text(const ResultScans& scans, const std::vector<std::vector<MovingBox>>& boxes) {
  ordered_json json = {
      {"format", 1}, {"sequence", scans.sequence().name()}, {"scans", ordered_json::array()}};
  for (std::size_t k = 0; k < boxes.size(); ++k) {
    const std::optional<std::int64_t> stamp_ns = scans.sequence().recording().scans[k].stamp_ns;
    ordered_json& of_scan = json["scans"].emplace_back();
    of_scan = {{"stem", scans.rows()[k].stem},
               {"stamp_ns", stamp_ns ? ordered_json(*stamp_ns) : ordered_json()},
               {"boxes", ordered_json::array()}};
    for (const MovingBox& box : boxes[k]) of_scan["boxes"].push_back(box_json(box));
  }
  return json_text(json);
}

/// A row as KITTI's tracking benchmark has them, for a camera that looks ahead from the LiDAR's
/// place: x right, y down, z ahead, the middle of the bottom. Nothing is known of images.
std::string kitti_row(std::size_t scan_index, const MovingBox& box, const Pose& sensor_from_map) {
  const Pose sensor_from_box = sensor_from_map * box.map_from_box;
  const Eigen::Vector3d ahead = sensor_from_box.linear().col(0);
  const Eigen::Vector3d bottom = sensor_from_box * Eigen::Vector3d(0, 0, -0.5 * box.size_m.z());
  const double rotation_rad = std::remainder(
      -std::atan2(ahead.y(), ahead.x()) - std::numbers::pi / 2.0, 2.0 * std::numbers::pi);
  return fmt::format(
      "{} {} Moving -1 -1 -10 -1 -1 -1 -1 {:.3f} {:.3f} {:.3f} {:.3f} {:.3f} {:.3f} {:.4f}\n",
      scan_index, box.track, box.size_m.z(), box.size_m.y(), box.size_m.x(), -bottom.y(),
      -bottom.z(), bottom.x(), rotation_rad);
}

std::string kitti_text(const ResultScans& scans, const std::vector<std::vector<MovingBox>>& boxes) {
  std::string rows;
  for (std::size_t k = 0; k < boxes.size(); ++k) {
    const Pose sensor_from_map = scans.sequence().map_from_sensor(k).inverse();
    for (const MovingBox& box : boxes[k]) rows += kitti_row(k, box, sensor_from_map);
  }
  return rows;
}

static_assert(std::endian::native == std::endian::little);

/// A binary PLY file of x, y, z in `type` and the intensity.
template <typename Coordinate>
std::string ply_of(const std::vector<Eigen::Matrix<Coordinate, 3, 1>>& positions_m,
                   const std::vector<float>& intensities, std::string_view type) {
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {0}\nproperty {1} x\nproperty {1} "
      "y\nproperty {1} z\nproperty float intensity\nend_header\n",
      positions_m.size(), type);
  for (std::size_t i = 0; i < positions_m.size(); ++i) {
    bytes.append(reinterpret_cast<const char*>(positions_m[i].data()), 3 * sizeof(Coordinate));
    bytes.append(reinterpret_cast<const char*>(&intensities[i]), sizeof(float));
  }
  return bytes;
}

/// A binary PCD file of x, y, z and the intensity in float32, as PCL's own points have them: it
/// takes other types of x, y and z for missing.
std::string pcd_of(const std::vector<Eigen::Vector3d>& positions_m,
                   const std::vector<float>& intensities) {
  std::string bytes = fmt::format(
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z intensity\nSIZE 4 4 4 "
      "4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH {0}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS "
      "{0}\nDATA binary\n",
      positions_m.size());
  for (std::size_t i = 0; i < positions_m.size(); ++i) {
    const Eigen::Vector3f position_m = positions_m[i].cast<float>();
    bytes.append(reinterpret_cast<const char*>(position_m.data()), 3 * sizeof(float));
    bytes.append(reinterpret_cast<const char*>(&intensities[i]), sizeof(float));
  }
  return bytes;
}

void write_boxes(const ResultScans& scans, ProductRecord& record) {
  const bool has_json = record.has("boxes.json"), has_text = record.has("boxes.txt");
  if (has_json && has_text) return;
  std::vector<std::size_t> all(scans.rows().size());
  for (std::size_t k = 0; k < all.size(); ++k) all[k] = k;
  const auto boxes = boxes_of(scans, all);
  record.write("boxes.txt", kitti_text(scans, boxes));
  record.write("boxes.json", boxes_text(scans, boxes));
}

/// The points of a scan that are labelled moving, as they were measured.
std::string moving_cloud(const JudgedScan& scan) {
  std::vector<Eigen::Vector3f> positions_m;
  std::vector<float> intensities;
  for (std::size_t i = 0; i < scan.outcomes.size(); ++i) {
    const Point& point = scan.frame.points[i];
    if (!is_labelled_moving(scan.outcomes[i])) continue;
    positions_m.emplace_back(point.x, point.y, point.z);
    intensities.push_back(point.intensity);
  }
  return ply_of(positions_m, intensities, "float");
}

void write_moving_clouds(const ResultScans& scans, ProductRecord& record) {
  Progress progress("moving clouds", scans.rows().size());
  for (std::size_t k = 0; k < scans.rows().size(); ++k) {
    const std::string file = fmt::format("moving/{}.ply", scans.rows()[k].stem);
    if (!record.has(file)) record.write(file, moving_cloud(scans.read(k)));
    progress.advance();
  }
}

/// The first point in each voxel of the map, of those that are labelled static.
class StaticMap {
 public:
  void add(const JudgedScan& scan) {
    for (std::size_t i = 0; i < scan.outcomes.size(); ++i) {
      const Point& point = scan.frame.points[i];
      if (is_labelled_moving(scan.outcomes[i]) || !is_drawable(point)) continue;
      const Eigen::Vector3d position_m = scan.frame.map_from_sensor * position_of(point);
      std::array<std::int64_t, 3> voxel{};
      for (std::size_t axis = 0; axis < voxel.size(); ++axis) {
        voxel[axis] = static_cast<std::int64_t>(
            std::floor(position_m[static_cast<Eigen::Index>(axis)] / kMapVoxel_m));
      }
      if (!voxels_.insert(voxel).second) continue;
      positions_m_.push_back(position_m);
      intensities_.push_back(point.intensity);
    }
  }

  std::string ply() const { return ply_of(positions_m_, intensities_, "double"); }

  /// Throws DataError naming the file where float32 is too coarse for the voxels.
  std::string pcd(const fs::path& file) const {
    constexpr double kMostShare = 0.1;
    double most_m = 0.0;
    for (const Eigen::Vector3d& position_m : positions_m_) {
      most_m = std::max(most_m, position_m.cwiseAbs().maxCoeff());
    }
    const float step_m = float_step_m(static_cast<float>(most_m));
    if (step_m <= kMostShare * kMapVoxel_m) return pcd_of(positions_m_, intensities_);
    throw DataError(
        file, fmt::format("positions up to {:.0f} m are {} m apart in float32", most_m, step_m),
        "poses nearer to their origin, or static-cloud, whose .ply has float64");
  }

 private:
  std::set<std::array<std::int64_t, 3>> voxels_;
  std::vector<Eigen::Vector3d> positions_m_;
  std::vector<float> intensities_;
};

/// Scans in which the method did not look for motion may hold anything.
StaticMap static_map_of(const ResultScans& scans) {
  StaticMap map;
  Progress progress("static map", scans.rows().size());
  for (std::size_t k = 0; k < scans.rows().size(); ++k) {
    if (scans.rows()[k].judged) map.add(scans.read(k));
    progress.advance();
  }
  return map;
}

void write_static_ply(const ResultScans& scans, ProductRecord& record) {
  if (!record.has("static.ply")) record.write("static.ply", static_map_of(scans).ply());
}

void write_static_pcd(const ResultScans& scans, ProductRecord& record) {
  const std::string file = "static.pcd";
  if (record.has(file)) return;
  record.write(file, static_map_of(scans).pcd(record.folder() / file));
}

struct Product {
  std::string_view name;
  void (*write)(const ResultScans& scans, ProductRecord& record);
};

constexpr std::array kProducts = {
    Product{"boxes", write_boxes}, Product{"moving-cloud", write_moving_clouds},
    Product{"static-cloud", write_static_ply}, Product{"static-cloud-pcd", write_static_pcd}};

}  // namespace

ordered_json boxes_json(const ResultScans& scans, const std::vector<std::size_t>& wanted) {
  ordered_json json = ordered_json::array();
  const std::vector<std::vector<MovingBox>> boxes = boxes_of(scans, wanted);
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    ordered_json& of_scan = json.emplace_back(ordered_json::array());
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

std::vector<std::string> product_names() {
  std::vector<std::string> names;
  for (const Product& product : kProducts) names.emplace_back(product.name);
  return names;
}

void write_products(const fs::path& folder, std::span<const std::string> names) {
  if (names.empty()) return;
  const Result result = read_result(folder / "result.json");
  const ResultScans scans(result, std::nullopt);
  ProductRecord record(folder);
  for (const Product& product : kProducts) {
    if (std::ranges::find(names, product.name) == names.end()) continue;
    product.write(scans, record);
    record.save();
  }
}

}  // namespace mosbench
