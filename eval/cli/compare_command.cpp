#include "eval/cli/compare_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "datasets/text/errors.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/answer/render.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/dataset_flags.hpp"
#include "eval/cli/help_text.hpp"
#include "eval/cli/output_file.hpp"
#include "eval/statistics/paired_runs.hpp"
#include "eval/statistics/statistics_report.hpp"

namespace mosbench {
namespace {

Answer answer_of(const ResultSet& baseline, const ResultSet& newer, const PairedRuns& paired,
                 const GateResult& result) {
  const std::string unlike = unlike_text(paired.unlike);
  Sheet sheet = gate_sheet(result);
  sheet.lead.push_back(fmt::format("{} paired scans", paired.scans.size()));
  if (!unlike.empty()) sheet.lead.push_back("unlike: " + unlike);
  nlohmann::ordered_json json = to_json(result);
  json["paired_scans"] = paired.scans.size();
  json["missing_predictions"] = {{"baseline", missing_predictions(baseline)},
                                 {"new", missing_predictions(newer)}};
  json["unlike"] = unlike;
  return {.exit_code = result.passed() ? 0 : 1,
          .standing = standing_of(baseline, "baseline", newer, "new"),
          .sheets = {std::move(sheet)},
          .json = json_text(json),
          .annotations = gate_annotations(result)};
}

Answer compare(const CompareFlags& options) {
  if (!options.summary.empty()) check_output(options.summary);
  const ResultSet baseline = load_result_set(options.baseline);
  const ResultSet newer = load_result_set(options.newer);
  const PairedRuns paired = pair_runs(baseline, newer);
  if (!paired.unlike.empty() && !options.even_if) {
    throw DataError(options.newer,
                    "is not like " + options.baseline.string() + ": " + unlike_text(paired.unlike),
                    "results of the same kind; --even-if compares them anyway");
  }
  if (paired.scans.empty()) {
    throw DataError(options.newer, "shares no counted scan with " + options.baseline.string(),
                    "results over the same scans");
  }
  const GateResult result =
      judge(paired, *baseline.front().protocol, options.max_drop_points / 100.0,
            options.statistical ? GateRule::kStatistical : GateRule::kMaxDrop);
  Answer answer = answer_of(baseline, newer, paired, result);
  if (!options.summary.empty()) {
    write_output(options.summary, render(answer, Format::kMarkdown));
    answer = answer_beside(options.summary, std::move(answer));
  }
  return options.quiet && result.passed() ? Answer{} : answer;
}

Answer answer(const CompareFlags& options) {
  if (options.accept) return accepted(options);
  if (options.by.empty()) return compare(options);
  if (!options.shows("sequence")) return scans_and_objects(options);
  if (options.by.size() == 1) return paired_difference(options);
  throw UsageError("--by sequence: goes with nothing else, expected it alone, or scan,object");
}

}  // namespace

Answer paired_difference(const CompareFlags& options) {
  const ResultSet first = load_result_set(options.baseline);
  const ResultSet second = load_result_set(options.newer);
  PairedRuns paired = pair_runs(first, second);
  std::erase_if(paired.unlike,
                [](const Unlike& unlike) { return unlike.kind == Unlike::Kind::kSetting; });
  std::vector<Unlike> refused = paired.unlike;
  std::erase_if(refused, [](const Unlike& unlike) { return unlike.kind == Unlike::Kind::kPoses; });
  if (!refused.empty()) {
    throw DataError(second.path, "is not like " + first.path.string() + ": " + unlike_text(refused),
                    "the same protocol, scans and truth");
  }
  return difference_answer(first, second, paired);
}

CommandRun add_compare(CLI::App& command) {
  auto options = std::make_shared<CompareFlags>();
  command.add_option("BASELINE", options->baseline, "Accepted results")
      ->type_name("DIR")
      ->required();
  command.add_option("NEW", options->newer, "Results to judge")->type_name("DIR")->required();
  command
      .add_option("--max-drop", options->max_drop_points,
                  "Percentage points of IoU that may be lost")
      ->check(CLI::Range(0.0, 100.0))
      ->capture_default_str();
  command.add_flag("--statistical", options->statistical,
                   "Fail only when the drop also exceeds what its 95 % interval leaves open");
  command.add_flag("--even-if", options->even_if, "Also compare results of different kinds");
  command
      .add_option(
          "--by", options->by,
          "Judge nothing and show what NEW changes in each sequence (also of another method "
          "or setting), or on which scans and objects the two disagree")
      ->type_name("WHAT,...")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"sequence", "scan", "object"}));
  command.add_option("--data", options->data, "Data set of both, for --by object")
      ->type_name("DIR");
  add_dataset_kind_flag(command, options->dataset);
  command.get_option("--dataset")->group(kRareGroup);
  command.add_option("--top", options->top, "How many scans and objects --by lists")
      ->capture_default_str();
  command.add_flag("--accept", options->accept, "Make NEW the baseline and show what changes");
  command.add_option("-o,--out", options->summary, "Also write the table in markdown to FILE")
      ->type_name("FILE");
  command.add_flag("-q,--quiet", options->quiet, "Print nothing when it passes");
  return [options] { return answer(*options); };
}

}  // namespace mosbench
