#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "core/base/thread_pool.hpp"
#include "datasets/files/errors.hpp"
#include "datasets/layouts/convert.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/dataset_flags.hpp"
#include "eval/cli/odometry_flags.hpp"
#include "eval/results/progress.hpp"
#include "eval/runs/run_plan.hpp"

namespace mosbench {
namespace {

constexpr const char* kConvertFooter =
    R"(Writes the scans, LiDAR poses, stamps and truth of DATA in another layout, for other programs. Points
keep their bits and their order. Truth becomes .label files with the ids of the source. In the layouts
of DOALS it becomes rows of indices.csv with the points of ids 251 to 259, and scans without stamps get
stamps 0.1 s apart.

Examples:
  mosbench convert ~/doals/station/sequence_1 --layout semantickitti --out ~/doals-kitti
  mosbench convert ~/doals --sequences 1,2 --layout doals --out ~/doals-bin
  mosbench convert sim/doals --layout doals-bag --compression lz4 --out sim/bags
  mosbench convert ~/kitti --sequences 08 --poses suma.txt --layout semantickitti --out ~/kitti-suma
  mosbench convert ~/folder-with-a-bag --odometry simple --layout semantickitti --out ~/posed)";

struct ConvertFlags {
  std::filesystem::path input;
  std::string dataset = "auto", layout;
  std::vector<std::string> sequences;
  ReadingOptions reading;
  OdometryOptions odometry;
  ConvertOptions conversion;
  unsigned threads = hardware_threads();
};

std::string convert_dataset(ConvertFlags options) {
  ConvertOptions& conversion = options.conversion;
  conversion.writing.as_bag = options.layout == "doals-bag";
  conversion.layout =
      conversion.writing.as_bag ? DatasetKind::kDoals : *dataset_kind_from_string(options.layout);
  const std::optional<OdometryChoice> odometry = named_odometry(options.odometry, options.reading);
  options.reading.poses_by_odometry = odometry.has_value();
  Dataset dataset = open_dataset(
      options.input, {dataset_kind_option(options.dataset), options.sequences, options.reading});
  if (odometry) {
    const OdometryChoice choice = with_filter(*odometry, options.odometry, dataset.kind);
    expect_poses(dataset, choice);
    conversion.before_sequence = [&dataset, choice, &options](std::size_t i) {
      find_poses(*dataset.sequences[i], choice, options.threads);
    };
  }
  std::optional<Progress> progress;
  std::size_t scans = 0;
  convert(dataset, conversion, [&](std::size_t done, std::size_t total) {
    if (!progress) progress.emplace("convert", total);
    progress->advance();
    scans = done;
  });
  return fmt::format("converted {} scans of {} to {} in {}\n", scans, options.input.string(),
                     options.layout, conversion.out.string());
}

}  // namespace

CommandRun add_convert(CLI::App& command) {
  auto options = std::make_shared<ConvertFlags>();
  add_dataset_flags(command, options->input, options->dataset, options->sequences,
                    options->reading);
  command.add_option("--layout", options->layout, "Layout to write")
      ->required()
      ->check(CLI::IsMember({"doals", "doals-bag", "sipailou", "helimos", "semantickitti"}));
  command.add_option("--out", options->conversion.out, "Root of the data set to write")
      ->type_name("DIR")
      ->required();
  command.add_option("--compression", options->conversion.writing.compression, "Of the bag")
      ->capture_default_str()
      ->check(CLI::IsMember({"none", "lz4", "bz2"}));
  add_odometry_flags(command, options->odometry);
  add_threads_flag(command, options->threads);
  command.footer(kConvertFooter);
  return [options] { return Answer{convert_dataset(*options)}; };
}

}  // namespace mosbench
