#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "datasets/simulator/scene.hpp"

namespace mosbench {

/// A scene in JSON. Strict: throws DataError "<file>: <path in the JSON>: ..." for an unknown or
/// repeated key (naming the nearest known one), a missing key, a wrong type, a value out of range,
/// and a route that cannot be walked.
Scene parse_scene(std::string_view text, const std::filesystem::path& file);
/// Every field of the scene, indented; `parse_scene` gives the same scene back, bit for bit.
std::string format_scene(const Scene& scene);

Scene read_scene(const std::filesystem::path& file);

/// A short scene that shows every kind of record, to start one's own from.
std::string example_scene_json();

}  // namespace mosbench
