#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "datasets/simulator/scene.hpp"

namespace mosbench {

/// Parses a scene in JSON strictly: throws DataError "<file>: <path in the JSON>: ..." for an
/// unknown or repeated key (naming the nearest known one), a missing key, a wrong type, a value out
/// of range, and a route that cannot be followed.
Scene parse_scene(std::string_view text, const std::filesystem::path& file);
/// Formats every field of the scene, indented; `parse_scene` gives the same scene again, bit for
/// bit.
std::string format_scene(const Scene& scene);

Scene read_scene(const std::filesystem::path& file);

}  // namespace mosbench
