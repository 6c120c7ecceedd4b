#include "datasets/formats/pose_file.hpp"

#include <fmt/format.h>

#include <Eigen/LU>

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

constexpr int kRows = 3;
constexpr int kColumns = 4;
constexpr std::size_t kNumbers = 12;

void check_rotation(const Eigen::Matrix3d& rotation, const std::filesystem::path& file,
                    std::size_t line) {
  const Eigen::Matrix3d deviation =
      (rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).cwiseAbs();
  // Element by element, so that an overflow to NaN is refused as well.
  if (!(deviation.array() <= kRotationTolerance).all()) {
    throw DataError(file, line,
                    fmt::format("rotation is not orthonormal, R^T R differs from the identity by "
                                "{:.3g}",
                                deviation.maxCoeff()),
                    fmt::format("at most {} (12 numbers, row-major 3x4)", kRotationTolerance));
  }
  if (rotation.determinant() < 0.0) {
    throw DataError(file, line, "rotation mirrors, its determinant is -1", "determinant +1");
  }
}

}  // namespace

Pose parse_pose_row(std::string_view row, const std::filesystem::path& file, std::size_t line) {
  const auto numbers = split_at_blanks(row);
  if (numbers.size() != kNumbers) {
    throw DataError(file, line, fmt::format("{} numbers in the row", numbers.size()),
                    "12 (row-major 3x4 matrix)");
  }
  Pose pose = Pose::Identity();
  for (int r = 0; r < kRows; ++r) {
    for (int c = 0; c < kColumns; ++c) {
      const std::string_view number = numbers[static_cast<std::size_t>(r * kColumns + c)];
      const auto value = parse_double(number);
      if (!value) {
        throw DataError(file, line, quoted(number) + " is no finite number",
                        "12 numbers separated by blanks");
      }
      pose.matrix()(r, c) = *value;
    }
  }
  check_rotation(pose.linear(), file, line);
  return pose;
}

std::string format_pose_row(const Pose& pose) {
  std::string row;
  for (int r = 0; r < kRows; ++r) {
    for (int c = 0; c < kColumns; ++c) {
      if (!row.empty()) row += ' ';
      row += fmt::format("{}", pose.matrix()(r, c));
    }
  }
  return row;
}

std::vector<Pose> parse_poses(std::string_view text, const std::filesystem::path& file) {
  std::vector<Pose> poses;
  for (const TextLine& line : split_lines(text, file)) {
    poses.push_back(parse_pose_row(line.text, file, line.number));
  }
  return poses;
}

std::string format_poses(std::span<const Pose> poses) {
  std::string text;
  for (const Pose& pose : poses) text += format_pose_row(pose) + '\n';
  return text;
}

std::vector<Pose> read_poses(const std::filesystem::path& file) {
  return parse_poses(read_file(file), file);
}

void write_poses(const std::filesystem::path& file, std::span<const Pose> poses) {
  write_file_atomic(file, format_poses(poses));
}

}  // namespace mosbench
