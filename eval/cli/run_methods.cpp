#include "eval/cli/run_methods.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "datasets/files/errors.hpp"
#include "eval/cli/failure.hpp"
#include "eval/cli/run_report.hpp"
#include "eval/results/answer_text.hpp"
#include "eval/results/tell.hpp"
#include "eval/runs/method_choice.hpp"
#include "eval/runs/run_execute.hpp"

namespace mosbench {
namespace {

/// What became of one method of the list.
struct MethodOutcome {
  const RunPlan* plan;
  std::vector<SequenceOutcome> sequences;
  std::optional<Failure> failure;
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

std::vector<RunPlan> plan_methods(const RunOptions& options, const MethodChoice& choice) {
  std::vector<RunPlan> plans;
  for (const std::string& name : choice.names) {
    RunOptions one = options;
    one.method = name;
    one.one_of_several = true;
    one.assignments = assignments_for(name, choice, options.assignments);
    try {
      plans.push_back(plan_run(one));
    } catch (const UsageError& error) {
      throw UsageError(fmt::format("method {}: {}", name, error.what()));
    }
  }
  return plans;
}

MethodOutcome execute(const RunPlan& plan) {
  MethodOutcome outcome{&plan, {}, std::nullopt};
  try {
    outcome.sequences = execute_run(plan);
  } catch (...) {
    outcome.failure = current_failure();
    tell(fmt::format("mosbench: method {} failed: {}", plan.settings.method->name,
                     outcome.failure->message));
  }
  return outcome;
}

std::string text_of(const std::vector<MethodOutcome>& outcomes) {
  std::string text, failures;
  for (const MethodOutcome& outcome : outcomes) {
    if (outcome.failure) {
      failures += fmt::format("method {} failed: {}\n", outcome.plan->settings.method->name,
                              outcome.failure->message);
    } else {
      text += run_report_text(*outcome.plan, outcome.sequences) + '\n';
    }
  }
  return text + failures;
}

nlohmann::ordered_json json_of(const MethodOutcome& outcome) {
  if (!outcome.failure) return run_report_json(*outcome.plan, outcome.sequences);
  return {{"method", std::string(outcome.plan->settings.method->name)},
          {"out", outcome.plan->out.string()},
          {"failure", outcome.failure->message}};
}

std::string json_of(const std::vector<MethodOutcome>& outcomes) {
  nlohmann::ordered_json methods = nlohmann::ordered_json::array();
  for (const MethodOutcome& outcome : outcomes) methods.push_back(json_of(outcome));
  return json_text({{"methods", methods}});
}

}  // namespace

Answer run_methods(const RunOptions& options) {
  const MethodChoice choice = chosen_methods(*options.method);
  for (const std::string& note : choice.notes) tell(note);
  const std::vector<RunPlan> plans = plan_methods(options, choice);
  std::vector<MethodOutcome> outcomes;
  int exit_code = 0;
  for (const RunPlan& plan : plans) {
    tell(fmt::format("method {} ({} of {})", plan.settings.method->name, outcomes.size() + 1,
                     plans.size()));
    outcomes.push_back(execute(plan));
    if (exit_code == 0 && outcomes.back().failure) exit_code = outcomes.back().failure->exit_code;
  }
  return {options.json ? json_of(outcomes) : text_of(outcomes), exit_code};
}

}  // namespace mosbench
