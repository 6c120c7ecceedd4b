#include "eval/result/result_scans.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>

#include "datasets/disk/files.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/sequence/corrected_sequence.hpp"
#include "datasets/sequence/fingerprint.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLabels = "labels";
constexpr const char* kOtherCounts = "does not give the counts in result.json";

/// Whether it is of mosbench score.
bool is_scored(const Result& result) { return result.predictions.has_value(); }

void check_has_labels(const Result& result) {
  if (has_labels(result)) return;
  if (!is_scored(result)) {
    throw DataError(result.file, "has no labels/ next to it",
                    "a folder of mosbench run to show points of; of others mosbench report "
                    "--scans none shows the numbers");
  }
  const bool tells = result.places.has_value();
  throw DataError(result.file,
                  tells ? "is of counts, not of labels" : "does not say where its labels are",
                  tells ? "labels to show points of; mosbench report --scans none shows the numbers"
                        : "a result that mosbench score wrote since it notes them: score again");
}

/// The poses that odometry found stand next to the labels.
void take_found_poses(const Result& result, Deskew deskew, Dataset& dataset) {
  PosesDone how;
  bool says_deskew = false;
  for (const auto& [what, said] : result.from.reading) {
    if (what == "poses") how.source = said;
    if (what == "pose_odometry") how.odometry = said;
    if (what == "pose_map") how.map = said;
    if (what == "deskew") says_deskew = true;
  }
  for (std::unique_ptr<Sequence>& sequence : dataset.sequences) {
    auto posed = std::make_unique<PosedSequence>(std::move(sequence), how, deskew, says_deskew);
    const fs::path file = result.folder() / "poses.txt";
    const std::vector<Pose> poses = read_poses(file);
    if (poses.size() != posed->size()) {
      throw DataError(file, fmt::format("{} poses for {} scans", poses.size(), posed->size()),
                      "one per scan");
    }
    posed->set_poses(poses, "poses found by odometry");
    sequence = std::move(posed);
  }
}

Dataset open_dataset_of(const Result& result, std::optional<fs::path> root) {
  check_has_labels(result);
  const auto kind = dataset_kind_from_string(result.dataset);
  if (!root && result.places) root = result.places->dataset_root;
  if (!kind || !root || !is_there(*root)) {
    throw DataError(result.file,
                    root ? fmt::format("was made from {}, which is not there", root->string())
                         : "does not say where its data set is",
                    "the data set's folder in --data");
  }
  const Reading reading = reading_of(result);
  try {
    Dataset dataset = open_dataset(*root, {kind, {result.sequence}, reading});
    if (reading.is_by_odometry()) {
      take_found_poses(result, reading.deskew.value_or(Deskew::kPoses), dataset);
    }
    return dataset;
  } catch (const UsageError& error) {
    throw DataError(result.file, error.what(), "a result.json of this mosbench");
  }
}

/// Lists how the sequence is read differently from what the result states; older results do not
/// record all flags.
std::string read_otherwise(const Result& result, const Sequence& sequence) {
  const std::map<std::string, std::string> before(result.from.reading.begin(),
                                                  result.from.reading.end());
  // The same pose file may be given by another path; the file stamp identifies it.
  const bool told_poses = reading_of(result).pose_file() != nullptr;
  std::string text;
  for (const auto& [what, how] : members_of(sequence.reading())) {
    const auto was = before.find(what);
    if (was == before.end() || was->second == how || (told_poses && what == "poses")) continue;
    text += fmt::format("; {} was \"{}\" and is \"{}\" now", what, was->second, how);
  }
  return text;
}

[[noreturn]] void refuse_other_scans(const Result& result, const Dataset& dataset,
                                     const std::string& how) {
  throw DataError(result.file,
                  fmt::format("was made from other scans, poses or labels than {} holds in {}{}",
                              result.sequence.text(), dataset.root.string(), how),
                  "the data set of the run in --data");
}

void check_same_scans(const Result& result, const Dataset& dataset) {
  const Sequence& sequence = *dataset.sequences.front();
  const std::vector<ScanRow>& rows = result.scans;
  bool same = rows.size() == sequence.size();
  for (std::size_t k = 0; same && k < rows.size(); ++k) same = rows[k].stem == sequence.stem(k);
  const std::string otherwise = read_otherwise(result, sequence);
  // Other reading options give other frames from the same files.
  const auto stamp = otherwise.empty() ? std::optional(file_stamp(sequence)) : std::nullopt;
  if (same && same_input(sequence, stamp, result)) return;
  refuse_other_scans(result, dataset, otherwise);
}

/// Gives a scored result a row per scan. Throws DataError where it has one that is no scan.
Result aligned(const Result& result, const Dataset& dataset) {
  const Sequence& sequence = *dataset.sequences.front();
  const std::string otherwise = read_otherwise(result, sequence);
  if (!otherwise.empty()) refuse_other_scans(result, dataset, otherwise);
  std::map<std::string, const ScanRow*> scored;
  for (const ScanRow& row : result.scans) scored.emplace(row.stem, &row);
  Result whole = result;
  whole.scans.clear();
  for (std::size_t k = 0; k < sequence.size(); ++k) {
    const auto found = scored.extract(sequence.stem(k));
    whole.scans.push_back(found.empty() ? ScanRow{} : *found.mapped());
    whole.scans.back().stem = sequence.stem(k);
  }
  if (!scored.empty()) {
    refuse_other_scans(result, dataset, fmt::format("; it has no scan {}", scored.begin()->first));
  }
  return whole;
}

/// The labels that `mosbench run` wrote, which are read without a look at those of other scans.
class RunLabels : public Predictions {
 public:
  RunLabels(const Result& result, const Sequence& sequence)
      : result_(result), sequence_(sequence) {}
  bool has(std::size_t) const override { return true; }
  /// Throws DataError for labels that are not those the run wrote.
  std::vector<std::uint32_t> read(std::size_t scan_index) const override {
    const fs::path file = result_.folder() / kLabels / (sequence_.stem(scan_index) + ".label");
    std::vector<std::uint32_t> labels = read_labels(file, sequence_.point_count(scan_index));
    if (are_labels_of(result_.scans[scan_index], labels)) return labels;
    throw DataError(file, kOtherCounts, "the label file of that run");
  }

 private:
  const Result& result_;
  const Sequence& sequence_;
};

PredictionSource source_of(const Result& result) {
  if (!is_scored(result)) return {result.folder() / kLabels, {}};
  PredictionSource source = result.places->predictions.value();
  source.options.allow_missing = result.missing_predictions() > 0;
  return source;
}

}  // namespace

static_assert(std::endian::native == std::endian::little, "scores are copied as they are stored");

std::vector<float> parse_dynamic_scores(std::string_view bytes, std::size_t point_count,
                                        ScoreNumbers numbers, const std::filesystem::path& file) {
  static_assert(sizeof(float) == sizeof(std::int32_t));
  const std::size_t expected_bytes = point_count * sizeof(float);
  if (bytes.size() != expected_bytes) {
    throw DataError(file, fmt::format("has {} bytes", bytes.size()),
                    fmt::format("one {} for each of the {} points of its scan ({} bytes)",
                                numbers == ScoreNumbers::kInt32 ? "int32" : "float32", point_count,
                                expected_bytes));
  }
  std::vector<float> scores(point_count);
  if (scores.empty()) return scores;
  if (numbers == ScoreNumbers::kFloat32) {
    std::memcpy(scores.data(), bytes.data(), bytes.size());
  } else {
    std::vector<std::int32_t> whole(point_count);
    std::memcpy(whole.data(), bytes.data(), bytes.size());
    std::ranges::transform(whole, scores.begin(),
                           [](std::int32_t score) { return static_cast<float>(score); });
  }
  const auto wrong =
      std::ranges::find_if_not(scores, [](float score) { return std::isfinite(score); });
  if (wrong == scores.end()) return scores;
  throw DataError(file, fmt::format("score {} is {}", wrong - scores.begin(), *wrong),
                  "a finite number");
}

std::string_view format_dynamic_scores(std::span<const float> scores) {
  return {reinterpret_cast<const char*>(scores.data()), scores.size_bytes()};
}

std::filesystem::path dynamic_score_file(const std::filesystem::path& folder,
                                         std::string_view stem) {
  return folder / "scores" / fmt::format("{}.score", stem);
}

std::vector<Reason> parse_reasons(std::string_view bytes, std::size_t point_count,
                                  const std::filesystem::path& file) {
  if (bytes.size() != point_count) {
    throw DataError(file, fmt::format("has {} bytes", bytes.size()),
                    fmt::format("one for each of the {} points of its scan", point_count));
  }
  const auto number = [](char byte) { return static_cast<unsigned char>(byte); };
  const auto wrong = std::ranges::find_if(bytes, [&](char b) { return number(b) >= kReasonCount; });
  if (wrong != bytes.end()) {
    throw DataError(file, fmt::format("reason {} is {}", wrong - bytes.begin(), number(*wrong)),
                    fmt::format("0 to {}", kReasonCount - 1));
  }
  std::vector<Reason> reasons;
  for (const char byte : bytes) reasons.push_back(static_cast<Reason>(byte));
  return reasons;
}

std::string_view format_reasons(std::span<const Reason> reasons) {
  return {reinterpret_cast<const char*>(reasons.data()), reasons.size_bytes()};
}

std::filesystem::path reason_file(const std::filesystem::path& folder, std::string_view stem) {
  return folder / "reasons" / fmt::format("{}.reason", stem);
}

std::filesystem::path object_file(const std::filesystem::path& folder, std::string_view stem) {
  return folder / "objects" / fmt::format("{}.object", stem);
}

bool same_input(const Sequence& sequence, const std::optional<std::string>& stamp,
                const Result& result) {
  if (stamp && result.places && result.places->file_stamp == *stamp) return true;
  ContentFingerprint fingerprint;
  for (std::size_t k = 0; k < sequence.size(); ++k) fingerprint.add(sequence.read(k));
  return fingerprint.hex() == result.from.fingerprint;
}

bool has_labels(const Result& result) {
  if (!is_scored(result)) return is_there(result.folder() / kLabels);
  return result.places && result.places->predictions &&
         result.predictions->format != describe(PredictionFormat::kDynabloxScores).name;
}

Reading reading_of(const Result& result) {
  return result.places ? result.places->reading : Reading{};
}

ResultScans::ResultScans(const Result& result, const std::optional<fs::path>& dataset_root)
    : result_(result),
      dataset_(open_dataset_of(result, dataset_root)),
      source_(source_of(result)),
      has_scores_(!is_scored(result) && is_there(result.folder() / "scores")),
      has_reasons_(!is_scored(result) && is_there(result.folder() / "reasons")) {
  if (!is_scored(result)) {
    check_same_scans(result, dataset_);
    labels_ = std::make_unique<RunLabels>(result_, sequence());
    return;
  }
  aligned_ = aligned(result, dataset_);
  labels_ =
      open_predictions(source_.path, sequence(), scored_scans(), true, source_.options).labels;
  const std::vector<std::size_t> scored = scored_scans();
  has_scores_ = !scored.empty() && !labels_->confidences(scored.front()).empty();
}

std::vector<std::size_t> ResultScans::scored_scans() const {
  std::vector<std::size_t> scans = scans_with_truth(sequence());
  std::erase_if(scans, [&](std::size_t k) { return !has(k); });
  return scans;
}

JudgedScan ResultScans::read(std::size_t scan_index) const {
  JudgedScan scan{sequence().read(scan_index), {}, {}, {}};
  if (!has(scan_index)) {
    scan.outcomes.assign(scan.frame.points.size(), PointOutcome::kIgnoredStatic);
    return scan;
  }
  const bool is_confident = aligned_ && has_scores_;
  std::vector<double> confidences;
  if (is_confident) confidences = labels_->confidences(scan_index);
  const std::vector<std::uint32_t> labels =
      is_confident ? labels_->labels(scan_index, confidences) : labels_->read(scan_index);
  const std::optional<Confusion>& recorded = rows()[scan_index].counts;
  if (scan.frame.truth && recorded) {
    const bool gated = result_.protocol->range_rule != RangeRule::kNone;
    scan.outcomes =
        point_outcomes(*result_.protocol, *scan.frame.truth, labels,
                       gated ? std::span<const Point>(scan.frame.points) : std::span<const Point>(),
                       result_.range);
  } else {
    for (const std::uint32_t label : labels) {
      scan.outcomes.push_back(label == kMovingLabel ? PointOutcome::kIgnoredMoving
                                                    : PointOutcome::kIgnoredStatic);
    }
  }
  if (recorded) check_counts(scan, *recorded);
  for (const double confidence : confidences) {
    scan.scores.push_back(static_cast<float>(confidence));
  }
  if (has_scores_ && !is_confident) {
    const fs::path file = dynamic_score_file(result_.folder(), scan.frame.stem);
    scan.scores = parse_dynamic_scores(
        read_file(file), scan.frame.points.size(),
        result_.has_whole_scores ? ScoreNumbers::kInt32 : ScoreNumbers::kFloat32, file);
  }
  if (has_reasons_) {
    const fs::path file = reason_file(result_.folder(), scan.frame.stem);
    scan.reasons = parse_reasons(read_file(file), scan.frame.points.size(), file);
  }
  return scan;
}

void ResultScans::check_counts(const JudgedScan& scan, const Confusion& recorded) const {
  OutcomeCounts counts{};
  for (const PointOutcome outcome : scan.outcomes) ++counts[static_cast<std::size_t>(outcome)];
  Confusion confusion = to_confusion(counts);
  confusion.unknown_ids = recorded.unknown_ids;
  if (confusion == recorded) return;
  throw DataError(source_.path / (scan.frame.stem + (aligned_ ? "" : ".label")), kOtherCounts,
                  aligned_ ? "the predictions that were scored" : "the label file of that run");
}

}  // namespace mosbench
