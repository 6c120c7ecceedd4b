#include "eval/cli/breakdown_answer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <deque>

#include "core/base/thread_pool.hpp"
#include "datasets/text/errors.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/breakdown/breakdown.hpp"
#include "eval/cli/dataset_flags.hpp"
#include "eval/cli/suggested_command.hpp"
#include "eval/job/job_words.hpp"
#include "eval/job/method_choice.hpp"
#include "eval/protocols/protocol.hpp"
#include "eval/result/result_file.hpp"
#include "eval/result/result_scans.hpp"
#include "eval/result/result_set.hpp"

namespace mosbench {
namespace {

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
    const OpenedPredictions opened = open_predictions(*options.predictions, *sequence, scans,
                                                      dataset.sequences.size() == 1, prediction);
    breakdowns.push_back(break_down(*sequence, scans, *opened.labels, task));
  }
  if (!breakdowns.empty()) return breakdowns;
  throw DataError(dataset.root, "no scan has truth", "labels next to the scans");
}

Answer answer_of(const BreakdownFlags& options, const Dataset& dataset, const BreakdownTask& task,
                 const std::vector<SequenceBreakdown>& breakdowns) {
  nlohmann::ordered_json json = {{"dataset", std::string(to_string(dataset.kind))},
                                 {"protocol", std::string(task.protocol->name)},
                                 {"min_range_m", task.range.min_m},
                                 {"max_range_m", task.range.max_m},
                                 {"sequences", nlohmann::ordered_json::array()}};
  if (const auto origin = simulated_origin_json(dataset)) json["simulated"] = *origin;
  Answer answer{.standing = standing_of(dataset),
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

/// A folder of results tells by itself how its data were read and scored.
void refuse_flags_of_data(const CLI::App& command) {
  const std::string given = given_words(command, [](const CLI::Option& option) {
    const std::string name = option.get_name();
    return option.get_group() == kReadingGroup || name == "--dataset" || name == "--format" ||
           name == "--protocol" || name == "--range";
  });
  if (given.empty()) return;
  throw UsageError(fmt::format("{}: is told by the results already, expected it with --predictions",
                               given.substr(1)));
}

Answer breakdown_of_run(const BreakdownFlags& options, const CLI::App& command) {
  if (find_result_files(options.input).empty()) {
    throw UsageError(
        fmt::format("--predictions: is missing, expected the labels of {}, or results of `mosbench "
                    "run` or `mosbench score` in its place",
                    options.input.string()));
  }
  refuse_flags_of_data(command);
  (void)load_result_set(options.input);  // throws where they are of several runs
  std::vector<Result> results = read_results(options.input);
  std::erase_if(results, [&](const Result& result) {
    return !options.sequences.empty() &&
           std::ranges::find(options.sequences, result.sequence.text()) == options.sequences.end();
  });
  if (results.empty()) {
    throw UsageError(fmt::format("--sequences: {} has no results of {}, expected others",
                                 options.input.string(), fmt::join(options.sequences, ",")));
  }
  std::deque<ResultScans> scans;
  std::vector<SequenceBreakdown> breakdowns;
  BreakdownTask task{};
  for (const Result& result : results) {
    const ResultScans& opened = scans.emplace_back(result, std::nullopt);
    task = {opened.rule().protocol, opened.rule().range, options.threads};
    if (opened.scored_scans().empty()) continue;
    breakdowns.push_back(
        break_down(opened.sequence(), opened.scored_scans(), opened.labels(), task));
  }
  if (breakdowns.empty()) {
    throw DataError(options.input, "has no scan with truth",
                    "results of a labelled sequence, or another name in --sequences");
  }
  return answer_of(options, scans.front().dataset(), task, breakdowns);
}

}  // namespace

Answer breakdown_of(const BreakdownFlags& options, const CLI::App& command) {
  if (!options.predictions) return breakdown_of_run(options, command);
  const Dataset dataset = open_dataset(
      options.input, {dataset_kind_option(options.dataset), options.sequences, options.reading});
  const BreakdownTask task = settle(options, dataset);
  return answer_of(options, dataset, task, all_breakdowns(options, dataset, task));
}

}  // namespace mosbench
