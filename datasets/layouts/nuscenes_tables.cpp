#include "datasets/layouts/nuscenes_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <unordered_map>
#include <unordered_set>

#include "datasets/disk/files.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/formats/nuscenes_table.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/layouts/boxes.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

/// Attributes of what moves, as MapMOS takes them.
constexpr std::array kMovingAttributes = {"vehicle.moving", "cycle.with_rider",
                                          "pedestrian.moving"};

Eigen::Vector3d vector_of(const std::vector<double>& numbers) {
  return {numbers[0], numbers[1], numbers[2]};
}

Pose pose_in(const NuscenesRow& row) {
  const std::vector<double>& wxyz = row.numbers("rotation", 4);
  const auto pose = pose_of(vector_of(row.numbers("translation", 3)),
                            Eigen::Vector4d(wxyz[1], wxyz[2], wxyz[3], wxyz[0]));
  if (!pose) row.refuse("\"rotation\" is no unit quaternion", "w x y z of length 1");
  return *pose;
}

std::int64_t stamp_ns_in(const NuscenesRow& row) {
  constexpr std::int64_t kNsPerUs = 1000;
  const std::int64_t stamp_us = row.integer("timestamp");
  if (stamp_us < 0 || stamp_us > std::numeric_limits<std::int64_t>::max() / kNsPerUs) {
    row.refuse(fmt::format("\"timestamp\" is {}", stamp_us), "microseconds since 1970");
  }
  return stamp_us * kNsPerUs;
}

/// Refuses names that lead out of the data set.
fs::path scan_file_in(const NuscenesRow& row) {
  const fs::path file = fs::path(row.text("filename")).lexically_normal();
  const bool leads_out = file.empty() || file.is_absolute() || *file.begin() == "..";
  if (leads_out) row.refuse("\"filename\" is no path within the data set", "samples/LIDAR_TOP/...");
  return file;
}

NuscenesBox box_in(const NuscenesRow& row) {
  const std::vector<double>& width_length_height = row.numbers("size", 3);
  NuscenesBox box{pose_in(row),
                  0.5 * Eigen::Vector3d(width_length_height[1], width_length_height[0],
                                        width_length_height[2])};
  if (box.half_size_m.minCoeff() < 0.0) row.refuse("\"size\" is negative", "metres");
  return box;
}

constexpr std::string_view kWrittenObject = "mosbench-object-";

std::optional<std::uint32_t> written_instance(std::string_view token) {
  constexpr std::uint64_t kMost = 65535;
  if (!token.starts_with(kWrittenObject)) return std::nullopt;
  const auto instance = parse_unsigned(token.substr(kWrittenObject.size()));
  if (!instance || *instance > kMost) return std::nullopt;
  return static_cast<std::uint32_t>(*instance);
}

/// A row of sample_data.json that is of LIDAR_TOP.
struct LidarRow {
  std::size_t sample = 0;
  Pose ego_from_sensor = Pose::Identity();
  bool has_pose = false;
  NuscenesScan scan;
};

/// Reads one table after the other; each keeps only what the next needs.
class TableReader {
 public:
  explicit TableReader(fs::path folder) : folder_(std::move(folder)) {}

  NuscenesTables read() {
    read_sensors();
    read_samples();
    read_scans();
    read_poses();
    read_boxes();
    return std::move(*this).tables();
  }

 private:
  using Row = NuscenesRow;

  template <typename Take>
  void for_rows(const char* table, Take&& take) const {
    read_nuscenes_table(folder_ / table, take);
  }

  static void refuse_twice(const Row& row, bool is_new) {
    if (!is_new) row.refuse("has the token of another row", "one row per token");
  }

  void read_sensors() {
    std::unordered_set<std::string> lidars;
    for_rows("sensor.json", [&](const Row& row) {
      if (row.text("channel") == "LIDAR_TOP") lidars.insert(row.text("token"));
    });
    for_rows("calibrated_sensor.json", [&](const Row& row) {
      if (!lidars.contains(row.text("sensor_token"))) return;
      refuse_twice(row, mounts_.emplace(row.text("token"), pose_in(row)).second);
    });
  }

  void read_samples() {
    std::unordered_map<std::string, std::size_t> scene_of_token;
    for_rows("scene.json", [&](const Row& row) {
      refuse_twice(row, scene_of_token.emplace(row.text("token"), scenes_.size()).second);
      scenes_.push_back({row.text("name"), {}});
    });
    for_rows("sample.json", [&](const Row& row) {
      const auto scene = scene_of_token.find(row.text("scene_token"));
      if (scene == scene_of_token.end()) row.refuse("is of no scene", "one of scene.json");
      refuse_twice(row,
                   sample_of_token_.emplace(row.text("token"), scene_of_sample_.size()).second);
      scene_of_sample_.push_back(scene->second);
    });
    boxes_.resize(scene_of_sample_.size());
    instances_.resize(scenes_.size());
  }

  void read_scans() {
    for_rows("sample_data.json", [&](const Row& row) {
      const auto mount = mounts_.find(row.text("calibrated_sensor_token"));
      if (mount == mounts_.end()) return;
      const auto sample = sample_of_token_.find(row.text("sample_token"));
      if (sample == sample_of_token_.end()) row.refuse("is of no sample", "one of sample.json");
      rows_of_pose_.emplace(row.text("ego_pose_token"), rows_.size());
      rows_.push_back(
          {sample->second,
           mount->second,
           false,
           {scan_file_in(row), stamp_ns_in(row), Pose::Identity(), row.flag("is_key_frame"), {}}});
    });
  }

  void read_poses() {
    for_rows("ego_pose.json", [&](const Row& row) {
      const auto [first, last] = rows_of_pose_.equal_range(row.text("token"));
      for (auto found = first; found != last; ++found) {
        LidarRow& lidar = rows_[found->second];
        refuse_twice(row, !lidar.has_pose);
        lidar.scan.map_from_sensor = pose_in(row) * lidar.ego_from_sensor;
        lidar.has_pose = true;
      }
    });
  }

  void read_boxes() {
    if (!is_there(folder_ / "sample_annotation.json")) return;
    std::unordered_set<std::string> all, moving;
    for_rows("attribute.json", [&](const Row& row) {
      const bool moves =
          std::ranges::find(kMovingAttributes, row.text("name")) != kMovingAttributes.end();
      refuse_twice(row, all.insert(row.text("token")).second);
      if (moves) moving.insert(row.text("token"));
    });
    for_rows("sample_annotation.json", [&](const Row& row) {
      has_annotations_ = true;
      const std::vector<std::string>& attributes = row.texts("attribute_tokens");
      for (const std::string& attribute : attributes) {
        if (!all.contains(attribute))
          row.refuse("has an unknown attribute", "one of attribute.json");
      }
      if (attributes.empty() || !moving.contains(attributes.front())) return;
      const auto sample = sample_of_token_.find(row.text("sample_token"));
      if (sample == sample_of_token_.end()) row.refuse("is of no sample", "one of sample.json");
      NuscenesBox& box = boxes_[sample->second].emplace_back(box_in(row));
      box.instance = instance_in(row, scene_of_sample_[sample->second]);
    });
  }

  /// Numbers the objects of each scene as they come; beyond 16 bits they have no number.
  std::uint32_t instance_in(const Row& row, std::size_t scene) {
    if (!row.has("instance_token")) return 0;
    const std::string& token = row.text("instance_token");
    if (const auto written = written_instance(token)) return *written;
    auto& numbers = instances_[scene];
    return instance_of_number(numbers.emplace(token, numbers.size()).first->second);
  }

  /// Returns the boxes of a key frame; the last one of a sample takes them.
  std::vector<NuscenesBox> boxes_of(std::size_t sample) {
    std::vector<NuscenesBox>& boxes = boxes_[sample];
    boxes.shrink_to_fit();
    return --key_frames_[sample] == 0 ? std::move(boxes) : boxes;
  }

  NuscenesTables tables() && {
    key_frames_.resize(boxes_.size());
    for (const LidarRow& row : rows_) key_frames_[row.sample] += row.scan.is_key_frame ? 1U : 0U;
    for (LidarRow& row : rows_) {
      if (!row.has_pose) {
        throw DataError(folder_ / "ego_pose.json", "has no pose of " + row.scan.file.string(),
                        "the one that sample_data.json names");
      }
      if (row.scan.is_key_frame) row.scan.moving = boxes_of(row.sample);
      scenes_[scene_of_sample_[row.sample]].scans.push_back(std::move(row.scan));
    }
    for (NuscenesScene& scene : scenes_) {
      std::ranges::sort(scene.scans, {}, &NuscenesScan::stamp_ns);
      const auto twin = std::ranges::adjacent_find(scene.scans, {}, &NuscenesScan::stamp_ns);
      if (twin != scene.scans.end()) {
        throw DataError(folder_ / "sample_data.json",
                        fmt::format("{} and {} have one timestamp", twin->file.string(),
                                    std::next(twin)->file.string()),
                        "scans of LIDAR_TOP that follow each other");
      }
    }
    return {std::move(scenes_), has_annotations_};
  }

  fs::path folder_;
  std::unordered_map<std::string, Pose> mounts_;  ///< ego_from_sensor of calibrated LiDARs
  std::vector<NuscenesScene> scenes_;
  std::unordered_map<std::string, std::size_t> sample_of_token_;
  std::vector<std::size_t> scene_of_sample_;
  std::vector<LidarRow> rows_;
  std::unordered_multimap<std::string, std::size_t> rows_of_pose_;
  std::vector<std::vector<NuscenesBox>> boxes_;                          ///< by sample
  std::vector<std::size_t> key_frames_;                                  ///< by sample
  std::vector<std::unordered_map<std::string, std::size_t>> instances_;  ///< by scene
  bool has_annotations_ = false;
};

/// Says which tables lie in a folder, and that they are those of before.
std::string state_of_tables(const fs::path& folder) {
  std::string state = fs::absolute(folder).lexically_normal().string();
  for (const fs::path& file :
       {folder / "sample_data.json", folder / "ego_pose.json", folder / "sample_annotation.json"}) {
    std::error_code error;
    const auto written = fs::last_write_time(file, error).time_since_epoch().count();
    state += fmt::format("\n{} {}", fs::file_size(file, error), written);
  }
  return state;
}

}  // namespace

std::string nuscenes_object_token(std::uint32_t instance) {
  return fmt::format("{}{}", kWrittenObject, instance);
}

std::vector<std::string> missing_nuscenes_tables(const fs::path& folder) {
  std::vector<std::string> missing;
  for (const char* table : kNuscenesTables) {
    if (!is_there(folder / table)) missing.emplace_back(table);
  }
  return missing;
}

std::vector<std::string> nuscenes_scene_names(const fs::path& tables) {
  std::vector<std::string> names;
  std::unordered_set<std::string> known;
  read_nuscenes_table(tables / "scene.json", [&](const NuscenesRow& row) {
    const std::string& name = names.emplace_back(row.text("name"));
    if (known.insert(name).second) return;
    row.refuse(fmt::format("has the name {} of another row", mosbench::quoted(name)),
               "one row per scene");
  });
  return names;
}

std::shared_ptr<const NuscenesTables> read_nuscenes_tables(const fs::path& tables) {
  static std::mutex mutex;
  static std::map<std::string, std::weak_ptr<const NuscenesTables>> kept;
  const std::lock_guard lock(mutex);
  std::erase_if(kept, [](const auto& entry) { return entry.second.expired(); });
  std::weak_ptr<const NuscenesTables>& place = kept[state_of_tables(tables)];
  if (auto read = place.lock()) return read;
  auto read = std::make_shared<const NuscenesTables>(TableReader(tables).read());
  place = read;
  return read;
}

std::vector<std::uint32_t> nuscenes_truth(std::span<const Point> points,
                                          const Pose& map_from_sensor,
                                          std::span<const NuscenesBox> moving) {
  std::vector<std::uint32_t> truth(points.size(), kStaticLabel);
  if (moving.empty()) return truth;
  const PointsInBoxes boxes(points);
  for (const NuscenesBox& box : moving) {
    boxes.label(box.map_from_box.inverse() * map_from_sensor, box.half_size_m,
                kMovingLabel | (box.instance << 16U), truth);
  }
  return truth;
}

}  // namespace mosbench
