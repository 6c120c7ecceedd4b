#include "eval/tables/score_report.hpp"

#include <fmt/format.h>

#include "datasets/disk/files.hpp"
#include "datasets/disk/partial_file.hpp"
#include "datasets/text/counted.hpp"
#include "datasets/text/errors.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/engine/score_source.hpp"
#include "eval/protocols/benchmark_split.hpp"
#include "eval/protocols/metrics.hpp"
#include "eval/protocols/protocol_list.hpp"
#include "eval/protocols/summary_json.hpp"
#include "eval/results/reading_json.hpp"
#include "eval/results/result_set.hpp"
#include "eval/results/simulated.hpp"
#include "eval/results/version.hpp"
#include "eval/tables/score_table.hpp"

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

ordered_json predictions_json(const OpenedPredictions& opened) {
  return {{"format", std::string(describe(opened.format).name)},
          {"guessed", opened.guessed},
          {"path", opened.path.string()},
          {"missing", opened.missing},
          {"remarks", opened.remarks}};
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
    if (name == kResultFile && read_result(entry.path()).content.contains("predictions")) continue;
    throw UsageError(
        entry.path().string() +
        ": was not written by mosbench score, expected --out to name a folder of its own");
  }
}

std::vector<Confusion> counts_in(const std::vector<ScanRow>& rows) {
  std::vector<Confusion> counts;
  for (const ScanRow& row : rows) counts.push_back(*row.counts);
  return counts;
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

Standing standing_of(const Dataset& dataset, const std::vector<SequenceScores>& scores) {
  Standing standing = standing_of(dataset);
  for (const SequenceScores& sequence : scores) {
    if (!sequence.opened || sequence.opened->missing.empty()) continue;
    standing.doubts.push_back(dataset.sequences[sequence.position]->name() + ": " +
                              incomplete_warning(sequence.opened->missing.size()));
  }
  return standing;
}

std::vector<std::string> all_remarks(const Dataset& dataset,
                                     const std::vector<SequenceScores>& scores) {
  std::vector<std::string> remarks = score_remarks(dataset, scores);
  for (std::string& doubt : standing_of(dataset, scores).doubts) {
    remarks.push_back(std::move(doubt));
  }
  return remarks;
}

Answer score_answer(const Dataset& dataset, const ScoreTask& task,
                    const std::vector<SequenceScores>& scores, bool with_sequences) {
  const ScoreRule& rule = task.rules.front();
  const std::vector<SummaryRow> rows = table_rows(dataset, rule, scores, with_sequences);
  Sheet sheet = score_sheet(rule, dataset.splits, rows);
  sheet.notes = score_remarks(dataset, scores);
  Standing standing = standing_of(dataset, scores);
  if (const auto split = other_split(dataset, task)) {
    standing.doubts.push_back(split_warning(*split));
  }
  ordered_json json = {{"dataset", std::string(to_string(dataset.kind))},
                       {"protocol", std::string(rule.protocol->name)},
                       {"min_range_m", rule.range.min_m},
                       {"max_range_m", rule.range.max_m}};
  if (const auto origin = simulated_origin_json(dataset)) json["simulated"] = *origin;
  json.update(rows_json(rows));
  json["predictions"] = ordered_json::object();
  for (const SequenceScores& sequence : scores) {
    if (!sequence.opened) continue;
    json["predictions"][dataset.sequences[sequence.position]->name()] =
        predictions_json(*sequence.opened);
  }
  json["remarks"] = sheet.notes;
  for (const std::string& doubt : standing.doubts) json["remarks"].push_back(doubt);
  return {.standing = std::move(standing), .sheets = {std::move(sheet)}, .json = json_text(json)};
}

void check_scored_folders(const Dataset& dataset, const std::filesystem::path& out) {
  for (const auto& sequence : dataset.sequences) refuse_other_results(out / sequence->name());
}

void write_scores(const Dataset& dataset, const ReadingOptions& reading, const ScoreTask& task,
                  const MethodName& method, const std::vector<SequenceScores>& scores,
                  const std::filesystem::path& out) {
  const ScoreRule& rule = task.rules.front();
  for (const SequenceScores& sequence : scores) {
    if (!sequence.opened) continue;
    const Sequence& recorded = *dataset.sequences[sequence.position];
    ordered_json header = {
        {"sequence", recorded.name()},
        {"dataset", std::string(to_string(dataset.kind))},
        {"method", {{"name", method.name}, {"setting", method.setting}}},
        {"protocol",
         {{"name", std::string(rule.protocol->name)},
          {"min_range_m", rule.range.min_m},
          {"max_range_m", rule.range.max_m}}},
        {"reading", to_json(recorded.reading())},
        {"code", {{"version", std::string(kMosbenchVersion)}}},
        {"predictions", predictions_json(*sequence.opened)},
        {"source", source_json(dataset, reading, task, sequence.opened->format)}};
    if (const auto origin = simulated_origin_json(dataset, recorded)) {
      header["simulated"] = *origin;
    }
    const ordered_json splits = picked_stems(dataset, sequence.position);
    if (!splits.empty()) header["splits"] = splits;
    const std::vector<ScanRow>& rows = sequence.by_rule.front();
    header["summary_split"] = json_or_null(picked_split(dataset, task));
    header["summary"] = to_json(summarize(*rule.protocol, counts_in(rows)));
    commit_file(out / recorded.name() / "result.json", format_scored(header, rows));
  }
}

}  // namespace mosbench
