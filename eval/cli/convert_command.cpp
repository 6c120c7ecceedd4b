#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "core/base/thread_pool.hpp"
#include "datasets/layouts/convert.hpp"
#include "datasets/text/counted.hpp"
#include "datasets/text/errors.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/dataset_flags.hpp"
#include "eval/cli/odometry_flags.hpp"
#include "eval/engine/run_plan.hpp"
#include "eval/results/progress.hpp"
#include "eval/results/tell.hpp"

namespace mosbench {
namespace {

constexpr const char* kConvertFooter =
    R"(Writes the scans, LiDAR poses, stamps and truth of DATA in another layout, for other programs.
Points keep their bits and their order. Truth becomes .label files with the ids of the source. In
the layouts of DOALS it becomes rows of indices.csv with the points of ids 251 to 259, and scans
without stamps get stamps 0.1 s apart. ROS 2 bags have the topics /points, where truth is the field
label, and /tf. OpenSceneFlow's .h5 files keep the flow of DATA; truth without speeds becomes the
array mos_label. As nuscenes each sequence is a scene with tables of its own, and each moving
point an annotation. As kitti-raw and kitti-tracking points that move are in boxes that do, and what
the camera does not see has no label.

Examples:
  mosbench convert ~/doals/station/sequence_1 --layout semantickitti --out ~/doals-kitti
  mosbench convert ~/doals --sequences 1,2 --layout doals --out ~/doals-bin
  mosbench convert sim/doals --layout doals-bag --compression lz4 --out sim/bags
  mosbench convert drive.bag --layout ros2-mcap --compression zstd --out ~/drive-ros2
  mosbench convert ~/kitti --sequences 08 --poses suma.txt --layout semantickitti --out ~/kitti-suma
  mosbench convert ~/folder-with-a-bag --odometry simple --layout semantickitti --out ~/posed)";

struct ConvertFlags {
  std::filesystem::path input;
  std::string dataset = "auto", layout, compression;
  std::vector<std::string> sequences;
  ReadingOptions reading;
  OdometryOptions odometry;
  ConvertOptions conversion;
  unsigned threads = hardware_threads();
};

/// The layouts that are bags; any other is that of a data set.
void set_layout(const std::string& name, ConvertOptions& conversion) {
  conversion.writing.bag = name == "doals-bag"   ? BagKind::kRos1
                           : name == "ros2-mcap" ? BagKind::kMcap
                           : name == "ros2-db3"  ? BagKind::kDb3
                                                 : BagKind::kNone;
  if (conversion.writing.bag == BagKind::kNone) {
    conversion.layout = *dataset_kind_from_string(name);
  } else {
    conversion.layout = name == "doals-bag" ? DatasetKind::kDoals : DatasetKind::kRecording;
  }
}

/// SQLite has no chunks that lz4 could pack.
std::string compression_of(const ConvertFlags& options) {
  if (!options.compression.empty()) return options.compression;
  return options.layout == "ros2-db3" ? "none" : "lz4";
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

std::string convert_dataset(ConvertFlags options) {
  ConvertOptions& conversion = options.conversion;
  set_layout(options.layout, conversion);
  conversion.writing.compression = compression_of(options);
  const std::optional<OdometryChoice> odometry = named_odometry(options.odometry, options.reading);
  options.reading.poses_by_odometry = odometry.has_value();
  Dataset dataset = open_dataset(
      options.input, {dataset_kind_option(options.dataset), options.sequences, options.reading});
  check_kept_speed(options, dataset.kind);
  if (odometry) {
    const OdometryChoice choice = with_filter(*odometry, options.odometry, dataset.kind);
    expect_poses(dataset, choice);
    conversion.before_sequence = [&dataset, choice, &options](std::size_t i) {
      Sequence& sequence = *dataset.sequences[i];
      set_poses(sequence, choice, find_poses(sequence, choice, options.threads));
    };
  }
  std::optional<Progress> progress;
  std::size_t scans = 0;
  const auto count = [&](std::size_t done, std::size_t total) {
    if (!progress) progress.emplace("convert", total);
    progress->advance();
    scans = done;
  };
  for (const std::string& sentence : convert(dataset, conversion, count)) tell(sentence);
  return fmt::format("converted {} of {} to {} in {}\n", counted(scans, "scan"),
                     options.input.string(), options.layout, conversion.out.string());
}

}  // namespace

CommandRun add_convert(CLI::App& command) {
  auto options = std::make_shared<ConvertFlags>();
  add_dataset_flags(command, options->input, options->dataset, options->sequences,
                    options->reading);
  command.add_option("--layout", options->layout, "Layout to write")
      ->required()
      ->check(CLI::IsMember({"doals", "doals-bag", "sipailou", "helimos", "semantickitti",
                             "opensceneflow", "nuscenes", "helipr", "kitti-raw", "kitti-tracking",
                             "ros2-mcap", "ros2-db3"}));
  command.add_option("--out", options->conversion.out, "Root of the data set to write")
      ->type_name("DIR")
      ->required();
  command
      .add_option("--compression", options->compression,
                  "Of the bag: bz2 for ROS 1, zstd for ROS 2, lz4 not for ros2-db3 (default: lz4, "
                  "there none)")
      ->check(CLI::IsMember({"none", "lz4", "bz2", "zstd"}));
  add_odometry_flags(command, options->odometry);
  add_threads_flag(command, options->threads);
  command.footer(kConvertFooter);
  return [options] { return Answer{convert_dataset(*options)}; };
}

}  // namespace mosbench
