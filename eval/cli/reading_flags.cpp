#include "eval/cli/reading_flags.hpp"

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "eval/results/reading_json.hpp"

namespace mosbench {
namespace {

constexpr const char* kGroup = "Reading";

/// An option whose text `take` puts in its place; the text was checked to be one of `names`.
void add_choice(CLI::App& command, const std::string& flag, const std::vector<std::string>& names,
                const std::string& description, std::function<void(const std::string&)> take) {
  command.add_option_function<std::string>(flag, std::move(take), description)
      ->check(CLI::IsMember(names))
      ->group(kGroup);
}

}  // namespace

void add_reading_flags(CLI::App& command, ReadingOptions& options) {
  command.add_option("--poses", options.poses, "Pose file instead of the sequence's own")
      ->group(kGroup);
  add_choice(
      command, "--pose-format", {"kitti", "tum", "dynablox"},
      "Rows of 12 numbers, stamped rows with quaternion, or Dynablox's rollout CSV (default: "
      "told from the file)",
      [&](const std::string& name) { options.pose_format = pose_format_from_string(name); });
  add_choice(command, "--pose-frame", {"lidar", "camera"},
             "Whose poses they are; the camera's are turned by Tr of calib.txt (default: the "
             "camera's when KITTI rows stand beside a Tr)",
             [&](const std::string& name) { options.pose_frame = pose_frame_named(name).value(); });
  add_choice(command, "--pose-direction", {"map-from-sensor", "sensor-from-map"},
             "The latter are inverted (default: sensor-from-map for dynablox only)",
             [&](const std::string& name) { options.poses_inverse = poses_inverse_named(name); });
  add_scan_flags(command, options);
}

void add_scan_flags(CLI::App& command, ReadingOptions& options) {
  command.add_option("--topic", options.topic, "PointCloud2 topic of a bag")->group(kGroup);
  command.add_option("--map-frame", options.map_frame, "Frame of a bag's tf tree to put scans in")
      ->group(kGroup);
  command
      .add_flag_callback(
          "--raw-scans", [&] { options.undistort = false; }, "Do not undistort the scans of a bag")
      ->group(kGroup);
  command
      .add_option("--bin-columns", options.bin_columns,
                  "float32 per point in .bin files: 4, or 5 as nuScenes has them")
      ->check(CLI::IsMember({4, 5}))
      ->group(kGroup);
}

}  // namespace mosbench
