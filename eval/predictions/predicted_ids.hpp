#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "eval/protocols/protocol.hpp"

namespace mosbench {

/// A label id in prediction files.
struct PredictedId {
  std::uint16_t id;
  std::uint64_t points;              ///< that have it, in all files
  std::filesystem::path first_file;  ///< that holds it
};

/// Reads every .label file and returns the ids in them in ascending order. Throws DataError naming
/// the first file that holds something else than little-endian uint32: big-endian numbers or
/// float32.
std::vector<PredictedId> ids_in(std::span<const std::filesystem::path> files);

/// Returns "0 (8,640 points), 251 (12 points)", of more than eight ids those of most points.
std::string ids_text(std::span<const PredictedId> ids);

/// Returns a remark if no point is predicted moving, or more than half of the points: methods find
/// few moving points, so the ids may have another meaning. Empty otherwise. `ids` are those of the
/// files, empty for formats without ids.
std::string strange_share(std::uint64_t moving, std::uint64_t points,
                          std::span<const PredictedId> ids, const Protocol& protocol);

}  // namespace mosbench
