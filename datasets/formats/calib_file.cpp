#include "datasets/formats/calib_file.hpp"

#include <optional>

#include "datasets/disk/files.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

constexpr std::string_view kKey = "Tr:";

}  // namespace

Pose parse_calib(std::string_view text, const std::filesystem::path& file) {
  std::optional<Pose> camera_from_lidar;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const auto end = text.find('\n');
    const std::string_view line = trim(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (!line.starts_with(kKey)) continue;
    if (camera_from_lidar) throw DataError(file, number, "a second line \"Tr:\"", "one");
    camera_from_lidar = parse_pose_row(line.substr(kKey.size()), file, number);
  }
  if (!camera_from_lidar) {
    throw DataError(file, "has no line \"Tr:\"",
                    "\"Tr:\" and the 12 numbers of camera_from_lidar (identity when the poses are "
                    "those of the lidar)");
  }
  return *camera_from_lidar;
}

std::string format_calib(const Pose& camera_from_lidar) {
  std::string text;
  for (const char* camera : {"P0: ", "P1: ", "P2: ", "P3: "}) {
    text += camera + format_pose_row(Pose::Identity()) + '\n';
  }
  return text + "Tr: " + format_pose_row(camera_from_lidar) + '\n';
}

bool is_identity(const Pose& pose) { return pose.matrix() == Pose::Identity().matrix(); }

Pose lidar_pose(const Pose& pose, const Pose& camera_from_lidar) {
  if (is_identity(camera_from_lidar)) return pose;
  // The general inverse: published Tr have rounded rotations, whose transpose is not their inverse.
  return Pose(camera_from_lidar.inverse(Eigen::Affine) * pose * camera_from_lidar);
}

Pose read_calib(const std::filesystem::path& file) { return parse_calib(read_file(file), file); }

void write_calib(const std::filesystem::path& file, const Pose& camera_from_lidar) {
  write_file_atomic(file, format_calib(camera_from_lidar));
}

}  // namespace mosbench
