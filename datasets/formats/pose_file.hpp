#pragma once

#include <cstddef>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

/// Largest element of |R^T R - I| that counts as a rotation. Files with 6 significant digits stay
/// below 1e-5 and chains of float32 products below 1e-4; a wrong column order or a scale is far
/// above.
inline constexpr double kRotationTolerance = 1e-3;

/// Parses poses in KITTI's form: a row-major 3x4 matrix in 12 numbers per line, metres, kept bit
/// for bit as parsed to double. Throws DataError with the line for another count of numbers, text,
/// numbers that are not finite, and a rotation part that is no rotation.
std::vector<Pose> parse_poses(std::string_view text, const std::filesystem::path& file);
/// Formats with the shortest decimals that read back as the same doubles.
std::string format_poses(std::span<const Pose> poses);

/// Parses one row of 12 numbers; `line` (from 1) is for the error.
Pose parse_pose_row(std::string_view row, const std::filesystem::path& file, std::size_t line);
std::string format_pose_row(const Pose& pose);

std::vector<Pose> read_poses(const std::filesystem::path& file);
void write_poses(const std::filesystem::path& file, std::span<const Pose> poses);

}  // namespace mosbench
