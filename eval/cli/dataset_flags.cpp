#include "eval/cli/dataset_flags.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <sstream>

#include "datasets/formats/bin_columns.hpp"
#include "datasets/perturb/perturbation.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/nearest_name.hpp"
#include "datasets/text/text.hpp"
#include "eval/cli/help_text.hpp"
#include "eval/engine/run_plan.hpp"
#include "eval/result/reading_json.hpp"

namespace mosbench {
namespace {

/// Adds an option whose text is one of `names`; `take` puts it in its place.
void add_choice(CLI::App& command, const std::string& flag, const std::vector<std::string>& names,
                const std::string& description, std::function<void(const std::string&)> take) {
  command.add_option_function<std::string>(flag, std::move(take), description)
      ->check(CLI::IsMember(names))
      ->group(kReadingGroup);
}

/// One of the rare ways to read data, a KEY of --read.
struct ReadKey {
  std::string_view name, legal, meaning;
  bool (*take)(ReadingOptions& options, const std::string& value);  ///< false for an illegal value
};

template <typename Option, typename Value>
bool put(Option& option, const std::optional<Value>& value) {
  if (value) option = *value;
  return value.has_value();
}

bool put_text(std::optional<std::string>& option, const std::string& text) {
  return put(option, text.empty() ? std::nullopt : std::optional(text));
}

std::optional<double> number_from(const std::string& text, double least) {
  const auto number = parse_double(text);
  return number && *number >= least ? number : std::nullopt;
}

std::optional<std::size_t> bin_columns_named(const std::string& text) {
  const auto number = parse_double(text);
  for (std::size_t columns = kFewestBinColumns; columns <= kMostBinColumns; ++columns) {
    if (number && *number == static_cast<double>(columns)) return columns;
  }
  return std::nullopt;
}

std::optional<bool> switch_named(const std::string& text) {
  if (text == "on" || text == "true") return true;
  return text == "off" || text == "false" ? std::optional(false) : std::nullopt;
}

constexpr std::array kReadKeys = {
    ReadKey{"pose_format", "kitti, tum or dynablox",
            "rows of 12 numbers, stamped rows with a quaternion, or Dynablox's rollout CSV "
            "(default: recognised)",
            [](ReadingOptions& o, const std::string& t) {
              return put(o.pose_format, pose_format_from_string(t));
            }},
    ReadKey{"pose_frame", "lidar or camera",
            "sensor of the poses; Tr of calib.txt turns the camera's into the lidar's (default: "
            "camera if calib.txt has a Tr and the poses are KITTI rows, unless `mosbench odometry` "
            "wrote them)",
            [](ReadingOptions& o, const std::string& t) {
              return put(o.pose_frame, pose_frame_named(t));
            }},
    ReadKey{"pose_direction", "map-from-sensor or sensor-from-map",
            "sensor-from-map poses are inverted (default: for dynablox only)",
            [](ReadingOptions& o, const std::string& t) {
              return put(o.poses_inverse, poses_inverse_named(t));
            }},
    ReadKey{"max_pose_gap_s", "0 or more",
            "scans between stamped poses farther apart are left out (default: 0.5)",
            [](ReadingOptions& o, const std::string& t) {
              return put(o.max_pose_gap_s, number_from(t, 0.0));
            }},
    ReadKey{"map_frame", "a frame", "map frame in the tf tree of a bag",
            [](ReadingOptions& o, const std::string& t) { return put_text(o.map_frame, t); }},
    ReadKey{"pose_topic", "a topic", "topic of poses of a bag (default: found)",
            [](ReadingOptions& o, const std::string& t) { return put_text(o.pose_topic, t); }},
    ReadKey{"bin_columns", "3 to 7",
            "float32 per point in .bin files: 3 (no intensity), 4, 5 (ring of nuScenes, times) or "
            "more (default: 4; files that clearly hold others are refused)",
            [](ReadingOptions& o, const std::string& t) {
              return put(o.bin_columns, bin_columns_named(t));
            }},
    ReadKey{"moving_speed_m_s", "above 0",
            "from this speed on points move, where truth is a flow or boxes: opensceneflow, "
            "kitti-raw, kitti-tracking (default: 0.5)",
            [](ReadingOptions& o, const std::string& t) {
              return put(o.moving_speed_m_s, number_from(t, std::numeric_limits<double>::min()));
            }},
    ReadKey{"hdl64_correction", "on or off",
            "points are raised by the 0.205 degrees that KITTI's calibration of its HDL-64E misses",
            [](ReadingOptions& o, const std::string& t) {
              return put(o.hdl64_correction, switch_named(t));
            }},
};

/// Takes "pose_frame=camera,bin_columns=5". Throws UsageError naming the key.
void take_read_keys(ReadingOptions& options, const std::string& text) {
  for (const auto& [key, value] : key_values("--read", text)) {
    const auto row = std::ranges::find(kReadKeys, key, &ReadKey::name);
    if (row == kReadKeys.end()) {
      const std::vector<std::string_view> names = read_keys();
      throw UsageError(fmt::format("--read {}: is not known, expected one of {} (nearest: {})", key,
                                   fmt::join(names, ", "), nearest_name(key, names)));
    }
    if (row->take(options, value)) continue;
    throw UsageError(
        fmt::format("--read {}: '{}' is not legal, expected {}", key, value, row->legal));
  }
}

void add_reading_flags(CLI::App& command, ReadingOptions& options) {
  command.add_option("--topic", options.topic, "PointCloud2 topic of a bag")
      ->type_name("TOPIC")
      ->group(kReadingGroup);
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
  add_perturb_flag(command, options.perturb, "Disturb what is read")->group(kReadingGroup);
  command
      .add_option_function<std::vector<std::string>>(
          "--read",
          [&options](const std::vector<std::string>& texts) {
            for (const std::string& text : texts) take_read_keys(options, text);
          },
          "What is rarely to be said about the files; the keys stand below")
      ->type_name("KEY=VALUE,...")
      ->allow_extra_args(false)
      ->group(kReadingGroup);
}

void add_poses_flag(CLI::App& command, ReadingOptions& options) {
  command
      .add_option(
          "--poses", options.poses,
          "Pose file to take instead of the sequence's own, or a folder with one per sequence")
      ->type_name("FILE");
}

}  // namespace

void add_dataset_flags(CLI::App& command, std::filesystem::path& input, std::string& dataset,
                       std::vector<std::string>& sequences, ReadingOptions& reading,
                       const char* name) {
  add_scan_dataset_flags(command, input, dataset, sequences, reading, name);
  add_poses_flag(command, reading);
}

void add_scan_dataset_flags(CLI::App& command, std::filesystem::path& input, std::string& dataset,
                            std::vector<std::string>& sequences, ReadingOptions& reading,
                            const char* name) {
  command
      .add_option(
          name, input,
          std::string_view(name) == "RUN"
              ? "Folder that `mosbench run` or `mosbench score` "
                "wrote, or a result.json"
              : "Root of a data set, one sequence folder, a bag, a scan, or a folder of them")
      ->type_name("DIR")
      ->required();
  add_dataset_kind_flag(command, dataset);
  command.add_option("--sequences", sequences, "Only these sequences, a,b (default: all)")
      ->type_name("NAMES")
      ->delimiter(',')
      ->allow_extra_args(false);
  add_reading_flags(command, reading);
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

std::vector<std::string_view> read_keys() {
  std::vector<std::string_view> names;
  for (const ReadKey& key : kReadKeys) names.push_back(key.name);
  return names;
}

std::vector<std::pair<std::string, std::string>> key_values(std::string_view flag,
                                                            const std::string& text) {
  std::vector<std::pair<std::string, std::string>> pairs;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const std::size_t equals = part.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw UsageError(fmt::format("{}: '{}' has no value, expected key=value", flag, part));
    }
    pairs.emplace_back(part.substr(0, equals), part.substr(equals + 1));
  }
  return pairs;
}

std::vector<std::string> reading_names() {
  ReadingOptions reading;
  CLI::App command;
  add_reading_flags(command, reading);
  add_poses_flag(command, reading);
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    if ((option->get_group() != kReadingGroup && option->get_name() != "--poses") ||
        option->get_name() == "--read")
      continue;
    std::string& name = names.emplace_back(option->get_name().substr(2));
    std::ranges::replace(name, '-', '_');
  }
  for (const std::string_view key : read_keys()) names.emplace_back(key);
  return names;
}

std::string read_keys_text() {
  std::string text = "Keys of --read:\n";
  for (const ReadKey& key : kReadKeys) {
    text += help_row(std::string(key.name), fmt::format("{}; {}", key.legal, key.meaning));
  }
  return text;
}

ReadingOptions reading_of(std::vector<std::string> flags) {
  ReadingOptions reading;
  CLI::App command;
  add_reading_flags(command, reading);
  add_poses_flag(command, reading);
  std::ranges::reverse(flags);  // as CLI11 expects them
  try {
    command.parse(std::move(flags));
  } catch (const CLI::ParseError& error) {
    throw UsageError(error.what());
  }
  return reading;
}

void add_dataset_kind_flag(CLI::App& command, std::string& dataset) {
  command.add_option("--dataset", dataset, "Layout of DATA, see `mosbench list datasets`")
      ->type_name("DATASET")
      ->capture_default_str();
}

void add_threads_flag(CLI::App& command, unsigned& threads) {
  command.add_option("--threads", threads, "Threads; results do not depend on it (default: all)")
      ->check(CLI::Range(1U, 1024U));
}

}  // namespace mosbench
