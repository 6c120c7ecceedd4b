#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "datasets/text/errors.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/run_kinds.hpp"
#include "eval/engine/run_execute.hpp"
#include "eval/job/method_choice.hpp"
#include "eval/protocols/metrics.hpp"
#include "eval/protocols/protocol.hpp"
#include "eval/report/label_products.hpp"
#include "eval/report/score_curve.hpp"
#include "eval/result/result.hpp"
#include "eval/result/result_file.hpp"
#include "eval/result/settings_json.hpp"
#include "eval/result/tell.hpp"
#include "eval/tables/curve_report.hpp"
#include "eval/tables/score_report.hpp"

namespace mosbench {
namespace {

std::vector<SummaryRow> rows_of(const RunPlan& plan, const std::vector<SequenceOutcome>& outcomes) {
  std::vector<ScoredSequence> sequences;
  for (const auto& [result, folder, reused] : outcomes) {
    sequences.push_back({result.sequence.text(), result.scans, method_ms_per_scan(result)});
  }
  return summary_rows(*plan.settings.protocol, plan.dataset.splits, sequences);
}

ResultSet results_of(const std::vector<SequenceOutcome>& outcomes) {
  ResultSet set;
  for (const SequenceOutcome& outcome : outcomes) set.sequences.push_back(outcome.result);
  return set;
}

bool has_truth(const std::vector<SequenceOutcome>& outcomes) {
  return std::ranges::any_of(outcomes, [](const SequenceOutcome& outcome) {
    return std::ranges::any_of(outcome.result.scans,
                               [](const ScanRow& row) { return row.counts.has_value(); });
  });
}

/// Without truth there is nothing to score, but still something to look at.
void add_moving_points(const std::vector<SequenceOutcome>& outcomes, Sheet& sheet) {
  sheet.lead.emplace_back("no scan has truth: nothing to score");
  sheet.columns = {{"sequence", Unit::kText},
                   {"scans"},
                   {"points"},
                   {"moving"},
                   {"moving", Unit::kPercent, 2},
                   {"ms/scan", Unit::kNumber, 1}};
  for (const auto& [result, folder, reused] : outcomes) {
    const auto [points, moving] = moving_points(result);
    const auto all = static_cast<double>(std::max<std::uint64_t>(points, 1));
    sheet.rows.push_back({result.sequence.text(), std::uint64_t{result.scans.size()}, points,
                          moving, static_cast<double>(moving) / all,
                          method_ms_per_scan(result).value_or(0.0)});
  }
}

std::string method_line(const RunPlan& plan) {
  const RunSettings& settings = plan.settings;
  return fmt::format(
      "{}, preset {}: {}", settings.method->title, plan.preset,
      describe_settings(RecordedSettings(settings.method_settings), settings.method->name));
}

/// Of a run that kept scores of points with truth.
std::optional<ScoreCurve> curve_of(const RunPlan& plan,
                                   const std::vector<SequenceOutcome>& outcomes) {
  if (!plan.settings.point_files().scores || !has_truth(outcomes)) return std::nullopt;
  std::vector<Result> results;
  for (const SequenceOutcome& outcome : outcomes) {
    Result& result = results.emplace_back(read_result(outcome.folder / "result.json"));
    // An earlier run may have read the same scans elsewhere.
    if (result.places) result.places->reading = plan.job.data.reading;
  }
  return curve_of_results(results, plan.dataset.root);
}

/// How it was run, the table, the remarks on each sequence.
Sheet run_sheet(const RunPlan& plan, const std::vector<SequenceOutcome>& outcomes,
                const std::optional<ScoreCurve>& curve) {
  const bool scored = has_truth(outcomes);
  Sheet sheet = score_sheet({plan.settings.protocol, plan.settings.range}, plan.dataset.splits,
                            scored ? rows_of(plan, outcomes) : std::vector<SummaryRow>());
  sheet.lead.insert(sheet.lead.begin(), {fmt::format("{} data set {}", to_string(plan.dataset.kind),
                                                     plan.dataset.root.string()),
                                         method_line(plan)});
  if (!scored) add_moving_points(outcomes, sheet);
  if (curve) sheet.notes = curve_lines(*curve);
  for (const auto& [result, folder, reused] : outcomes) {
    for (const std::string& remark : result.remarks) {
      sheet.notes.push_back(fmt::format("{}: {}", result.sequence.text(), remark));
    }
  }
  sheet.notes.push_back(fmt::format("results in {}", plan.out.string()));
  return sheet;
}

/// The same as one JSON object.
nlohmann::ordered_json run_report_json(const RunPlan& plan,
                                       const std::vector<SequenceOutcome>& outcomes,
                                       const std::optional<ScoreCurve>& curve) {
  nlohmann::ordered_json json = {{"dataset", std::string(to_string(plan.dataset.kind))},
                                 {"method", std::string(plan.settings.method->name)},
                                 {"preset", plan.preset}};
  json.update(rule_json({plan.settings.protocol, plan.settings.range}));
  json["config"] = to_json(plan.settings.method_settings);
  json["out"] = plan.out.string();
  if (const auto origin = simulated_origin_json(plan.dataset)) json["simulated"] = *origin;
  json.update(rows_json(rows_of(plan, outcomes)));
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const auto [points, moving] = moving_points(outcomes[i].result);
    json["sequences"][i].update({{"folder", outcomes[i].folder.string()},
                                 {"points", points},
                                 {"predicted_moving_points", moving},
                                 {"reused", outcomes[i].reused},
                                 {"remarks", outcomes[i].result.remarks},
                                 {"doubts", doubts_of(outcomes[i].result)}});
  }
  if (curve) json["confidences"] = curve_summary_json(*curve);
  return json;
}

/// One method of the list.
struct MethodRun {
  const RunPlan* plan;
  std::unique_ptr<RunExecution> execution;
  std::optional<Failure> failure;  ///< nothing is done after it
  std::optional<ScoreCurve> curve{};
};

/// Returns the settings of one method: those for all, and "underwood.references=3" for itself.
std::vector<std::string> assignments_for(const std::string& method, const MethodChoice& choice,
                                         const std::vector<std::string>& assignments) {
  std::vector<std::string> own;
  std::vector<std::string_view> known;
  for (const std::string& name : choice.names) known.push_back(method_named(name).name);
  for (const std::string& assignment : assignments) {
    const std::size_t dot = assignment.find('.');
    if (dot == std::string::npos || dot > assignment.find('=')) {
      own.push_back(assignment);
      continue;
    }
    const std::string named = assignment.substr(0, dot);
    if (named == method_named(method).name) own.push_back(assignment.substr(dot + 1));
    if (std::ranges::find(known, named) != known.end()) continue;
    throw UsageError(fmt::format("--set {}: method '{}' is not run, expected one of {}", assignment,
                                 named, fmt::join(known, ", ")));
  }
  return own;
}

/// Plans the methods that take the data, and notes the others; throws if there is none.
std::vector<RunPlan> plan_methods(const JobWords& words, const RunPlace& place,
                                  MethodChoice& choice) {
  std::vector<RunPlan> plans;
  std::vector<std::string> refusing;
  RunPlace shared = place;
  shared.shared = std::make_shared<SharedReading>();
  for (const std::string& name : choice.names) {
    JobWords one = words;
    one.method = name;
    one.assignments = assignments_for(name, choice, words.assignments);
    try {
      plans.push_back(plan_run(job_of(one), shared));
    } catch (const RefusedRig&) {
      refusing.push_back(name);
      if (refusing.size() == choice.names.size()) throw;
    } catch (const UsageError& error) {
      throw UsageError(fmt::format("method {}: {}", name, error.what()));
    }
  }
  if (!refusing.empty()) {
    choice.notes.push_back(
        fmt::format("left out: {}, which look from one place, not from several LiDARs",
                    fmt::join(refusing, ", ")));
  }
  return plans;
}

/// Does a part of a run that did not fail before.
template <typename Part>
void attempt(MethodRun& run, Part&& part) {
  if (run.failure) return;
  try {
    part();
  } catch (...) {
    run.failure = current_failure();
    tell(fmt::format("mosbench: method {} failed: {}", run.plan->settings.method->name,
                     run.failure->message));
  }
}

std::vector<MethodRun> execute(const std::vector<RunPlan>& plans) {
  std::vector<MethodRun> runs;
  for (const RunPlan& plan : plans) {
    tell(fmt::format("method {} ({} of {})", plan.settings.method->name, runs.size() + 1,
                     plans.size()));
    runs.push_back({&plan, nullptr, std::nullopt});
    MethodRun& run = runs.back();
    attempt(run, [&] { run.execution = std::make_unique<RunExecution>(plan); });
  }
  const RunPlan& first = plans.front();
  for (const PlannedSequence& planned : first.sequences) {
    for (MethodRun& run : runs) {
      attempt(run, [&] { run.execution->advance(); });
    }
    first.shared->forget(planned.position);
  }
  return runs;
}

/// `notes` are on methods that are left out; those on methods that failed are added.
std::vector<Sheet> sheets_of(const std::vector<MethodRun>& runs, std::vector<std::string> notes) {
  std::vector<Sheet> sheets;
  for (const MethodRun& run : runs) {
    if (run.failure) {
      notes.push_back(fmt::format("method {} failed: {}", run.plan->settings.method->name,
                                  run.failure->message));
    } else {
      sheets.push_back(run_sheet(*run.plan, run.execution->outcomes(), run.curve));
    }
  }
  if (!notes.empty()) sheets.push_back({.notes = std::move(notes)});
  return sheets;
}

/// Of all methods that did not fail; else of the data.
Standing standing_of(const std::vector<MethodRun>& runs) {
  std::optional<Standing> all;
  std::vector<Doubt> doubts;
  for (const MethodRun& run : runs) {
    if (run.failure) continue;
    all = standing_of(results_of(run.execution->outcomes()));
    for (std::string& doubt : all->doubts) {
      doubts.push_back({std::string(run.plan->settings.method->name), std::move(doubt)});
    }
  }
  if (!all) return standing_of(runs.front().plan->dataset);
  all->doubts = told(doubts);
  return *all;
}

nlohmann::ordered_json json_of(const MethodRun& run) {
  if (!run.failure) return run_report_json(*run.plan, run.execution->outcomes(), run.curve);
  return {{"method", std::string(run.plan->settings.method->name)},
          {"out", run.plan->out.string()},
          {"failure", run.failure->message}};
}

/// Sequence by sequence, the methods one after the other. What is wrong before the first scan is
/// thrown; a method that fails later is named in the answer, whose exit code is that of the first
/// failure.
Answer run_methods(const JobWords& words, const RunPlace& place,
                   std::span<const std::string> products) {
  MethodChoice choice = chosen_methods(*words.method);
  const std::vector<RunPlan> plans = plan_methods(words, place, choice);
  std::vector<MethodRun> runs = execute(plans);
  for (MethodRun& run : runs) {
    attempt(run, [&] {
      for (const SequenceOutcome& done : run.execution->outcomes()) {
        write_products(done.folder, products);
      }
      run.curve = curve_of(*run.plan, run.execution->outcomes());
    });
  }
  nlohmann::ordered_json methods = nlohmann::ordered_json::array();
  for (const MethodRun& run : runs) methods.push_back(json_of(run));
  nlohmann::ordered_json json = {{"methods", methods}};
  if (!choice.notes.empty()) json["notes"] = choice.notes;
  const auto failed =
      std::ranges::find_if(runs, [](const MethodRun& run) { return run.failure.has_value(); });
  return {.exit_code = failed == runs.end() ? 0 : failed->failure->exit_code,
          .standing = standing_of(runs),
          .sheets = sheets_of(runs, choice.notes),
          .json = json_text(json)};
}

}  // namespace

std::pair<std::uint64_t, std::uint64_t> moving_points(const Result& result) {
  std::uint64_t points = 0, moving = 0;
  for (const ScanRow& row : result.scans) {
    points += row.points;
    moving += row.predicted_moving_points;
  }
  return {points, moving};
}

Answer run_data(const JobWords& words, const RunPlace& place,
                std::span<const std::string> products) {
  if (words.method && names_several_methods(*words.method)) {
    return run_methods(words, place, products);
  }
  const RunPlan plan = plan_run(job_of(words), place);
  const std::vector<SequenceOutcome> outcomes = execute_run(plan);
  for (const SequenceOutcome& outcome : outcomes) write_products(outcome.folder, products);
  const std::optional<ScoreCurve> curve = curve_of(plan, outcomes);
  return {.standing = standing_of(results_of(outcomes)),
          .sheets = {run_sheet(plan, outcomes, curve)},
          .json = json_text(run_report_json(plan, outcomes, curve))};
}

}  // namespace mosbench
