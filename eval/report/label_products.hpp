#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "eval/breakdown/object_tracks.hpp"
#include "eval/result/result_scans.hpp"

namespace mosbench {

/// Scans before and after one that decide its boxes' numbers and speeds: a second at 10 Hz.
inline constexpr std::size_t kScansAroundBoxes = 10;

/// Returns the boxes of the moving objects that the labels of a result show in the scans at
/// `wanted`, which rise; a scan without labels has none. Numbers and speeds come from the scans
/// around, which are read, too. Throws DataError.
std::vector<std::vector<MovingBox>> boxes_of(const ResultScans& scans,
                                             const std::vector<std::size_t>& wanted);

/// The same for the page: per scan a list of boxes, each [x, y, z, yaw, length, width, height,
/// speed] in the sensor's frame, metres and radians, to 0.01; the speed in m/s to 0.001, null
/// for an object seen once.
nlohmann::ordered_json boxes_json(const ResultScans& scans, const std::vector<std::size_t>& wanted);

/// The files that `mosbench run --write` can write beside the labels.
std::vector<std::string> product_names();

/// Writes products of a finished sequence of `mosbench run` into its folder, in the formats of
/// docs/formats/files.md. Each file appears whole; those that are there as they were written are
/// kept. Throws DataError, and UsageError for one that was changed since.
void write_products(const std::filesystem::path& folder, std::span<const std::string> names);

}  // namespace mosbench
