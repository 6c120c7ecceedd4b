#pragma once

#include <filesystem>
#include <optional>

#include "datasets/sequence/sequence.hpp"
#include "eval/result/result.hpp"

namespace mosbench {

/// What a run writes per point beside the labels.
struct PointFiles {
  bool scores = false;
  bool reasons = false;
};

/// The folder <out>/<sequence> of a run: labels/<stem>.label, scores/<stem>.score and
/// reasons/<stem>.reason when they were asked for, and result.json. It appears as a whole when the
/// sequence is done; until then everything lies in `<folder>.partial`, which the next run clears.
/// So a killed or failed run never mixes with earlier results.
class ResultFolder {
 public:
  explicit ResultFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}

  const std::filesystem::path& path() const { return folder_; }

  /// The finished result when it answers the same question: its `identity_json` is that of `asked`,
  /// and every scan has its label file, and what `point_files` asks for. Nothing when there is no
  /// folder or such files are missing or have the wrong size, so that the sequence has to be run.
  /// Throws UsageError naming what differs when something else lies there.
  std::optional<Result> finished(const Sequence& sequence, const Result& asked,
                                 const PointFiles& point_files) const;

  /// Throws UsageError naming a label file whose labels are not those that `result`, which lies
  /// there, counts.
  void check_labels(const Result& result) const;

  /// Throws UsageError unless the folder is absent or holds nothing but a run's result, so that
  /// --overwrite never takes away anything else.
  void check_replaceable() const;

  /// Removes what a killed run left beside the folder. Throws DataError.
  void remove_leftovers() const;
  /// Makes an empty folder for new results and returns it. Throws DataError.
  std::filesystem::path begin() const;
  /// Puts what `begin` made in place of the folder. Throws DataError.
  void publish() const;

 private:
  std::filesystem::path with_suffix(const char* suffix) const;

  std::filesystem::path folder_;
};

}  // namespace mosbench
