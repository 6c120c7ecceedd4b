#include "eval/engine/score_execute.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <map>
#include <mutex>
#include <string_view>

#include "core/base/thread_pool.hpp"
#include "datasets/layouts/kitti_sequence.hpp"
#include "datasets/sequence/fingerprint.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/protocols/benchmark_split.hpp"
#include "eval/protocols/metrics.hpp"
#include "eval/result/tell.hpp"

namespace mosbench {
namespace {

constexpr int kLargestShift_scans = 10;
constexpr std::size_t kComparedScans = 12;
/// Labels of a sound method fit their own scan best; in a dozen scans by chance at most this less.
constexpr double kClearlyBetter = 0.05;

/// Returns whether the labels of scan k + shift can be compared with the truth of scan k.
bool fits(const Sequence& sequence, const Predictions& labels, std::size_t k, int shift) {
  const auto other = static_cast<std::ptrdiff_t>(k) + shift;
  if (other < 0 || other >= static_cast<std::ptrdiff_t>(sequence.size())) return false;
  const auto index = static_cast<std::size_t>(other);
  return labels.has(index) && sequence.point_count(index) == sequence.point_count(k);
}

/// Returns evenly spread scans around which labels of all shifts can be compared.
std::vector<std::size_t> comparable_scans(const Sequence& sequence,
                                          const std::vector<std::size_t>& scans,
                                          const Predictions& labels) {
  std::vector<std::size_t> comparable;
  for (const std::size_t k : scans) {
    bool all = true;
    for (int shift = -kLargestShift_scans; all && shift <= kLargestShift_scans; ++shift) {
      all = fits(sequence, labels, k, shift);
    }
    if (all) comparable.push_back(k);
  }
  std::vector<std::size_t> spread;
  const std::size_t count = std::min(kComparedScans, comparable.size());
  for (std::size_t i = 0; i < count; ++i) {
    spread.push_back(comparable[i * comparable.size() / count]);
  }
  return spread;
}

std::string shift_text(int shift, double iou, double unshifted_iou, std::size_t scans) {
  const char* direction = shift > 0 ? "late" : "early";
  const std::string by = counted(std::abs(shift), "scan");
  std::string text = fmt::format(
      "labels look {} {}: those of {} {} fit the truth better, IoU {:.1f} in place of "
      "{:.1f} % in {}",
      by, direction, by, shift > 0 ? "later" : "earlier", 100.0 * iou, 100.0 * unshifted_iou,
      counted(scans, "scan"));
  if (shift > 0) {
    text += fmt::format(
        "; a method with a delay of {} that names labels by its newest scan leaves them so", by);
  }
  return text;
}

std::vector<std::size_t> wanted_scans(const Dataset& dataset, std::size_t position,
                                      const ScoreTask& task) {
  const Sequence& sequence = *dataset.sequences[position];
  std::vector<std::size_t> wanted = scans_with_truth(sequence);
  if (!task.split) return wanted;
  const auto stems =
      stems_in_split(*std::ranges::find(dataset.splits, *task.split, &Split::name), position);
  std::erase_if(wanted, [&](std::size_t k) { return stems && !stems->contains(sequence.stem(k)); });
  return wanted;
}

/// Points are read where a rule looks at ranges.
Frame frame_to_score(const Sequence& sequence, std::size_t k, const ScoreTask& task) {
  const bool with_points = std::ranges::any_of(task.rules, [](const ScoreRule& rule) {
    return rule.protocol->range_rule != RangeRule::kNone;
  });
  Frame frame;
  if (with_points) sequence.read(k, frame);
  if (!with_points) frame.truth = sequence.read_truth(k);
  return frame;
}

/// One row per rule.
std::vector<ScanRow> score_one(const Frame& frame, const std::string& stem, std::size_t k,
                               const ScoreTask& task, const Predictions& labels,
                               std::span<const double> confidences, UnsureBounds* unsure) {
  const std::optional<Confusion> counted = labels.counts(k);
  const std::vector<std::uint32_t> predicted =
      counted ? std::vector<std::uint32_t>{} : labels.labels(k, confidences);
  const LabelHash truth_hash = hash_of_labels(*frame.truth), label_hash = hash_of_labels(predicted);
  std::vector<ScanRow> rows;
  for (const ScoreRule& rule : task.rules) {
    ScanRow& row = rows.emplace_back();
    row.stem = stem;
    row.points = frame.truth->size();
    row.truth_hash = truth_hash;
    if (!counted) row.label_hash = label_hash;
    row.counts =
        counted ? *counted
                : score_scan(*rule.protocol, *frame.truth, predicted, frame.points, rule.range);
    row.predicted_moving_points = row.counts->tp + row.counts->fp;
  }
  if (unsure && !counted) unsure->add(task.rules.front(), *frame.truth, predicted, frame.points);
  return rows;
}

/// Dynablox's own counts are by one protocol at one range, whatever was asked.
void check_rules_of_counts(const OpenedPredictions& opened, const ScoreTask& task) {
  if (opened.format != PredictionFormat::kDynabloxScores) return;
  const Protocol& own = *std::ranges::find(protocols(), true, &Protocol::has_dynablox_counts);
  for (const ScoreRule& rule : task.rules) {
    if (rule.protocol == &own && rule.range == own.default_range) continue;
    throw UsageError(fmt::format(
        "--protocol: {} holds counts by protocol {} at {:g} to {:g} m, expected that protocol and "
        "range, not {} at {:g} to {:g} m; the labels in clouds.csv can be scored by all",
        opened.path.string(), own.name, own.default_range.min_m, own.default_range.max_m,
        rule.protocol->name, rule.range.min_m, rule.range.max_m));
  }
}

void score_scans(const Sequence& sequence, const std::vector<std::size_t>& scans,
                 const ScoreTask& task, ThreadPool& pool, SequenceScores& scores) {
  for (auto& rows : scores.by_rule) rows.resize(scans.size());
  Progress progress("score " + sequence.name(), scans.size());
  const bool is_unsure = has_unsure_truth(sequence.recording());
  std::mutex progress_mutex;
  pool.for_ranges(scans.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
    for (std::size_t i = begin; i < end; ++i) {
      const Predictions& labels = *scores.opened->labels;
      const Frame frame = frame_to_score(sequence, scans[i], task);
      const std::vector<double> confidences = labels.confidences(scans[i]);
      UnsureBounds unsure;
      std::vector<ScanRow> rows = score_one(frame, sequence.stem(scans[i]), scans[i], task, labels,
                                            confidences, is_unsure ? &unsure : nullptr);
      ScoreCounts counts;
      if (!confidences.empty()) {
        counts.add({*frame.truth, confidences, frame.points, *rows.front().counts},
                   task.rules.front());
      }
      const std::lock_guard lock(progress_mutex);
      scores.unsure += unsure;
      if (!confidences.empty()) {
        if (!scores.confidences) scores.confidences.emplace();
        *scores.confidences += counts;
      }
      for (std::size_t r = 0; r < rows.size(); ++r) scores.by_rule[r][i] = std::move(rows[r]);
      progress.advance();
    }
  });
}

/// Adds doubts when nothing or most is predicted moving, and when labels fit other scans better.
void add_doubts(const Sequence& sequence, const std::vector<std::size_t>& scans,
                const ScoreRule& rule, SequenceScores& scores) {
  Confusion all;
  for (const ScanRow& row : scores.by_rule.front()) all += *row.counts;
  OpenedPredictions& opened = *scores.opened;
  const std::string remark = strange_share(all.tp + all.fp, all.points() - all.ignored,
                                           opened.labels->ids(), *rule.protocol);
  if (!remark.empty()) opened.doubts.push_back(remark);
  const std::string open = scores.unsure.text(rule);
  if (!open.empty()) opened.doubts.push_back(open);
  if (opened.format == PredictionFormat::kDynabloxScores) return;
  const std::string shift = shift_remark(sequence, scans, *opened.labels, rule);
  if (!shift.empty()) opened.doubts.push_back(shift);
}

/// Says how many label files a run did not write as they are; empty for none.
std::string changed_since(const Result& run, const std::vector<ScanRow>& rows) {
  std::map<std::string_view, std::optional<LabelHash>> written;
  for (const ScanRow& row : run.scans) written.emplace(row.stem, row.label_hash);
  std::vector<std::string_view> changed;
  for (const ScanRow& row : rows) {
    const auto before = written.find(row.stem);
    const bool is_known = before != written.end() && before->second;
    if (is_known && before->second != row.label_hash) changed.push_back(row.stem);
  }
  if (changed.empty()) return "";
  return fmt::format("LABELS CHANGED after the run: {} of {} are not what it wrote, first {}.label",
                     changed.size(), counted(rows.size(), "label file"), changed.front());
}

/// Adds what is known of the labels where a run wrote them.
void add_doubts_of_run(const Sequence& sequence, const ScoreTask& task, SequenceScores& scores) {
  OpenedPredictions& opened = *scores.opened;
  scores.run = run_that_wrote(opened);
  if (!scores.run) return;
  std::ranges::move(doubts_of_labels(*scores.run, sequence), std::back_inserter(opened.doubts));
  std::string changed =
      !task.options.id_map ? changed_since(*scores.run, scores.by_rule.front()) : "";
  if (!changed.empty()) opened.doubts.push_back(std::move(changed));
}

SequenceScores score_sequence(const Dataset& dataset, std::size_t position, const ScoreTask& task,
                              ThreadPool& pool) {
  const Sequence& sequence = *dataset.sequences[position];
  SequenceScores scores{position, std::nullopt, {}};
  scores.by_rule.resize(task.rules.size());
  const std::vector<std::size_t> wanted = wanted_scans(dataset, position, task);
  if (wanted.empty()) return scores;
  scores.opened = open_predictions(task.predictions, sequence, wanted,
                                   dataset.sequences.size() == 1, task.options);
  check_rules_of_counts(*scores.opened, task);
  std::vector<std::size_t> scans;
  for (const std::size_t k : wanted) {
    if (scores.opened->labels->has(k)) scans.push_back(k);
  }
  try {
    score_scans(sequence, scans, task, pool, scores);
    add_doubts_of_run(sequence, task, scores);
    add_doubts(sequence, scans, task.rules.front(), scores);
  } catch (const DataError& error) {
    throw scores.opened->with_format(error);
  }
  return scores;
}

/// Says why there is nothing to score: no truth, or no prediction that --allow-missing left.
[[noreturn]] void refuse_nothing(const Dataset& dataset, const ScoreTask& task,
                                 const std::vector<SequenceScores>& sequences) {
  for (const SequenceScores& sequence : sequences) {
    if (!sequence.opened) continue;
    const std::vector<std::string>& remarks = sequence.opened->remarks;
    throw DataError(task.predictions,
                    fmt::format("holds no usable prediction of any scan with truth{}",
                                remarks.empty() ? "" : " (" + remarks.front() + ")"),
                    "some");
  }
  throw DataError(dataset.root, "no scan to score has truth", "labels beside the scans");
}

}  // namespace

std::string shift_remark(const Sequence& sequence, const std::vector<std::size_t>& scans,
                         const Predictions& labels, const ScoreRule& rule) {
  const std::vector<std::size_t> compared = comparable_scans(sequence, scans, labels);
  std::map<int, Confusion> by_shift;
  for (const std::size_t k : compared) {
    const Frame frame = sequence.read(k);
    for (int shift = -kLargestShift_scans; shift <= kLargestShift_scans; ++shift) {
      const auto other = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(k) + shift);
      by_shift[shift] +=
          score_scan(*rule.protocol, *frame.truth, labels.read(other), frame.points, rule.range);
    }
  }
  if (compared.empty()) return "";
  const auto iou = [&](int shift) { return moving_iou(by_shift.at(shift)).value_or(0.0); };
  int best = 0;
  for (const auto& [shift, counts] : by_shift) {
    if (iou(shift) > iou(best)) best = shift;
  }
  if (iou(best) <= iou(0) + kClearlyBetter) return "";
  return shift_text(best, iou(best), iou(0), compared.size());
}

std::vector<SequenceScores> score_dataset(const Dataset& dataset, const ScoreTask& task) {
  ThreadPool pool(task.threads);
  std::vector<SequenceScores> sequences;
  std::size_t scans = 0;
  for (std::size_t i = 0; i < dataset.sequences.size(); ++i) {
    sequences.push_back(score_sequence(dataset, i, task, pool));
    scans += sequences.back().by_rule.front().size();
  }
  if (scans == 0) refuse_nothing(dataset, task, sequences);
  return sequences;
}

}  // namespace mosbench
