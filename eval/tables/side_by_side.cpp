#include <fmt/format.h>

#include "eval/answer/answer_text.hpp"
#include "eval/protocols/metrics.hpp"
#include "eval/protocols/protocol.hpp"
#include "eval/result/result_set.hpp"
#include "eval/tables/score_report.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

/// Summary of all scored scans under one protocol.
struct ProtocolRow {
  std::string name;
  RangeGate range;
  Summary summary;
  std::string reason;
};

std::string why(const ProtocolDescription& words, const ScoreRule& rule, const Confusion& pooled) {
  std::string text = words.aggregation;
  if (pooled.ignored > 0) {
    text += fmt::format(
        "; ignores {:.1f} % of the points",
        100.0 * static_cast<double>(pooled.ignored) / static_cast<double>(pooled.points()));
  } else {
    text += "; ignores no point";
  }
  text += fmt::format("; moving truth {} points", pooled.tp + pooled.fn);
  if (rule.protocol->range_rule == RangeRule::kTruthOnly) {
    text += fmt::format("; truth beyond {:g} to {:g} m static, predictions there count",
                        rule.range.min_m, rule.range.max_m);
  } else if (rule.protocol->range_rule == RangeRule::kTruthAndPrediction) {
    text += fmt::format("; only points {}", counted_range_text(*rule.protocol, rule.range));
  }
  if (!rule.protocol->default_split.empty()) {
    text += fmt::format("; published over split {} alone", rule.protocol->default_split);
  }
  return text + fmt::format("; truth ids: {}; 0/0 gives {}", words.truth, words.empty_case);
}

Summary summary_of(const Protocol& protocol, const std::vector<SequenceScores>& scores,
                   std::size_t rule) {
  std::vector<Confusion> all;
  std::vector<Summary> sequences;
  for (const SequenceScores& sequence : scores) {
    std::vector<Confusion> counts;
    for (const ScanRow& row : sequence.by_rule[rule]) counts.push_back(*row.counts);
    if (counts.empty()) continue;
    sequences.push_back(summarize(protocol, counts));
    all.insert(all.end(), counts.begin(), counts.end());
  }
  return protocol.aggregation == Aggregation::kMeanOfSequences
             ? mean_of_sequences(protocol, sequences)
             : summarize(protocol, all);
}

std::vector<ProtocolRow> protocol_rows(const std::vector<ScoreRule>& rules,
                                       const std::vector<SequenceScores>& scores) {
  const std::vector<ProtocolDescription> words = describe_protocols();
  std::vector<ProtocolRow> rows;
  for (std::size_t r = 0; r < rules.size(); ++r) {
    ProtocolRow row{std::string(rules[r].protocol->name), rules[r].range,
                    summary_of(*rules[r].protocol, scores, r), ""};
    const auto described = std::ranges::find(words, row.name, &ProtocolDescription::name);
    row.reason = why(*described, rules[r], row.summary.pooled);
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

Answer side_by_side_answer(const Dataset& dataset, const std::vector<ScoreRule>& rules,
                           const std::vector<SequenceScores>& scores) {
  Sheet sheet{.lead = {"the same labels by every protocol, over all scored scans"},
              .columns = {{"protocol", Unit::kText},
                          {"IoU", Unit::kPercent},
                          {"benchmark's rounding"},
                          {"TP"},
                          {"FP"},
                          {"FN"},
                          {"why", Unit::kText}},
              .notes = score_remarks(dataset, scores)};
  for (const ProtocolRow& row : protocol_rows(rules, scores)) {
    const Confusion& pooled = row.summary.pooled;
    sheet.rows.push_back({row.name, or_undefined(row.summary[Metric::kIou]),
                          row.summary.published_text, pooled.tp, pooled.fp, pooled.fn, row.reason});
  }
  return {.standing = standing_of(dataset, scores),
          .sheets = {std::move(sheet)},
          .json = json_text(side_by_side_json(dataset, rules, scores))};
}

ordered_json side_by_side_json(const Dataset& dataset, const std::vector<ScoreRule>& rules,
                               const std::vector<SequenceScores>& scores) {
  ordered_json json = {{"dataset", std::string(to_string(dataset.kind))},
                       {"protocols", ordered_json::array()},
                       {"remarks", all_remarks(dataset, scores)}};
  if (const auto origin = simulated_origin_json(dataset)) json["simulated"] = *origin;
  for (const ProtocolRow& row : protocol_rows(rules, scores)) {
    ordered_json protocol = {{"name", row.name},
                             {"min_range_m", row.range.min_m},
                             {"max_range_m", row.range.max_m},
                             {"iou", json_or_null(row.summary[Metric::kIou])},
                             {"published_text", row.summary.published_text}};
    protocol.update(counts_json(row.summary.pooled));
    protocol["why"] = row.reason;
    json["protocols"].push_back(std::move(protocol));
  }
  return json;
}

}  // namespace mosbench
