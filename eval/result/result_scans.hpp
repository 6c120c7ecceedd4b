#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <mosbench/method.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/layouts/dataset.hpp"
#include "eval/protocols/confusion.hpp"
#include "eval/result/result.hpp"

namespace mosbench {

/// How the numbers of a score file are stored: little-endian int32 in results of format 1, float32
/// since.
enum class ScoreNumbers { kInt32, kFloat32 };

/// Reads LabelledScan::scores, one per point. Throws DataError unless there are exactly
/// `point_count`, all finite.
std::vector<float> parse_dynamic_scores(std::string_view bytes, std::size_t point_count,
                                        ScoreNumbers numbers, const std::filesystem::path& file);
/// Returns the bytes of a file, float32, without copying the scores.
std::string_view format_dynamic_scores(std::span<const float> scores);

/// scores/<stem>.score of a run's folder.
std::filesystem::path dynamic_score_file(const std::filesystem::path& folder,
                                         std::string_view stem);

/// Reads LabelledScan::reasons, a byte per point. Throws DataError unless there are exactly
/// `point_count`, all of them values of Reason.
std::vector<Reason> parse_reasons(std::string_view bytes, std::size_t point_count,
                                  const std::filesystem::path& file);
/// Returns the bytes of a file without copying the reasons.
std::string_view format_reasons(std::span<const Reason> reasons);

/// reasons/<stem>.reason of a run's folder.
std::filesystem::path reason_file(const std::filesystem::path& folder, std::string_view stem);

/// objects/<stem>.object of a run's folder: LabelledScan::objects, stored as labels.
std::filesystem::path object_file(const std::filesystem::path& folder, std::string_view stem);

/// Whether a result was made from the frames that `sequence` has now; `stamp` is its `file_stamp`.
/// Files that were merely copied or touched hold the same frames: only then, and without a stamp,
/// are those read. Throws DataError.
bool same_input(const Sequence& sequence, const std::optional<std::string>& stamp,
                const Result& result);

/// Whether the labels are known: those of a run next to its result.json, others where `mosbench
/// score` read them.
bool has_labels(const Result& result);
/// The flags by which the data of a result were read; the usual ones where it tells none.
Reading reading_of(const Result& result);

/// One scan with the outcome of each point.
struct JudgedScan {
  Frame frame;
  std::vector<PointOutcome> outcomes;  ///< kIgnoredStatic or kIgnoredMoving without truth
  std::vector<float> scores;           ///< of the method, empty unless they are known
  std::vector<Reason> reasons;         ///< why points move, empty unless the run kept them
};

/// The scans of a result: points and truth from the data set, labels from the run's folder or from
/// where they were scored.
class ResultScans {
 public:
  /// Opens the data set at `dataset_root`, by default where it was read before, with the reading
  /// options of then. Throws DataError when it is missing or another one, when the labels are not
  /// there, and when result.json does not say how it was scored.
  ResultScans(const Result& result, const std::optional<std::filesystem::path>& dataset_root);

  /// The result with a row per scan of the sequence; one that was not scored has no counts.
  const Result& result() const { return aligned_ ? *aligned_ : result_; }
  const std::vector<ScanRow>& rows() const { return result().scans; }
  const Dataset& dataset() const { return dataset_; }
  /// Where the labels lie and how they are read.
  const PredictionSource& source() const { return source_; }
  const Predictions& labels() const { return *labels_; }
  /// Whether the result has labels of a scan: `mosbench score` leaves some out.
  bool has(std::size_t scan_index) const { return !aligned_ || rows()[scan_index].counts; }
  /// The scans with truth and labels.
  std::vector<std::size_t> scored_scans() const;
  /// Protocol and range of the run.
  ScoreRule rule() const { return {result_.protocol, result_.range}; }
  const Sequence& sequence() const { return *dataset_.sequences.front(); }
  /// Whether the run kept scores, or the predictions are confidences.
  bool has_scores() const { return has_scores_; }
  /// Whether the run kept why points move.
  bool has_reasons() const { return has_reasons_; }
  /// Throws DataError when the labels do not give the counts of result.json. A scan without labels
  /// has no outcome but kIgnoredStatic.
  JudgedScan read(std::size_t scan_index) const;

 private:
  void check_counts(const JudgedScan& scan, const Confusion& recorded) const;

  const Result& result_;
  Dataset dataset_;
  std::optional<Result> aligned_;  ///< of `mosbench score`
  PredictionSource source_;
  std::unique_ptr<Predictions> labels_;
  bool has_scores_;
  bool has_reasons_;
};

}  // namespace mosbench
