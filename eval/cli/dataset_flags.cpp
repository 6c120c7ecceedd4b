#include "eval/cli/dataset_flags.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <functional>

#include "datasets/perturb/perturbation.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/engine/run_plan.hpp"
#include "eval/results/reading_json.hpp"

namespace mosbench {
namespace {

/// Adds an option whose text is one of `names`; `take` puts it in its place.
void add_choice(CLI::App& command, const std::string& flag, const std::vector<std::string>& names,
                const std::string& description, std::function<void(const std::string&)> take) {
  command.add_option_function<std::string>(flag, std::move(take), description)
      ->check(CLI::IsMember(names))
      ->group(kReadingGroup);
}

void add_pose_flags(CLI::App& command, ReadingOptions& options) {
  command
      .add_option(
          "--poses", options.poses,
          "Pose file to take instead of the sequence's own, or a folder with one per sequence")
      ->type_name("FILE")
      ->group(kReadingGroup);
  add_choice(
      command, "--pose-format", {"kitti", "tum", "dynablox"},
      "Rows of 12 numbers, stamped rows with a quaternion, or Dynablox's rollout CSV (default: "
      "recognised)",
      [&](const std::string& name) { options.pose_format = pose_format_from_string(name); });
  add_choice(command, "--pose-frame", {"lidar", "camera"},
             "Sensor that the poses are of; Tr of calib.txt turns those of the camera into the "
             "lidar's (default: camera if calib.txt has a Tr and the poses are KITTI rows, unless "
             "`mosbench odometry` wrote them)",
             [&](const std::string& name) { options.pose_frame = pose_frame_named(name).value(); });
  add_choice(command, "--pose-direction", {"map-from-sensor", "sensor-from-map"},
             "sensor-from-map poses are inverted (default: sensor-from-map for dynablox only)",
             [&](const std::string& name) { options.poses_inverse = poses_inverse_named(name); });
  command
      .add_option("--max-pose-gap-s", options.max_pose_gap_s,
                  "Scans between stamped poses farther apart are left out")
      ->type_name("SECONDS")
      ->check([](const std::string& text) {
        const auto gap_s = parse_double(text);
        return gap_s && *gap_s >= 0.0 ? "" : text + " is no time, expected seconds";
      })
      ->capture_default_str()
      ->group(kReadingGroup);
}

void add_deskew_flags(CLI::App& command, ReadingOptions& options) {
  add_choice(command, "--point-times", {"column", "azimuth"},
             "When points were measured: fifth column of .bin files, in seconds after the stamp, a "
             "field of .pcd and .ply files, or "
             "azimuth as KITTI's sensor turns (default: what a bag says)",
             [&](const std::string& name) { options.point_times = point_times_named(name); });
  add_choice(command, "--deskew", {"none", "velocity", "poses"},
             "Move points that have times to where the sensor saw them at the stamp, by the motion "
             "since the scan before or by the poses around (default: poses; to register scans: "
             "velocity)",
             [&](const std::string& name) { options.deskew = deskew_named(name); });
  command
      .add_flag_callback(
          "--raw-scans", [&] { options.deskew = Deskew::kNone; }, "The same as --deskew none")
      ->excludes("--deskew")
      ->group(kReadingGroup);
}

void add_scan_flags(CLI::App& command, ReadingOptions& options) {
  command.add_option("--topic", options.topic, "PointCloud2 topic of a bag")
      ->type_name("TOPIC")
      ->group(kReadingGroup);
  command.add_option("--map-frame", options.map_frame, "Map frame in the tf tree of a bag")
      ->type_name("FRAME")
      ->group(kReadingGroup);
  command
      .add_option("--pose-topic", options.pose_topic, "Topic of poses of a bag (default: found)")
      ->type_name("TOPIC")
      ->group(kReadingGroup);
  add_deskew_flags(command, options);
  command
      .add_option(
          "--bin-columns", options.bin_columns,
          "float32 per point in .bin files: 4, 3 (no intensity), 5 (ring of nuScenes, times) or "
          "more (default: 4, and files that clearly hold others are refused)")
      ->check(CLI::IsMember({3, 4, 5, 6, 7}))
      ->group(kReadingGroup);
  command
      .add_option("--moving-speed-m-s", options.moving_speed_m_s,
                  "Speed from which on points of truth by flow or boxes move: opensceneflow, "
                  "kitti-raw, kitti-tracking (default: 0.5)")
      ->type_name("M/S")
      ->check([](const std::string& text) {
        const auto speed_m_s = parse_double(text);
        return speed_m_s && *speed_m_s > 0.0 ? "" : text + " is no speed, expected m/s above 0";
      })
      ->group(kReadingGroup);
  command
      .add_flag("--hdl64-correction", options.hdl64_correction,
                "Raise points by the 0.205 degrees that KITTI's calibration of its HDL-64E misses")
      ->group(kReadingGroup);
  add_perturb_flag(command, options.perturb, "Disturb what is read")->group(kReadingGroup);
}

void add_reading_flags(CLI::App& command, ReadingOptions& options) {
  add_scan_flags(command, options);
  add_pose_flags(command, options);
}

}  // namespace

void add_dataset_flags(CLI::App& command, std::filesystem::path& input, std::string& dataset,
                       std::vector<std::string>& sequences, ReadingOptions& reading) {
  add_scan_dataset_flags(command, input, dataset, sequences, reading);
  add_pose_flags(command, reading);
}

void add_scan_dataset_flags(CLI::App& command, std::filesystem::path& input, std::string& dataset,
                            std::vector<std::string>& sequences, ReadingOptions& reading) {
  command
      .add_option("DATA", input,
                  "Root of a data set, one sequence folder, a bag, a scan, or a folder of them")
      ->type_name("DIR")
      ->required();
  add_dataset_kind_flag(command, dataset);
  command.add_option("--sequences", sequences, "Only these sequences, a,b (default: all)")
      ->type_name("NAMES")
      ->delimiter(',')
      ->allow_extra_args(false);
  add_scan_flags(command, reading);
}

CLI::Option* add_perturb_flag(CLI::App& command, std::optional<std::string>& perturb,
                              const std::string& description) {
  return command
      .add_option_function<std::string>(
          "--perturb",
          [&](const std::string& text) { perturb = to_string(parse_perturbation(text)); },
          description + ", in this order, see `mosbench list perturbations`")
      ->type_name("KIND=STRENGTH,...,seed=N");
}

bool chooses_scans(const CLI::Option& option) {
  std::filesystem::path input;
  std::string dataset;
  std::vector<std::string> sequences;
  ReadingOptions reading;
  CLI::App command;
  add_scan_dataset_flags(command, input, dataset, sequences, reading);
  return command.get_option_no_throw(option.get_name()) != nullptr;
}

std::vector<std::string> reading_names() {
  ReadingOptions reading;
  CLI::App command;
  add_reading_flags(command, reading);
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_group() != kReadingGroup) continue;
    std::string& name = names.emplace_back(option->get_name().substr(2));
    std::ranges::replace(name, '-', '_');
  }
  return names;
}

ReadingOptions reading_of(std::vector<std::string> flags) {
  ReadingOptions reading;
  CLI::App command;
  add_reading_flags(command, reading);
  std::ranges::reverse(flags);  // as CLI11 expects them
  try {
    command.parse(std::move(flags));
  } catch (const CLI::ParseError& error) {
    throw UsageError(error.what());
  }
  return reading;
}

void add_dataset_kind_flag(CLI::App& command, std::string& dataset) {
  command.add_option("--dataset", dataset, "Layout of DATA: auto, " + dataset_kind_names())
      ->type_name("DATASET")
      ->capture_default_str();
}

void add_threads_flag(CLI::App& command, unsigned& threads) {
  command.add_option("--threads", threads, "Threads; results do not depend on it (default: all)")
      ->check(CLI::Range(1U, 1024U));
}

}  // namespace mosbench
