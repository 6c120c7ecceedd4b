#include "eval/cli/run_report.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "eval/answer/answer_text.hpp"
#include "eval/answer/text_table.hpp"
#include "eval/protocols/protocol_list.hpp"
#include "eval/results/settings_json.hpp"
#include "eval/results/simulated.hpp"
#include "eval/tables/score_table.hpp"

namespace mosbench {
namespace {

std::vector<ScoredSequence> scored(const RunPlan& plan,
                                   const std::vector<SequenceOutcome>& outcomes) {
  std::vector<ScoredSequence> sequences;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    ScoredSequence& sequence = sequences.emplace_back();
    sequence.name = plan.dataset.sequences[i]->name();
    sequence.method_ms_per_scan = method_ms_per_scan(outcomes[i].rows);
    for (const ScanRow& row : outcomes[i].rows.scans) {
      sequence.scans.push_back({row.stem, row.counts});
    }
  }
  return sequences;
}

std::vector<SummaryRow> rows_of(const RunPlan& plan, const std::vector<SequenceOutcome>& outcomes) {
  return summary_rows(*plan.settings.protocol, plan.dataset.splits, scored(plan, outcomes));
}

bool has_truth(const std::vector<SequenceOutcome>& outcomes) {
  return std::ranges::any_of(outcomes, [](const SequenceOutcome& outcome) {
    return std::ranges::any_of(outcome.rows.scans,
                               [](const ScanRow& row) { return row.counts.has_value(); });
  });
}

/// How much of a sequence the method labelled moving.
struct MovingPoints {
  std::size_t points = 0, moving = 0;
};

MovingPoints moving_points(const SequenceRows& rows) {
  MovingPoints counts;
  for (const ScanRow& row : rows.scans) {
    counts.points += row.points;
    counts.moving += row.predicted_moving_points;
  }
  return counts;
}

/// Without truth there is nothing to score, but still something to look at.
std::string moving_points_text(const RunPlan& plan, const std::vector<SequenceOutcome>& outcomes) {
  TextTable table({{"sequence", TextTable::kLeft},
                   {"scans"},
                   {"points"},
                   {"labelled moving"},
                   {"%"},
                   {"ms/scan"}});
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const SequenceRows& rows = outcomes[i].rows;
    const auto [points, moving] = moving_points(rows);
    const auto share =
        static_cast<double>(moving) / static_cast<double>(std::max<std::size_t>(points, 1));
    table.add_row({plan.dataset.sequences[i]->name(), fmt::format("{}", rows.scans.size()),
                   fmt::format("{}", points), fmt::format("{}", moving),
                   percent_text(share, "{:.2f}"),
                   fmt::format("{:.1f}", method_ms_per_scan(rows).value_or(0.0))});
  }
  return "no scan has truth: nothing to score\n\n" + table.str();
}

std::string method_line(const RunPlan& plan) {
  const RunSettings& settings = plan.settings;
  return fmt::format("{}, preset {}: {}", settings.method->title, plan.preset,
                     describe_settings(to_json(settings.method_settings), settings.method->name));
}

}  // namespace

std::string run_report_text(const RunPlan& plan, const std::vector<SequenceOutcome>& outcomes) {
  std::string text = fmt::format("{} data set {}\n{}\n{}\n", to_string(plan.dataset.kind),
                                 plan.dataset.root.string(), method_line(plan),
                                 rule_line({plan.settings.protocol, plan.settings.range}));
  const bool scored = has_truth(outcomes);
  if (scored) text += benchmark_remark(*plan.settings.protocol, plan.dataset.splits);
  text += simulated_remark(plan.dataset);
  text += scored ? '\n' + format_rows(rows_of(plan, outcomes)) : moving_points_text(plan, outcomes);
  text += '\n';
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    for (const std::string& remark : outcomes[i].remarks) {
      text += fmt::format("{}: {}\n", plan.dataset.sequences[i]->name(), remark);
    }
  }
  return text + fmt::format("results in {}\n", plan.out.string());
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
    const auto [points, moving] = moving_points(outcomes[i].rows);
    json["sequences"][i]["points"] = points;
    json["sequences"][i]["predicted_moving_points"] = moving;
    json["sequences"][i]["reused"] = outcomes[i].reused;
    json["sequences"][i]["remarks"] = outcomes[i].remarks;
  }
  return json;
}

}  // namespace mosbench
