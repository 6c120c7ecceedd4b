#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iterator>
#include <memory>

#include "datasets/text/errors.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/answer/render.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/compare_kinds.hpp"
#include "eval/cli/flags.hpp"
#include "eval/result/output.hpp"
#include "eval/statistics/statistics_report.hpp"

namespace mosbench {
namespace {

/// "baseline accepted on 2026-01-31: why", once for each reason.
std::vector<std::string> acceptances(const ResultSet& baseline) {
  std::vector<std::string> lines;
  for (const Result& result : baseline.sequences) {
    if (!result.accepted) continue;
    std::string line =
        fmt::format("baseline accepted on {}: {}", result.accepted->on, result.accepted->why);
    if (std::ranges::find(lines, line) == lines.end()) lines.push_back(std::move(line));
  }
  return lines;
}

Answer answer_of(const ResultSet& baseline, const ResultSet& newer, const PairedRuns& paired,
                 const GateResult& result) {
  const std::string unlike = unlike_text(paired.unlike);
  Sheet sheet = gate_sheet(result);
  sheet.lead.push_back(fmt::format("{} paired scans", paired.scans.size()));
  if (!unlike.empty()) sheet.lead.push_back("unlike: " + unlike);
  std::ranges::move(acceptances(baseline), std::back_inserter(sheet.lead));
  if (!paired.added_settings.empty()) {
    sheet.lead.push_back("settings that the baseline does not have: " + paired.added_settings);
  }
  std::vector<Sheet> sheets = {std::move(sheet)};
  if (!result.costs.empty()) sheets.push_back(cost_sheet(result));
  nlohmann::ordered_json json = to_json(result);
  json["paired_scans"] = paired.scans.size();
  json["missing_predictions"] = {{"baseline", missing_predictions(baseline.sequences)},
                                 {"new", missing_predictions(newer.sequences)}};
  json["unlike"] = unlike;
  json["added_settings"] = paired.added_settings;
  std::vector<CheckResult> checks = gate_checks(result);
  checks.push_back({"alike", "Runs are not alike", unlike, CheckResult::Severity::kWarning});
  return {.exit_code = result.passed() ? 0 : 1,
          .standing = standing_of(baseline, "baseline", newer, "new"),
          .sheets = std::move(sheets),
          .json = json_text(json),
          .checks = std::move(checks)};
}

Answer compare(const CompareFlags& options) {
  const ResultSet baseline = chosen_run(options, options.baseline);
  const ResultSet newer = chosen_run(options, options.newer);
  refuse_stale({newer}, options.allow_stale);
  const PairedRuns paired = pair_runs(baseline, newer);
  if (!paired.unlike.empty() && !options.even_if) {
    throw DataError(options.newer,
                    "is not like " + options.baseline.string() + ": " + unlike_text(paired.unlike),
                    "results of the same kind; --even-if compares them anyway");
  }
  check_shares_scans(paired, options);
  const GateResult result = judged(options, baseline, newer, paired);
  return answer_of(baseline, newer, paired, result);
}

/// What a gate answers that cannot judge: CI servers must not take the answer before for this one.
Answer refusal(const Failure& failure) {
  constexpr const char* kTitle = "MOS gate: not judged";
  return {.exit_code = failure.exit_code,
          .failure = failure.message,
          .sheets = {{.title = kTitle, .notes = {failure.message}}},
          .json = json_text({{"passed", false}, {"error", failure.message}}),
          .checks = {{"gate", kTitle, failure.message, CheckResult::Severity::kNotMade}}};
}

Answer compare_or_refuse(CompareFlags& options) {
  try {
    choose_method(options);
    return compare(options);
  } catch (...) {
    return refusal(current_failure());
  }
}

Format written_format(const CompareFlags& options) {
  return format_of_name(options.out).value_or(Format::kMarkdown);
}

/// Writes the answer to the files that were asked for.
Answer kept(const CompareFlags& options, Answer answer) {
  if (!options.out.empty()) {
    write_output(options.out, render(answer, written_format(options)));
    answer = answer_beside(options.out, std::move(answer));
  }
  if (!options.summary.empty()) {
    append_output(options.summary, render(answer, Format::kMarkdown));
  }
  return answer;
}

void check_files(const CompareFlags& options) {
  if (!options.out.empty()) check_output(options.out, written_format(options));
  if (!options.summary.empty()) {  // it may hold anything, and keeps it
    check_name(options.summary, Format::kMarkdown);
    check_output(options.summary);
  }
}

Answer answer(CompareFlags options) {
  const Format written = written_format(options);
  check_files(options);
  const bool judges = options.accept.empty() && options.by.empty();
  if (!judges && written == Format::kJunit) {
    throw UsageError(
        fmt::format("{}: test cases are of a gate, expected another ending with --by or --accept",
                    options.out.string()));
  }
  if (!judges) choose_method(options);
  Answer answer = judges                   ? compare_or_refuse(options)
                  : options.accept.empty() ? difference_by(options)
                                           : accept_newer(options);
  answer = kept(options, std::move(answer));
  return options.quiet && judges && answer.exit_code == 0 ? Answer{} : answer;
}

constexpr const char* kOutFlags = "-o,--out";

}  // namespace

void keep_failure_of_compare(std::vector<std::string> arguments, const Failure& failure) {
  CompareFlags options;
  CLI::App files;
  files.allow_extras();
  files.add_option(kOutFlags, options.out);
  files.add_option("--summary", options.summary);
  try {
    std::ranges::reverse(arguments);  // as CLI11 expects them
    files.parse(std::move(arguments));
    check_files(options);
    // Stdout is for answers alone.
    if (names_stdout(options.out)) options.out.clear();
    if (names_stdout(options.summary)) options.summary.clear();
    kept(options, refusal(failure));
  } catch (const std::exception&) {  // the failure itself is told anyway
  }
}

CommandRun add_compare(CLI::App& command) {
  auto options = std::make_shared<CompareFlags>();
  add(command, "BASELINE DIR", options->baseline, "Accepted results")->required();
  add(command, "NEW DIR", options->newer, "Results to judge")->required();
  add(command, "--max-drop", options->max_drop_points, "Percentage points of IoU that may be lost")
      ->check(number_in(0.0, 100.0))
      ->capture_default_str();
  add(command, "--max-added-fp", options->max_added_false_positives,
      "False positives per scan that may be added (10 where nothing moves)")
      ->check(number_in(0.0, 1e9));
  const auto limit_cost = [options](const std::string& text) {
    options->max_cost = cost_limits("--max-cost", text);
  };
  add(command, "--max-cost KEY=PERCENT,...", limit_cost,
      "Percents by which cpu, memory and bytes may grow; else they only warn");
  command.add_flag("--statistical", options->statistical,
                   "A drop must also exceed what its 95 % interval leaves open");
  command.add_flag("--even-if", options->even_if, "Also compare results of different kinds");
  add_stale_flag(command, options->allow_stale);
  add_list(
      command, "--by WHAT,...", options->by,
      "Judge nothing; show what NEW changes in each sequence, or on which scans and objects the "
      "two disagree")
      ->check(CLI::IsMember({"sequence", "scan", "object"}));
  add(command, "--data DIR", options->data,
      "Data set of both, for --by object (default: where BASELINE read it)");
  add_dataset_kind_flag(command, options->dataset)->group(kRareGroup);
  add(command, "--top", options->top, "How many scans and objects --by lists")
      ->check(CLI::Range(std::size_t{0}, std::size_t{1000000}))
      ->capture_default_str()
      ->group(kRareGroup);
  command.add_flag("--accept", options->accept,
                   "Make NEW the baseline; --accept=WHY keeps why and when");
  add_list(command, "--sequences NAMES", options->sequences,
           "Judge or accept these sequences only");
  add(command, "--method NAME", options->method,
      "Judge or accept this method only, where folders hold several");
  add(command, fmt::format("{} FILE", kOutFlags), options->out,
      "Also write the answer to FILE: .md, .html, .json, or .xml for JUnit");
  add(command, "--summary FILE", options->summary, "Also append the answer in markdown to FILE");
  command.add_flag("-q,--quiet", options->quiet, "Print nothing when it passes");
  return [options] { return answer(*options); };
}

}  // namespace mosbench
