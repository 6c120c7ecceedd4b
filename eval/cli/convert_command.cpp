#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <memory>
#include <optional>

#include "core/base/thread_pool.hpp"
#include "datasets/doctor/doctor.hpp"
#include "datasets/layouts/convert.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/flags.hpp"
#include "eval/engine/pose_finding.hpp"
#include "eval/result/result.hpp"
#include "eval/result/tell.hpp"

namespace mosbench {
namespace {

constexpr std::array<std::string_view, 12> kLayouts = {
    "doals",    "doals-bag", "sipailou",  "helimos",        "semantickitti", "opensceneflow",
    "nuscenes", "helipr",    "kitti-raw", "kitti-tracking", "ros2-mcap",     "ros2-db3"};
constexpr std::array<std::string_view, 4> kCompressions = {"none", "lz4", "bz2", "zstd"};

struct ConvertFlags : DataWords {
  std::string layout;
  OdometryOptions odometry;
  ConvertOptions conversion;
  unsigned threads = hardware_threads();
  bool check = false;
};

/// Takes "semantickitti" or, of bags, "ros2-mcap:zstd". Returns the name without compression.
std::string set_layout(const std::string& text, ConvertOptions& conversion) {
  const std::size_t colon = text.find(':');
  const std::string name = text.substr(0, colon);
  if (std::ranges::find(kLayouts, name) == kLayouts.end()) {
    throw UsageError(fmt::format("--layout: '{}' is not known, expected one of {} (nearest: {})",
                                 name, fmt::join(kLayouts, ", "), nearest_name(name, kLayouts)));
  }
  conversion.writing.bag = name == "doals-bag"   ? BagKind::kRos1
                           : name == "ros2-mcap" ? BagKind::kMcap
                           : name == "ros2-db3"  ? BagKind::kDb3
                                                 : BagKind::kNone;
  if (conversion.writing.bag == BagKind::kNone) {
    conversion.layout = *dataset_kind_from_string(name);
  } else {
    conversion.layout = name == "doals-bag" ? DatasetKind::kDoals : DatasetKind::kRecording;
  }
  // SQLite has no chunks that lz4 could pack.
  conversion.writing.compression = name == "ros2-db3" ? "none" : "lz4";
  if (colon == std::string::npos) return name;
  conversion.writing.compression = text.substr(colon + 1);
  if (std::ranges::find(kCompressions, conversion.writing.compression) == kCompressions.end()) {
    throw UsageError(fmt::format("--layout {}: the compression is not known, expected one of {}",
                                 text, fmt::join(kCompressions, ", ")));
  }
  return name;
}

/// A flow has no threshold: who reads it chooses one.
void check_kept_speed(const ConvertFlags& options, DatasetKind source) {
  constexpr auto kFlow = DatasetKind::kOpenSceneFlow;
  if (!options.reading.moving_speed_m_s) return;
  if (source != kFlow || options.conversion.layout != kFlow) return;
  throw UsageError(
      "--moving-speed-m-s: layout opensceneflow keeps the flow and not what was moving by it, "
      "expected the flag where the converted files are read");
}

/// Returns what would be written.
Answer plan_answer(const Dataset& dataset, bool has_poses) {
  Sheet sheet{.columns = {{"sequence", Unit::kText}, {"what", Unit::kText}, {"how", Unit::kText}}};
  for (const auto& sequence : dataset.sequences) {
    for (const auto& [what, how] : plan_of(*sequence)) {
      sheet.rows.push_back({sequence->name(), what, how});
    }
  }
  return {.text = "nothing is written\n",
          .standing = has_poses ? standing_of(dataset) : Standing(),
          .sheets = {sheet}};
}

Answer convert_dataset(ConvertFlags options) {
  ConvertOptions& conversion = options.conversion;
  if (!options.check && (options.layout.empty() || conversion.out.empty())) {
    throw UsageError("--layout and --out: not both are given, expected them, or --check");
  }
  const std::string layout = options.layout.empty() ? "" : set_layout(options.layout, conversion);
  const std::optional<OdometryChoice> odometry = named_odometry(options.odometry, options.reading);
  if (odometry) options.reading.poses = ByOdometry{};
  Dataset dataset = open_dataset(options);
  check_kept_speed(options, dataset.kind);
  std::optional<OdometryChoice> choice;
  if (odometry) choice = with_filter(*odometry, dataset.kind);
  if (choice) expect_poses(dataset, *choice);
  conversion.before_sequence = [&dataset, &choice, &options](std::size_t i) {
    Sequence& sequence = *dataset.sequences[i];
    if (choice) set_poses(sequence, *choice, find_poses(sequence, *choice, options.threads));
    add_doubts_of_scans(dataset.kind, sequence, !choice);
  };
  if (options.check) return plan_answer(dataset, !odometry);
  std::optional<Progress> progress;
  std::size_t scans = 0;
  const auto count = [&](std::size_t done, std::size_t total) {
    if (!progress) progress.emplace("convert", total);
    progress->advance();
    scans = done;
  };
  for (const std::string& sentence : convert(dataset, conversion, count)) tell(sentence);
  return {.text = fmt::format("converted {} of {} to {} in {}\n", counted(scans, "scan"),
                              options.input.string(), layout, conversion.out.string()),
          .standing = standing_of(dataset)};
}

}  // namespace

CommandRun add_convert(CLI::App& command) {
  auto options = std::make_shared<ConvertFlags>();
  add_dataset_flags(command, *options);
  add(command, "--layout " + type_of_names({kLayouts.begin(), kLayouts.end()}), options->layout,
      "Layout to write; ros2-mcap:zstd also says how a bag is compressed: none, lz4, bz2 "
      "(ROS 1) or zstd (ROS 2) (default: lz4, of ros2-db3 none)");
  add(command, "--out DIR", options->conversion.out, "Root of the data set to write");
  command.add_flag("--check", options->check,
                   "Say what would be written of which scans, points and poses, and write nothing");
  add_odometry_flag(command, options->odometry, "Find the poses by it instead of reading them");
  add_threads_flag(command, options->threads);
  return [options] { return convert_dataset(*options); };
}

}  // namespace mosbench
