#include "eval/results/reading_json.hpp"

#include <fmt/format.h>

#include "datasets/files/errors.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

/// Puts the member `key`, where there is one, into `option` by way of `named`.
template <typename Option, typename Named>
void take_word(const ordered_json& json, const char* key, Option& option, Named&& named) {
  if (!json.contains(key)) return;
  const std::string word = json.at(key);
  const auto value = named(word);
  if (!value) throw UsageError(fmt::format("{}: '{}' is not known", key, word));
  option = *value;
}

template <typename Value, typename Option>
void take(const ordered_json& json, const char* key, Option& option) {
  if (json.contains(key)) option = json.at(key).get<Value>();
}

void take_bin_columns(const ordered_json& json, ReadingOptions& options) {
  if (!json.contains("bin_columns")) return;
  const ordered_json& columns = json.at("bin_columns");
  if (columns != 4 && columns != 5) {
    throw UsageError(fmt::format("bin_columns: {}, expected 4 or 5", columns.dump()));
  }
  options.bin_columns = columns.get<std::size_t>();
}

}  // namespace

std::optional<PoseFrame> pose_frame_named(std::string_view word) {
  if (word == "lidar") return PoseFrame::kLidar;
  if (word == "camera") return PoseFrame::kCamera;
  return std::nullopt;
}

std::optional<bool> poses_inverse_named(std::string_view word) {
  if (word == "sensor-from-map") return true;
  if (word == "map-from-sensor") return false;
  return std::nullopt;
}

ordered_json told_json(const ReadingOptions& options) {
  ordered_json json = ordered_json::object();
  if (options.poses) json["poses"] = std::filesystem::absolute(*options.poses).string();
  if (options.poses_by_odometry) json["odometry"] = true;
  if (options.pose_format) json["pose_format"] = std::string(to_string(*options.pose_format));
  if (options.pose_frame != PoseFrame::kByCalib) {
    json["pose_frame"] = options.pose_frame == PoseFrame::kCamera ? "camera" : "lidar";
  }
  if (options.poses_inverse) {
    json["pose_direction"] = *options.poses_inverse ? "sensor-from-map" : "map-from-sensor";
  }
  if (options.topic) json["topic"] = *options.topic;
  if (options.map_frame) json["map_frame"] = *options.map_frame;
  const ReadingOptions usual;
  if (options.undistort != usual.undistort) json["raw_scans"] = !options.undistort;
  if (options.bin_columns != usual.bin_columns) json["bin_columns"] = options.bin_columns;
  return json;
}

ReadingOptions told_from_json(const ordered_json& json) {
  ReadingOptions options;
  take<std::string>(json, "poses", options.poses);
  options.poses_by_odometry = json.value("odometry", false);
  take_word(json, "pose_format", options.pose_format, pose_format_from_string);
  take_word(json, "pose_frame", options.pose_frame, pose_frame_named);
  take_word(json, "pose_direction", options.poses_inverse, poses_inverse_named);
  take<std::string>(json, "topic", options.topic);
  take<std::string>(json, "map_frame", options.map_frame);
  options.undistort = !json.value("raw_scans", false);
  take_bin_columns(json, options);
  return options;
}

ordered_json to_json(const ReadingStatement& reading) {
  ordered_json json = ordered_json::object();
  for (const auto& [what, how] : reading) json[what] = how;
  return json;
}

}  // namespace mosbench
