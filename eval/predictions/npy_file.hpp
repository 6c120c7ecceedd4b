#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

namespace mosbench {

/// Parses confidences 0..1 per point from the bytes of a NumPy .npy file (float32, float64 or
/// bool, of any shape with as many numbers as the scan has points): above 0.5 a point is moving,
/// as in 4DMOS's confidences_to_labels.py. Throws DataError.
std::vector<std::uint32_t> parse_npy_labels(std::string_view bytes, std::size_t point_count,
                                            const std::filesystem::path& file);

std::vector<std::uint32_t> read_npy_labels(const std::filesystem::path& file,
                                           std::size_t point_count);

}  // namespace mosbench
