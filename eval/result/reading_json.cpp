#include "eval/result/reading_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "datasets/formats/bin_columns.hpp"
#include "datasets/sequence/scan_deskewer.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/shell_text.hpp"

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
  if (!columns.is_number_unsigned() || columns < kFewestBinColumns || columns > kMostBinColumns) {
    throw UsageError(fmt::format("bin_columns: {}, expected {} to {}", columns.dump(),
                                 kFewestBinColumns, kMostBinColumns));
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

std::optional<Deskew> deskew_named(std::string_view word) {
  for (const Deskew deskew : {Deskew::kNone, Deskew::kVelocity, Deskew::kPoses}) {
    if (to_string(deskew) == word) return deskew;
  }
  return std::nullopt;
}

std::optional<PointTimes> point_times_named(std::string_view word) {
  if (word == "column") return PointTimes::kColumn;
  if (word == "azimuth") return PointTimes::kAzimuth;
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
  const ReadingOptions usual;
  if (options.max_pose_gap_s != usual.max_pose_gap_s) {
    json["max_pose_gap_s"] = options.max_pose_gap_s;
  }
  if (options.topic) json["topic"] = *options.topic;
  if (options.map_frame) json["map_frame"] = *options.map_frame;
  if (options.pose_topic) json["pose_topic"] = *options.pose_topic;
  if (options.deskew) json["deskew"] = std::string(to_string(*options.deskew));
  if (options.point_times) {
    json["point_times"] = options.point_times == PointTimes::kColumn ? "column" : "azimuth";
  }
  if (options.moving_speed_m_s) json["moving_speed_m_s"] = *options.moving_speed_m_s;
  if (options.bin_columns) json["bin_columns"] = *options.bin_columns;
  if (options.hdl64_correction) json["hdl64_correction"] = true;
  if (options.perturb) json["perturb"] = *options.perturb;
  return json;
}

ReadingOptions told_from_json(const ordered_json& json) {
  ReadingOptions options;
  take<std::string>(json, "poses", options.poses);
  options.poses_by_odometry = json.value("odometry", false);
  take_word(json, "pose_format", options.pose_format, pose_format_from_string);
  take_word(json, "pose_frame", options.pose_frame, pose_frame_named);
  take_word(json, "pose_direction", options.poses_inverse, poses_inverse_named);
  take<double>(json, "max_pose_gap_s", options.max_pose_gap_s);
  take<std::string>(json, "topic", options.topic);
  take<std::string>(json, "map_frame", options.map_frame);
  take<std::string>(json, "pose_topic", options.pose_topic);
  if (json.value("raw_scans", false)) options.deskew = Deskew::kNone;  // of earlier results
  take_word(json, "deskew", options.deskew, deskew_named);
  take_word(json, "point_times", options.point_times, point_times_named);
  take_bin_columns(json, options);
  take<double>(json, "moving_speed_m_s", options.moving_speed_m_s);
  options.hdl64_correction = json.value("hdl64_correction", false);
  take<std::string>(json, "perturb", options.perturb);
  return options;
}

std::string told_flags(const ReadingOptions& options) {
  ordered_json told = told_json(options);
  if (options.poses) told["poses"] = options.poses->string();
  told.erase("odometry");
  constexpr std::array kFlags = {"poses", "topic", "deskew", "point_times", "perturb"};
  std::string flags, rare;
  for (const auto& [key, value] : told.items()) {
    const std::string word = value.is_string() ? value.get<std::string>() : value.dump();
    if (std::ranges::find(kFlags, key) == kFlags.end()) {
      rare += fmt::format("{}{}={}", rare.empty() ? "" : ",", key, word == "true" ? "on" : word);
      continue;
    }
    std::string flag = key;
    std::ranges::replace(flag, '_', '-');
    flags += fmt::format(" --{} {}", flag, shell_word(word));
  }
  return rare.empty() ? flags : fmt::format("{} --read {}", flags, shell_word(rare));
}

ordered_json to_json(const ReadingStatement& reading) {
  ordered_json json = ordered_json::object();
  for (const auto& [what, how] : reading) json[what] = how;
  return json;
}

}  // namespace mosbench
