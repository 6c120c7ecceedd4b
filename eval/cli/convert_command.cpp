#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "datasets/files/errors.hpp"
#include "datasets/layouts/convert.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/reading_flags.hpp"
#include "eval/results/progress.hpp"
#include "eval/runs/run_plan.hpp"

namespace mosbench {
namespace {

constexpr const char* kConvertFooter =
    R"(Writes scans, the lidar's poses, stamps and truth of DATA in another layout, so that other programs
can read them. Points keep their bits and their order. Truth becomes .label files with the source's
ids, or, in DOALS's layouts, rows of indices.csv with the points of ids 251 to 259; scans without stamps
get ones 0.1 s apart there.

Examples:
  mosbench convert ~/doals/station/sequence_1 --layout semantickitti --out ~/doals-kitti
  mosbench convert ~/doals --sequences 1,2 --layout doals --out ~/doals-bin
  mosbench convert sim/doals --layout doals-bag --compression lz4 --out sim/bags
  mosbench convert ~/kitti --sequences 08 --poses suma.txt --layout semantickitti --out ~/kitti-suma)";

struct ConvertFlags {
  std::filesystem::path input;
  std::string dataset = "auto", layout;
  std::vector<std::string> sequences;
  ReadingOptions reading;
  ConvertOptions conversion;
};

std::string convert_dataset(ConvertFlags options) {
  ConvertOptions& conversion = options.conversion;
  conversion.writing.as_bag = options.layout == "doals-bag";
  conversion.layout =
      conversion.writing.as_bag ? DatasetKind::kDoals : *dataset_kind_from_string(options.layout);
  const Dataset dataset = open_dataset(
      options.input, {dataset_kind_option(options.dataset), options.sequences, options.reading});
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

void add_convert_command(CLI::App& app, std::string& answer) {
  auto options = std::make_shared<ConvertFlags>();
  CLI::App* command = app.add_subcommand("convert", "Write a data set in another layout");
  command->add_option("DATA", options->input, "Root of a data set, or one sequence folder")
      ->required();
  command
      ->add_option("--layout", options->layout,
                   "doals, doals-bag, sipailou, helimos or semantickitti")
      ->required()
      ->check(CLI::IsMember({"doals", "doals-bag", "sipailou", "helimos", "semantickitti"}));
  command->add_option("--out", options->conversion.out, "Becomes the root of the data set")
      ->required();
  command->add_option("--dataset", options->dataset, "What DATA is, see run")
      ->capture_default_str();
  command->add_option("--sequences", options->sequences, "Names to convert, a,b (default: all)")
      ->delimiter(',')
      ->allow_extra_args(false);
  command->add_option("--compression", options->conversion.writing.compression, "none, lz4 or bz2")
      ->capture_default_str()
      ->check(CLI::IsMember({"none", "lz4", "bz2"}));
  add_reading_flags(*command, options->reading);
  command->footer(kConvertFooter);
  command->callback([options, &answer] { answer = convert_dataset(*options); });
}

}  // namespace mosbench
