#include "eval/tables/score_report.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "datasets/disk/files.hpp"
#include "datasets/disk/partial_file.hpp"
#include "datasets/doctor/doctor.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/protocols/benchmark_split.hpp"
#include "eval/protocols/protocol.hpp"
#include "eval/result/result_file.hpp"
#include "eval/result/result_json.hpp"
#include "eval/result/version.hpp"
#include "eval/tables/curve_report.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kNamedScans = 5;

std::vector<SummaryRow> table_rows(const Dataset& dataset, const ScoreRule& rule,
                                   const std::vector<SequenceScores>& scores, bool with_sequences) {
  std::vector<ScoredSequence> sequences;
  for (const SequenceScores& sequence : scores) {
    sequences.push_back(
        {dataset.sequences[sequence.position]->name(), sequence.by_rule.front(), std::nullopt});
  }
  std::vector<SummaryRow> rows = summary_rows(*rule.protocol, dataset.splits, sequences);
  if (!with_sequences) {
    std::erase_if(rows,
                  [](const SummaryRow& row) { return row.kind == SummaryRow::Kind::kSequence; });
  }
  return rows;
}

/// Names the scans without truth: a lost label file would show nowhere else.
std::string truth_remark(const Sequence& sequence) {
  std::string names;
  std::size_t without = 0;
  for (std::size_t k = 0; k < sequence.size(); ++k) {
    if (sequence.has_truth(k)) continue;
    if (++without <= kNamedScans) names += (names.empty() ? "" : ", ") + sequence.stem(k);
  }
  if (without == 0) return "";
  if (without > kNamedScans) names += ", ...";
  return fmt::format("{} of {} have no truth and are not scored: {}", without,
                     counted(sequence.size(), "scan"), names);
}

ScoredPredictions scored_predictions(const OpenedPredictions& opened) {
  return {std::string(describe(opened.format).name), opened.guessed, opened.path.string(),
          opened.missing, opened.remarks};
}

/// Returns the split that picks scans and to which scoring was limited.
std::optional<std::string> picked_split(const Dataset& dataset, const ScoreTask& task) {
  if (!task.split || !picks_scans(dataset.splits.front())) return std::nullopt;
  return task.split;
}

/// Returns it if it is not the protocol's own split.
std::optional<std::string> other_split(const Dataset& dataset, const ScoreTask& task) {
  const auto split = picked_split(dataset, task);
  return split == task.rules.front().protocol->default_split ? std::nullopt : split;
}

/// Throws UsageError unless a folder is absent or holds nothing but a result.json of scores.
void refuse_other_results(const std::filesystem::path& folder) {
  constexpr const char* kResultFile = "result.json";
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename();
    if (is_partial_of(name, kResultFile)) continue;
    if (name == kResultFile && read_result(entry.path()).predictions) continue;
    throw UsageError(
        entry.path().string() +
        ": was not written by mosbench score, expected --out to name a folder of its own");
  }
}

/// Throws UsageError where its file holds the scores of another question, or other scores.
void refuse_other_scores(const Result& result) {
  if (!is_there(result.file)) return;
  const auto said = [](const Result& scored) {
    ordered_json json = to_json(scored);
    for (const char* of_this_call : {"provenance", "places"}) json.erase(of_this_call);
    return json;
  };
  if (said(read_result(result.file)) == said(result)) return;
  throw UsageError(result.file.string() +
                   ": holds other scores, expected --overwrite, or --out to name another folder");
}

/// Where the predictions and their data set lie.
Places places_of(const Dataset& dataset, const Reading& reading, const ScoreTask& task,
                 PredictionFormat format) {
  Places places{std::filesystem::absolute(dataset.root),
                reading,
                PredictionSource{std::filesystem::absolute(task.predictions), task.options},
                "",
                {}};
  places.predictions->options.format = format;
  return places;
}

/// The scores of a sequence by the first rule.
Result scored_result(const Dataset& dataset, const ScoreRule& rule, const SequenceScores& scores) {
  const Sequence& sequence = *dataset.sequences[scores.position];
  Result result;
  result.sequence = SequenceName(sequence.name(), dataset.root);
  result.dataset = to_string(dataset.kind);
  result.protocol = rule.protocol;
  result.range = rule.range;
  result.from.version = kMosbenchVersion;
  result.from.reading = members_of(sequence.reading());
  result.from.simulated = sequence.simulated();
  result.doubts = doubts_of(sequence);
  for (const std::string& doubt : scores.opened->doubts) {
    const bool is_said = std::ranges::find(result.doubts, doubt) != result.doubts.end();
    if (!is_said) result.doubts.push_back(doubt);
  }
  result.method = scores.run ? scores.run->method : "unnamed";
  if (scores.run) {
    result.setting = scores.run->setting;
    result.from.program = scores.run->from.program;
    result.from.program_files = scores.run->from.program_files;
    result.settings_from = scores.run->settings_from;
  }
  result.predictions = scored_predictions(*scores.opened);
  result.splits = picked_stems(dataset, scores.position);
  result.scans = scores.by_rule.front();
  return result;
}

Standing standing_of(const Dataset& dataset, const ScoreRule& rule,
                     const std::vector<SequenceScores>& scores) {
  ResultSet set;
  for (const SequenceScores& sequence : scores) {
    if (sequence.opened) set.sequences.push_back(scored_result(dataset, rule, sequence));
  }
  return standing_of(set);
}

/// Summary of all scored scans under one protocol.
struct ProtocolRow {
  ScoreRule rule;
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
  const std::string unknown = unknown_ids_remark(*rule.protocol, pooled.unknown_ids);
  return text + fmt::format("; truth ids: {}; 0/0 gives {}{}{}", words.truth, words.empty_case,
                            unknown.empty() ? "" : "; ", unknown);
}

/// Of the scans that were scored.
Summary summary_of(const Protocol& protocol, const std::vector<SequenceScores>& scores,
                   std::size_t rule) {
  std::vector<SequenceCounts> sequences;
  for (const SequenceScores& sequence : scores) {
    if (sequence.by_rule[rule].empty()) continue;
    SequenceCounts& counts = sequences.emplace_back();
    for (const ScanRow& row : sequence.by_rule[rule]) counts.push_back(*row.counts);
  }
  return summary_of(protocol, sequences);
}

std::vector<ProtocolRow> protocol_rows(const std::vector<ScoreRule>& rules,
                                       const std::vector<SequenceScores>& scores) {
  const std::vector<ProtocolDescription> words = describe_protocols();
  std::vector<ProtocolRow> rows;
  for (std::size_t r = 0; r < rules.size(); ++r) {
    const auto described =
        std::ranges::find(words, rules[r].protocol->name, &ProtocolDescription::name);
    Summary summary = summary_of(*rules[r].protocol, scores, r);
    std::string reason = why(*described, rules[r], summary.pooled);
    rows.push_back({rules[r], std::move(summary), std::move(reason)});
  }
  return rows;
}

/// Of the confidences of all sequences, where the predictions have some and points move.
std::optional<ScoreCurve> curve_of(const std::vector<SequenceScores>& scores) {
  ScoreCounts counts;
  for (const SequenceScores& sequence : scores) {
    if (sequence.confidences) counts += *sequence.confidences;
  }
  return counts.curve();
}

}  // namespace

std::vector<std::string> score_remarks(const Dataset& dataset,
                                       const std::vector<SequenceScores>& scores) {
  std::vector<std::string> remarks;
  for (const SequenceScores& sequence : scores) {
    const Sequence& recorded = *dataset.sequences[sequence.position];
    const auto add = [&](const std::string& text) {
      remarks.push_back(recorded.name() + ": " + text);
    };
    if (const std::string text = truth_remark(recorded); !text.empty()) add(text);
    if (!sequence.opened) continue;
    const OpenedPredictions& opened = *sequence.opened;
    add(fmt::format("predictions in format {}{}: {}", describe(opened.format).name,
                    opened.guessed ? " (recognised; --format overrides)" : "",
                    opened.path.string()));
    for (const std::string& remark : opened.remarks) add(remark);
  }
  return remarks;
}

ordered_json rows_json(const std::vector<SummaryRow>& rows) {
  ordered_json json = {{"sequences", ordered_json::array()},
                       {"parts", ordered_json::array()},
                       {"splits", ordered_json::array()}};
  constexpr std::array kLists = {"sequences", "parts", "splits"};
  for (const SummaryRow& row : rows) {
    ordered_json object = {{"name", row.name}, {"scans", row.scans}};
    if (!row.split.empty()) object["split"] = row.split;
    object["summary"] = row.summary.scans == 0 ? nullptr : to_json(row.summary);
    if (row.method_ms_per_scan) object["method_ms_per_scan"] = *row.method_ms_per_scan;
    json[kLists.at(static_cast<std::size_t>(row.kind))].push_back(std::move(object));
  }
  return json;
}

Answer score_answer(const Dataset& dataset, const ScoreTask& task,
                    const std::vector<SequenceScores>& scores, bool with_sequences) {
  const ScoreRule& rule = task.rules.front();
  const std::vector<SummaryRow> rows = table_rows(dataset, rule, scores, with_sequences);
  Sheet sheet = score_sheet(rule, dataset.splits, rows);
  sheet.notes = score_remarks(dataset, scores);
  const std::optional<ScoreCurve> curve = curve_of(scores);
  if (curve) {
    const std::vector<std::string> lines = curve_lines(*curve);
    sheet.notes.insert(sheet.notes.begin(), lines.begin(), lines.end());
  }
  Standing standing = standing_of(dataset, rule, scores);
  if (const auto split = other_split(dataset, task)) {
    standing.doubts.push_back(split_warning(*split));
  }
  ordered_json json = {{"dataset", std::string(to_string(dataset.kind))}};
  json.update(rule_json(rule));
  if (const auto origin = simulated_origin_json(dataset)) json["simulated"] = *origin;
  json.update(rows_json(rows));
  json["predictions"] = ordered_json::object();
  for (const SequenceScores& sequence : scores) {
    if (!sequence.opened) continue;
    json["predictions"][dataset.sequences[sequence.position]->name()] =
        to_json(scored_predictions(*sequence.opened));
  }
  if (curve) json["confidences"] = curve_summary_json(*curve);
  json["remarks"] = sheet.notes;
  for (const std::string& doubt : standing.doubts) json["remarks"].push_back(doubt);
  return {.standing = std::move(standing), .sheets = {std::move(sheet)}, .json = json_text(json)};
}

void check_scored_folders(const Dataset& dataset, const std::filesystem::path& out) {
  for (const auto& sequence : dataset.sequences) refuse_other_results(out / sequence->name());
}

void write_scores(const Dataset& dataset, const Reading& reading, const ScoreTask& task,
                  const std::optional<MethodName>& method,
                  const std::vector<SequenceScores>& scores, const std::filesystem::path& out,
                  bool overwrite) {
  std::vector<Result> results;
  for (const SequenceScores& sequence : scores) {
    if (!sequence.opened) continue;
    Result& result = results.emplace_back(scored_result(dataset, task.rules.front(), sequence));
    if (method) {
      result.method = method->name;
      result.setting = method->setting;
    }
    result.summary_split = picked_split(dataset, task);
    result.places = places_of(dataset, reading, task, sequence.opened->format);
    result.file = out / result.sequence.folder() / "result.json";
    if (!overwrite) refuse_other_scores(result);
  }
  for (const Result& result : results) commit_file(result.file, format_result(result));
}

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
    sheet.rows.push_back({std::string(row.rule.protocol->name),
                          or_undefined(row.summary[Metric::kIou]), row.summary.published_text,
                          pooled.tp, pooled.fp, pooled.fn, row.reason});
  }
  Standing standing = standing_of(dataset, rules.front(), scores);
  ordered_json json = {{"dataset", std::string(to_string(dataset.kind))},
                       {"protocols", protocols_json(rules, scores)},
                       {"remarks", sheet.notes}};
  for (const std::string& doubt : standing.doubts) json["remarks"].push_back(doubt);
  if (const auto origin = simulated_origin_json(dataset)) json["simulated"] = *origin;
  return {.standing = std::move(standing), .sheets = {std::move(sheet)}, .json = json_text(json)};
}

ordered_json protocols_json(const std::vector<ScoreRule>& rules,
                            const std::vector<SequenceScores>& scores) {
  ordered_json protocols = ordered_json::array();
  for (const ProtocolRow& row : protocol_rows(rules, scores)) {
    ordered_json& protocol = protocols.emplace_back(rule_json(row.rule, "name"));
    protocol["iou"] = json_or_null(row.summary[Metric::kIou]);
    protocol["published_text"] = row.summary.published_text;
    protocol.update(counts_json(row.summary.pooled));
    protocol["why"] = row.reason;
  }
  return protocols;
}

}  // namespace mosbench
