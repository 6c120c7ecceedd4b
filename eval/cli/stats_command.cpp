#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "datasets/text/errors.hpp"
#include "eval/answer/render.hpp"
#include "eval/cli/breakdown_answer.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/dataset_flags.hpp"
#include "eval/cli/help_text.hpp"
#include "eval/cli/output_file.hpp"
#include "eval/report/score_curve.hpp"
#include "eval/result/tell.hpp"
#include "eval/statistics/statistics_report.hpp"

namespace mosbench {
namespace {

struct StatsFlags {
  BreakdownFlags run;
  std::vector<std::string> by;
  std::optional<std::filesystem::path> data, picture;

  bool shows(std::string_view what) const { return std::ranges::find(by, what) != by.end(); }
};

Answer curve(const StatsFlags& options) {
  if (options.picture) check_output(*options.picture);
  Answer answer = curve_answer(curve_of_run(options.run.input, options.data));
  if (options.picture) write_output(*options.picture, render(answer, Format::kPng));
  return answer_beside(options.picture.value_or(""), std::move(answer));
}

Answer stats(StatsFlags options, const CLI::App& command) {
  BreakdownParts& parts = options.run.parts;
  parts = {options.shows("range"), options.shows("height"), options.shows("object")};
  const bool breaks_down = parts.range || parts.height || parts.object;
  if (options.shows("threshold") + options.shows("scan") + breaks_down > 1) {
    throw UsageError("--by: threshold and scan go with nothing else, expected one of them alone");
  }
  if (options.shows("threshold")) return curve(options);
  if (breaks_down) return breakdown_of(options.run, command);
  return statistics_answer(load_result_set(options.run.input), options.shows("scan"));
}

void add_breakdown_flags(CLI::App& command, BreakdownFlags& run) {
  command
      .add_option("--predictions", run.predictions,
                  "Folder or file of predictions for RUN, which then is a data set")
      ->type_name("PATH")
      ->group(kRareGroup);
  command.add_option("--format", run.format, "Of the predictions (default: recognised)")
      ->type_name("FORMAT")
      ->group(kRareGroup);
  command.add_option("--protocol", run.protocol, "Rules of truth and range (default: by data set)")
      ->type_name("PROTOCOL")
      ->group(kRareGroup);
  command.add_option("--range", run.range, "In metres, for protocols that limit it")
      ->type_name("MIN,MAX")
      ->group(kRareGroup);
  command.add_option("--top", run.top, "How many objects and false positives to list")
      ->capture_default_str();
  add_threads_flag(command, run.threads);
  for (const char* flag : {"--dataset", "--poses"}) command.get_option(flag)->group(kRareGroup);
}

}  // namespace

CommandRun add_stats(CLI::App& command) {
  auto options = std::make_shared<StatsFlags>();
  BreakdownFlags& run = options->run;
  add_dataset_flags(command, run.input, run.dataset, run.sequences, run.reading, "RUN");
  command
      .add_option(
          "--by", options->by,
          "Show right and wrong points by range, height and object; or precision over recall "
          "by threshold; or, in JSON and CSV, by scan (default: intervals by sequence)")
      ->type_name("WHAT,...")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"range", "height", "object", "threshold", "scan"}));
  command
      .add_option("--data", options->data,
                  "Folder of the data set (default: where the run read it)")
      ->type_name("DIR");
  command.add_option("-o,--out", options->picture, "PNG file to draw the curve to; - is stdout")
      ->type_name("FILE");
  add_breakdown_flags(command, run);
  return [options, &command] { return stats(*options, command); };
}

}  // namespace mosbench
