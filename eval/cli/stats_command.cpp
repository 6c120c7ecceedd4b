#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <deque>
#include <functional>
#include <memory>

#include "core/base/thread_pool.hpp"
#include "datasets/text/errors.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/answer/render.hpp"
#include "eval/breakdown/breakdown.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/flags.hpp"
#include "eval/job/method_choice.hpp"
#include "eval/protocols/metrics.hpp"
#include "eval/protocols/protocol.hpp"
#include "eval/report/score_curve.hpp"
#include "eval/result/output.hpp"
#include "eval/result/result.hpp"
#include "eval/result/result_file.hpp"
#include "eval/result/result_scans.hpp"
#include "eval/statistics/statistics_report.hpp"

namespace mosbench {
namespace {

/// What `input` names is a run, or data with `predictions`.
struct StatsFlags : DataWords {
  std::optional<std::filesystem::path> predictions, data, picture;
  std::optional<std::string> protocol, range, format;
  std::vector<std::string> by;
  BreakdownParts parts;
  std::size_t top = 10;
  unsigned threads = hardware_threads();
  bool allow_stale = false;

  bool shows(std::string_view what) const { return std::ranges::find(by, what) != by.end(); }
};

/// Adds to `doubts` those about the labels.
std::vector<SequenceBreakdown> all_breakdowns(const StatsFlags& options, const Dataset& dataset,
                                              const BreakdownTask& task,
                                              std::vector<Doubt>& doubts) {
  PredictionOptions prediction;
  if (options.format) prediction.format = prediction_format_named(*options.format);
  std::vector<SequenceBreakdown> breakdowns;
  for (const auto& sequence : dataset.sequences) {
    const std::vector<std::size_t> scans = scans_with_truth(*sequence);
    if (scans.empty()) continue;
    const OpenedPredictions opened = open_predictions(*options.predictions, *sequence, scans,
                                                      dataset.sequences.size() == 1, prediction);
    const std::optional<Result> run = run_that_wrote(opened);
    if (run) {
      for (std::string& doubt : doubts_of_labels(*run, *sequence)) {
        doubts.push_back({sequence->name(), std::move(doubt)});
      }
    }
    breakdowns.push_back(break_down(*sequence, scans, *opened.labels, task));
  }
  if (!breakdowns.empty()) return breakdowns;
  throw DataError(dataset.root, "no scan has truth", "labels next to the scans");
}

Answer answer_of(const StatsFlags& options, const Dataset& dataset, Standing standing,
                 const BreakdownTask& task, const std::vector<SequenceBreakdown>& breakdowns) {
  nlohmann::ordered_json json = {{"dataset", std::string(to_string(dataset.kind))}};
  json.update(rule_json({task.protocol, task.range}));
  json["sequences"] = nlohmann::ordered_json::array();
  if (const auto origin = simulated_origin_json(dataset)) json["simulated"] = *origin;
  Answer answer{.standing = std::move(standing),
                .sheets = {{.lead = {rule_line({task.protocol, task.range})}}}};
  for (const SequenceBreakdown& part : breakdowns) {
    json["sequences"].push_back(to_json(part, options.top));
    for (Sheet& sheet : breakdown_sheets(part, options.parts, options.top)) {
      answer.sheets.push_back(std::move(sheet));
    }
  }
  answer.json = json_text(json);
  return answer;
}

/// Throws UsageError where one of the flags was given that `passes` names: they would do nothing.
void refuse_flags(const CLI::App& command, const char* expected,
                  const std::function<bool(const CLI::Option&)>& passes) {
  const std::string given = given_words(command, passes);
  if (given.empty()) return;
  throw UsageError(fmt::format("{}: {}", given.substr(1), expected));
}

/// Whether it says how data are read or scored.
bool is_of_data(const CLI::Option& option) {
  const std::string name = option.get_name();
  return option.get_group() == kReadingGroup || name == "--dataset" || name == "--format" ||
         name == "--protocol" || name == "--range";
}

/// A folder of results tells by itself how its data were read and scored.
void refuse_flags_of_data(const CLI::App& command) {
  refuse_flags(command,
               "is told by the results already, expected it with --predictions, a data set as RUN, "
               "and --by range, height or object",
               is_of_data);
}

/// Throws UsageError for flags that say nothing to intervals, scans and thresholds.
void refuse_flags_of_breakdown(const StatsFlags& options, const CLI::App& command) {
  const bool has_curve = options.shows("threshold");
  if (!options.predictions) refuse_flags_of_data(command);
  refuse_flags(command, "does nothing here, expected it with --by range, height or object",
               [&](const CLI::Option& option) {
                 const std::string name = option.get_name();
                 return is_of_data(option) || name == "--predictions" || name == "--top" ||
                        (name == "--data" && !has_curve);
               });
}

Answer breakdown_of_run(const StatsFlags& options, const CLI::App& command) {
  if (find_result_files(options.input).empty()) {
    throw UsageError(
        fmt::format("--predictions: is missing, expected the labels of {}, or results of `mosbench "
                    "run` or `mosbench score` in its place",
                    options.input.string()));
  }
  refuse_flags_of_data(command);
  const ResultSet run = only(load_result_set(options.input), options.sequences);
  refuse_stale({run}, options.allow_stale);
  std::deque<ResultScans> scans;
  std::vector<SequenceBreakdown> breakdowns;
  BreakdownTask task{};
  for (const Result& result : run.sequences) {
    const ResultScans& opened = scans.emplace_back(result, options.data);
    task = {opened.rule().protocol, opened.rule().range, options.threads};
    if (opened.scored_scans().empty()) continue;
    breakdowns.push_back(
        break_down(opened.sequence(), opened.scored_scans(), opened.labels(), task));
    if (options.parts.reason) breakdowns.back().reasons = count_reasons(opened, options.threads);
  }
  if (breakdowns.empty()) {
    throw DataError(options.input, "has no scan with truth",
                    "results of a labelled sequence, or another name in --sequences");
  }
  return answer_of(options, scans.front().dataset(), standing_of(run), task, breakdowns);
}

Answer breakdown_of(const StatsFlags& options, const CLI::App& command) {
  if (!options.predictions) return breakdown_of_run(options, command);
  if (options.parts.reason) {
    throw UsageError(
        "--by reason: is of results, expected those of `mosbench run` or `mosbench score` as RUN");
  }
  if (options.data) {
    throw UsageError(fmt::format("--data {}: RUN is the data set with --predictions, expected one",
                                 options.data->string()));
  }
  const Dataset dataset = open_dataset(options);
  const ScoreRule rule = rule_of(options.protocol, options.range, dataset.kind);
  const BreakdownTask task = {rule.protocol, rule.range, options.threads};
  std::vector<Doubt> doubts;
  const std::vector<SequenceBreakdown> breakdowns = all_breakdowns(options, dataset, task, doubts);
  return answer_of(options, dataset, standing_of(dataset, std::move(doubts)), task, breakdowns);
}

Answer curve(const StatsFlags& options, const ResultSet& run) {
  Answer answer = curve_answer(run, options.data);
  if (options.picture) write_output(*options.picture, render(answer, Format::kPng));
  return answer_beside(options.picture.value_or(""), std::move(answer));
}

Answer stats(StatsFlags options, const CLI::App& command) {
  BreakdownParts& parts = options.parts;
  parts = {options.shows("range"), options.shows("height"), options.shows("object"),
           options.shows("reason")};
  const bool breaks_down = parts.range || parts.height || parts.object || parts.reason;
  if (options.shows("threshold") + options.shows("scan") + breaks_down > 1) {
    throw UsageError("--by: threshold and scan go with nothing else, expected one of them alone");
  }
  if (options.picture && !options.shows("threshold")) {
    throw UsageError(fmt::format("-o {}: is of a curve, expected it with --by threshold",
                                 options.picture->string()));
  }
  if (breaks_down) return breakdown_of(options, command);
  refuse_flags_of_breakdown(options, command);
  if (options.picture) check_output(*options.picture, Format::kPng);
  const ResultSet run = only(load_result_set(options.input), options.sequences);
  refuse_stale({run}, options.allow_stale);
  if (options.shows("threshold")) return curve(options, run);
  return statistics_answer(run, options.shows("scan"));
}

}  // namespace

CommandRun add_stats(CLI::App& command) {
  auto options = std::make_shared<StatsFlags>();
  add_dataset_flags(command, *options, "RUN");
  add_list(
      command, "--by WHAT,...", options->by,
      "Show right and wrong points by range, height, object and the reason why they move, with "
      "what lies around wrong ones; or precision over recall by threshold; or, in JSON and "
      "CSV, by scan (default: intervals by sequence)")
      ->check(CLI::IsMember({"range", "height", "object", "reason", "threshold", "scan"}));
  add(command, "--data DIR", options->data,
      "Folder of the data set (default: where the run read it)");
  add(command, "-o,--out FILE", options->picture, "PNG file to draw the curve to; - is stdout");
  add(command, "--predictions PATH", options->predictions,
      "Folder or file of predictions for RUN, which then is a data set");
  add(command, "--format FORMAT", options->format, "Of the predictions (default: recognised)");
  add(command, "--protocol PROTOCOL", options->protocol,
      "Rules of truth and range (default: by data set)");
  add(command, "--range MIN,MAX", options->range, "In metres, for protocols that limit it");
  add(command, "--top", options->top, "How many objects and false positives to list")
      ->check(CLI::Range(std::size_t{0}, std::size_t{1000000}))
      ->capture_default_str();
  add_threads_flag(command, options->threads);
  add_stale_flag(command, options->allow_stale);
  for (const char* flag :
       {"--dataset", "--poses", "--predictions", "--format", "--protocol", "--range"}) {
    command.get_option(flag)->group(kRareGroup);
  }
  return [options, &command] { return stats(*options, command); };
}

}  // namespace mosbench
