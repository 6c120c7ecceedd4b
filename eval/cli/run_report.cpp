#include "eval/cli/run_report.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "eval/protocols/protocol.hpp"
#include "eval/result/result_set.hpp"
#include "eval/result/settings_json.hpp"
#include "eval/tables/score_report.hpp"

namespace mosbench {
namespace {

std::vector<SummaryRow> rows_of(const RunPlan& plan, const std::vector<SequenceOutcome>& outcomes) {
  std::vector<ScoredSequence> sequences;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const Result& result = outcomes[i].result;
    sequences.push_back(
        {plan.dataset.sequences[i]->name(), result.scans, method_ms_per_scan(result)});
  }
  return summary_rows(*plan.settings.protocol, plan.dataset.splits, sequences);
}

bool has_truth(const std::vector<SequenceOutcome>& outcomes) {
  return std::ranges::any_of(outcomes, [](const SequenceOutcome& outcome) {
    return std::ranges::any_of(outcome.result.scans,
                               [](const ScanRow& row) { return row.counts.has_value(); });
  });
}

/// How much of a sequence the method labelled moving.
struct MovingPoints {
  std::size_t points = 0, moving = 0;
};

MovingPoints moving_points(const Result& result) {
  MovingPoints counts;
  for (const ScanRow& row : result.scans) {
    counts.points += row.points;
    counts.moving += row.predicted_moving_points;
  }
  return counts;
}

/// Without truth there is nothing to score, but still something to look at.
void add_moving_points(const RunPlan& plan, const std::vector<SequenceOutcome>& outcomes,
                       Sheet& sheet) {
  sheet.lead.emplace_back("no scan has truth: nothing to score");
  sheet.columns = {{"sequence", Unit::kText},
                   {"scans"},
                   {"points"},
                   {"moving"},
                   {"moving", Unit::kPercent, 2},
                   {"ms/scan", Unit::kNumber, 1}};
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const Result& result = outcomes[i].result;
    const auto [points, moving] = moving_points(result);
    sheet.rows.push_back(
        {plan.dataset.sequences[i]->name(), std::uint64_t{result.scans.size()},
         std::uint64_t{points}, std::uint64_t{moving},
         static_cast<double>(moving) / static_cast<double>(std::max<std::size_t>(points, 1)),
         method_ms_per_scan(result).value_or(0.0)});
  }
}

std::string method_line(const RunPlan& plan) {
  const RunSettings& settings = plan.settings;
  return fmt::format(
      "{}, preset {}: {}", settings.method->title, plan.preset,
      describe_settings(RecordedSettings(settings.method_settings), settings.method->name));
}

}  // namespace

Sheet run_sheet(const RunPlan& plan, const std::vector<SequenceOutcome>& outcomes) {
  const bool scored = has_truth(outcomes);
  Sheet sheet = score_sheet({plan.settings.protocol, plan.settings.range}, plan.dataset.splits,
                            scored ? rows_of(plan, outcomes) : std::vector<SummaryRow>());
  sheet.lead.insert(sheet.lead.begin(), {fmt::format("{} data set {}", to_string(plan.dataset.kind),
                                                     plan.dataset.root.string()),
                                         method_line(plan)});
  if (!scored) add_moving_points(plan, outcomes, sheet);
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    for (const std::string& remark : outcomes[i].result.remarks) {
      sheet.notes.push_back(fmt::format("{}: {}", plan.dataset.sequences[i]->name(), remark));
    }
  }
  sheet.notes.push_back(fmt::format("results in {}", plan.out.string()));
  return sheet;
}

nlohmann::ordered_json run_report_json(const RunPlan& plan,
                                       const std::vector<SequenceOutcome>& outcomes) {
  nlohmann::ordered_json json = {{"dataset", std::string(to_string(plan.dataset.kind))},
                                 {"method", std::string(plan.settings.method->name)},
                                 {"preset", plan.preset},
                                 {"protocol", std::string(plan.settings.protocol->name)},
                                 {"min_range_m", plan.settings.range.min_m},
                                 {"max_range_m", plan.settings.range.max_m},
                                 {"config", to_json(plan.settings.method_settings)},
                                 {"out", plan.out.string()}};
  if (const auto origin = simulated_origin_json(plan.dataset)) json["simulated"] = *origin;
  json.update(rows_json(rows_of(plan, outcomes)));
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    json["sequences"][i]["folder"] = outcomes[i].folder.string();
    const auto [points, moving] = moving_points(outcomes[i].result);
    json["sequences"][i]["points"] = points;
    json["sequences"][i]["predicted_moving_points"] = moving;
    json["sequences"][i]["reused"] = outcomes[i].reused;
    json["sequences"][i]["remarks"] = outcomes[i].result.remarks;
  }
  return json;
}

}  // namespace mosbench
