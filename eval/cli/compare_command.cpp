#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "datasets/text/errors.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/answer/render.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/output_file.hpp"
#include "eval/statistics/gate_report.hpp"
#include "eval/statistics/paired_runs.hpp"

namespace mosbench {
namespace {

constexpr const char* kCompareFooter =
    R"(BASELINE and NEW are folders of results (mosbench run, mosbench score --out, mosbench bless). Their
scans are paired. A sequence, or all of them together, regresses when its IoU drops by more than
--max-drop: both runs label the same scans, so no drop is chance. The 95 % interval of the paired
difference is shown as a note; it says whether other scans like these would show the drop. With
--statistical a drop must also exceed the half-width of that interval. Runs of another protocol,
method, setting, scans or input are refused; --even-if compares the scans that both have.

For pull requests: --as github adds an annotation per regression to the text, and
--summary writes the table in markdown.

Exit codes: 0 pass, 1 regression, 2 wrong usage, 3 unusable or unlike results.

Examples:
  mosbench compare results/baseline/highway-online results/runs/highway
  mosbench compare results/baseline/highway-online results/runs/highway --max-drop 0.1 --json
  mosbench compare results/baseline/highway-online results/runs/highway --as github \
    --summary gate.md)";

struct CompareFlags {
  std::filesystem::path baseline, newer;
  double max_drop_points = 0.5;
  bool statistical = false;
  bool even_if = false;
  bool quiet = false;
  std::filesystem::path summary;
};

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

}  // namespace

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
  command.add_option("--summary", options->summary, "Also write the table in markdown to FILE")
      ->type_name("FILE");
  command.add_flag("-q,--quiet", options->quiet, "Print nothing when it passes");
  command.footer(kCompareFooter);
  return [options] { return compare(*options); };
}

}  // namespace mosbench
