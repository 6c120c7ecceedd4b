#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "core/base/thread_pool.hpp"
#include "datasets/files/errors.hpp"
#include "eval/breakdown/breakdown.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/dataset_flags.hpp"
#include "eval/results/answer_text.hpp"
#include "eval/results/simulated.hpp"
#include "eval/runs/presets.hpp"
#include "eval/runs/run_plan.hpp"

namespace mosbench {
namespace {

constexpr const char* kBreakdownFooter =
    R"(Shows where predictions are right and wrong: by range, by height above the sensor, and by the size,
speed and age of moving objects. Lists the objects that lost most points and the largest false
positives, worst first, with scan and position. Objects are the instances of the truth if it has any,
else clusters of moving points linked over scans. An object is detected once a tenth of its points is
found. Speeds are in the map frame; if the stamps of the scans do not rise, 10 Hz is assumed.

Examples:
  mosbench breakdown ~/kitti/sequences/08 --predictions results/runs/kitti
  mosbench breakdown sim/room --predictions results/runs/room --top 5 --json)";

struct BreakdownFlags {
  std::filesystem::path input, predictions;
  std::string dataset = "auto";
  std::vector<std::string> sequences;
  std::optional<std::string> protocol, range, format;
  ReadingOptions reading;
  std::size_t top = 10;
  unsigned threads = hardware_threads();
  bool json = false;
};

BreakdownTask settle(const BreakdownFlags& options, const Dataset& dataset) {
  const Protocol& protocol =
      protocol_named(options.protocol.value_or(std::string(default_preset(dataset.kind).protocol)));
  return {&protocol,
          options.range ? range_option(*options.range, protocol) : protocol.default_range,
          options.threads};
}

std::vector<SequenceBreakdown> all_breakdowns(const BreakdownFlags& options, const Dataset& dataset,
                                              const BreakdownTask& task) {
  PredictionOptions prediction;
  if (options.format) prediction.format = prediction_format_named(*options.format);
  std::vector<SequenceBreakdown> breakdowns;
  for (const auto& sequence : dataset.sequences) {
    const std::vector<std::size_t> scans = scans_with_truth(*sequence);
    if (scans.empty()) continue;
    const OpenedPredictions opened = open_predictions(options.predictions, *sequence, scans,
                                                      dataset.sequences.size() == 1, prediction);
    breakdowns.push_back(break_down(*sequence, scans, *opened.labels, task));
  }
  if (!breakdowns.empty()) return breakdowns;
  throw DataError(dataset.root, "no scan has truth", "labels next to the scans");
}

std::string breakdown(const BreakdownFlags& options) {
  const Dataset dataset = open_dataset(
      options.input, {dataset_kind_option(options.dataset), options.sequences, options.reading});
  const BreakdownTask task = settle(options, dataset);
  const std::vector<SequenceBreakdown> breakdowns = all_breakdowns(options, dataset, task);
  if (options.json) {
    nlohmann::ordered_json json = {{"dataset", std::string(to_string(dataset.kind))},
                                   {"protocol", std::string(task.protocol->name)},
                                   {"min_range_m", task.range.min_m},
                                   {"max_range_m", task.range.max_m},
                                   {"sequences", nlohmann::ordered_json::array()}};
    if (const auto origin = simulated_origin_json(dataset)) json["simulated"] = *origin;
    for (const SequenceBreakdown& part : breakdowns) {
      json["sequences"].push_back(to_json(part, options.top));
    }
    return json_text(json);
  }
  std::string text = fmt::format("protocol {}\n{}", task.protocol->name, simulated_remark(dataset));
  for (const SequenceBreakdown& part : breakdowns) text += '\n' + breakdown_text(part, options.top);
  return text;
}

}  // namespace

CommandRun add_breakdown(CLI::App& command) {
  auto options = std::make_shared<BreakdownFlags>();
  add_dataset_flags(command, options->input, options->dataset, options->sequences,
                    options->reading);
  command
      .add_option("--predictions", options->predictions,
                  "Folder or file of predictions, as for `mosbench score`")
      ->type_name("PATH")
      ->required();
  command.add_option("--format", options->format, "Of the predictions (default: recognised)")
      ->type_name("FORMAT");
  command
      .add_option("--protocol", options->protocol,
                  "Rules of truth and range (default: by data set)")
      ->type_name("PROTOCOL");
  command.add_option("--range", options->range, "In metres, for protocols that limit it")
      ->type_name("MIN,MAX");
  command.add_option("--top", options->top, "How many objects and false positives to list")
      ->capture_default_str();
  add_threads_flag(command, options->threads);
  command.add_flag("--json", options->json, "Print JSON instead of tables");
  command.footer(kBreakdownFooter);
  return [options] { return Answer{breakdown(*options)}; };
}

}  // namespace mosbench
