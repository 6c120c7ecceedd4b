#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "core/base/thread_pool.hpp"
#include "datasets/files/errors.hpp"
#include "eval/breakdown/breakdown.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/reading_flags.hpp"
#include "eval/results/answer_text.hpp"
#include "eval/results/simulated.hpp"
#include "eval/runs/presets.hpp"
#include "eval/runs/run_plan.hpp"

namespace mosbench {
namespace {

constexpr const char* kBreakdownFooter =
    R"(Shows where predictions are right and wrong: by range, by height above the sensor, by the size, speed
and age of moving objects; the objects that lost most points and the largest false positives, worst
first, with scan and position. Objects are the instances of the truth where it has some, else clusters
of moving points linked over scans. An object is detected once a tenth of its points is found. Speeds are
in the map's frame, by the scans' stamps or, where not all have rising ones, as if at 10 Hz.

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
  unsigned threads = 0;
  bool json = false;
};

BreakdownTask settle(const BreakdownFlags& options, const Dataset& dataset) {
  const Protocol& protocol =
      protocol_named(options.protocol.value_or(std::string(default_preset(dataset.kind).protocol)));
  return {&protocol,
          options.range ? range_option(*options.range, protocol) : protocol.default_range,
          options.threads > 0 ? options.threads : hardware_threads()};
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
  throw DataError(dataset.root, "no scan has truth", "labels beside the scans");
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

void add_breakdown_command(CLI::App& app, std::string& answer) {
  auto options = std::make_shared<BreakdownFlags>();
  CLI::App* command = app.add_subcommand("breakdown", "Where predictions are right and wrong");
  command->add_option("DATA", options->input, "Root of a data set, or one sequence folder")
      ->required();
  command->add_option("--predictions", options->predictions, "As of mosbench score")->required();
  command->add_option("--format", options->format, "Of the predictions (default: recognised)");
  command->add_option("--protocol", options->protocol,
                      "Rules of truth and range (default: by data set)");
  command->add_option("--range", options->range, "MIN,MAX in metres, for protocols that limit it");
  command->add_option("--dataset", options->dataset, "auto, " + dataset_kind_names())
      ->capture_default_str();
  command->add_option("--sequences", options->sequences, "Names to look at, a,b (default: all)")
      ->delimiter(',')
      ->allow_extra_args(false);
  command->add_option("--top", options->top, "How many objects and false positives to list")
      ->capture_default_str();
  command->add_option("--threads", options->threads, "Results do not depend on it (default: all)")
      ->check(CLI::Range(1U, 1024U));
  command->add_flag("--json", options->json, "Print JSON instead of tables");
  add_reading_flags(*command, options->reading);
  command->footer(kBreakdownFooter);
  command->callback([options, &answer] { answer = breakdown(*options); });
}

}  // namespace mosbench
