#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "datasets/sequence/reading_options.hpp"

namespace mosbench {

/// "lidar" or "camera", as --pose-frame takes them; nothing for other words.
std::optional<PoseFrame> pose_frame_named(std::string_view word);
/// Whether "sensor-from-map" or "map-from-sensor" was said to --pose-direction; nothing for other
/// words.
std::optional<bool> poses_inverse_named(std::string_view word);

/// "none", "velocity" or "poses" of --deskew, and "column" or "azimuth" of --point-times; nothing
/// for other words.
std::optional<Deskew> deskew_named(std::string_view word);
std::optional<PointTimes> point_times_named(std::string_view word);

/// The reading options that were given, named like the flags of `mosbench run`. A pose file's path
/// is absolute.
nlohmann::ordered_json told_json(const ReadingOptions& options);
/// Reads what `told_json` wrote, passing over other members. Throws UsageError for words that are
/// not known, a JSON exception for members of another type.
ReadingOptions told_from_json(const nlohmann::ordered_json& json);

/// The same as flags for a shell, each with a blank in front; a pose file's path is as given.
std::string told_flags(const ReadingOptions& options);

/// How a sequence was read, a member per statement.
nlohmann::ordered_json to_json(const ReadingStatement& reading);

}  // namespace mosbench
