#include "eval/cli/run_methods.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "datasets/text/errors.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/cli/failure.hpp"
#include "eval/cli/run_report.hpp"
#include "eval/engine/run_execute.hpp"
#include "eval/job/method_choice.hpp"
#include "eval/report/written_products.hpp"
#include "eval/result/result_set.hpp"
#include "eval/result/tell.hpp"

namespace mosbench {
namespace {

/// One method of the list.
struct MethodRun {
  const RunPlan* plan;
  std::unique_ptr<RunExecution> execution;
  std::optional<Failure> failure;  ///< nothing is done after it
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

std::vector<RunPlan> plan_methods(const JobWords& words, const RunPlace& place,
                                  const MethodChoice& choice) {
  std::vector<RunPlan> plans;
  RunPlace shared = place;
  shared.shared = std::make_shared<SharedReading>();
  for (const std::string& name : choice.names) {
    JobWords one = words;
    one.method = name;
    one.assignments = assignments_for(name, choice, words.assignments);
    try {
      plans.push_back(plan_run(job_of(one), shared));
    } catch (const UsageError& error) {
      throw UsageError(fmt::format("method {}: {}", name, error.what()));
    }
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

std::vector<Sheet> sheets_of(const std::vector<MethodRun>& runs) {
  std::vector<Sheet> sheets;
  std::vector<std::string> failures;
  for (const MethodRun& run : runs) {
    if (run.failure) {
      failures.push_back(fmt::format("method {} failed: {}", run.plan->settings.method->name,
                                     run.failure->message));
    } else {
      sheets.push_back(run_sheet(*run.plan, run.execution->outcomes()));
    }
  }
  if (!failures.empty()) sheets.push_back({.notes = std::move(failures)});
  return sheets;
}

nlohmann::ordered_json json_of(const MethodRun& run) {
  if (!run.failure) return run_report_json(*run.plan, run.execution->outcomes());
  return {{"method", std::string(run.plan->settings.method->name)},
          {"out", run.plan->out.string()},
          {"failure", run.failure->message}};
}

std::string json_of(const std::vector<MethodRun>& runs) {
  nlohmann::ordered_json methods = nlohmann::ordered_json::array();
  for (const MethodRun& run : runs) methods.push_back(json_of(run));
  return json_text({{"methods", methods}});
}

}  // namespace

Answer run_methods(const JobWords& words, const RunPlace& place,
                   std::span<const std::string> products) {
  const MethodChoice choice = chosen_methods(*words.method);
  for (const std::string& note : choice.notes) tell(note);
  const std::vector<RunPlan> plans = plan_methods(words, place, choice);
  std::vector<MethodRun> runs = execute(plans);
  for (MethodRun& run : runs) {
    attempt(run, [&] {
      for (const SequenceOutcome& done : run.execution->outcomes()) {
        write_products(done.folder, products);
      }
    });
  }
  const auto failed =
      std::ranges::find_if(runs, [](const MethodRun& run) { return run.failure.has_value(); });
  return {.exit_code = failed == runs.end() ? 0 : failed->failure->exit_code,
          .standing = standing_of(plans.front().dataset),
          .sheets = sheets_of(runs),
          .json = json_of(runs)};
}

}  // namespace mosbench
