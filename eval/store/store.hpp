#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/disk/claim.hpp"
#include "datasets/sequence/sequence.hpp"
#include "eval/result/result.hpp"

namespace mosbench {

/// "settings/max_range_m is 50.0 there and 30.0 now; ..." of the members that `now` has; empty when
/// `there` has the same. The member `settings` counts only where both are of one `method`.
std::string changed_members(const nlohmann::ordered_json& there, const nlohmann::ordered_json& now);

/// What a run writes per point beside the labels.
struct PointFiles {
  bool scores = false;
  bool reasons = false;
  bool objects = false;
};

/// Who writes to a folder of results.
enum class Writers : std::uint8_t {
  kOne,  ///< who holds the lock of the folder around it
  kMany  ///< processes of several hosts, whose results are the same
};

/// The folder <out>/<sequence> of a run: labels/<stem>.label, scores/<stem>.score,
/// reasons/<stem>.reason and objects/<stem>.object when they were asked for, and result.json. It
/// appears as a whole when the sequence is done; until then everything lies in `<folder>.partial`,
/// which the next run clears. So a killed or failed run never mixes with earlier results.
class ResultFolder {
 public:
  explicit ResultFolder(std::filesystem::path folder, Writers writers = Writers::kOne)
      : folder_(std::move(folder)), writers_(writers) {}

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
  /// Makes an empty folder for new results, whose place is this one's. Throws DataError.
  std::unique_ptr<Claim> begin() const;

 private:
  std::filesystem::path folder_;
  Writers writers_;
};

/// Returns the runs in a folder; empty when it does not exist or holds no result.
std::vector<ResultSet> accepted_runs(const std::filesystem::path& folder);

/// Throws UsageError if accepting the results below `newer` as the baseline in `folder` would take
/// some of them away: one folder is the other or above it, or a sequence of the baseline is a link
/// that leads out of it. Also where the baseline is a run with files beside its results: they would
/// stay as the labels of other numbers.
void refuse_overlap(const ResultSet& newer, const std::filesystem::path& folder);

/// What becomes of the sequences of a baseline that a run does not have.
enum class Others : std::uint8_t { kRemove, kKeep };

/// Writes <folder>/<sequence>/result.json for every sequence of the run; other files stay. Results
/// that change keep `why`. After a kill at any moment the old or the new baseline is whole.
/// `folder` must be locked. Returns whether anything changed. Throws DataError.
bool accept_baseline(const ResultSet& run, const std::filesystem::path& folder,
                     const std::optional<Acceptance>& why = std::nullopt,
                     Others others = Others::kRemove);

/// Writes files of `run --write` into a folder and keeps their hashes in its products.json, so that
/// a later run knows which are as they were written.
class ProductRecord {
 public:
  /// Throws DataError for a damaged products.json.
  explicit ProductRecord(std::filesystem::path folder);

  /// Returns whether `file`, a path below the folder, is there and known. Throws UsageError when it
  /// was changed since it was written.
  bool has(const std::string& file) const;
  /// Writes the file as a whole; throws UsageError for one of this name that is not known and holds
  /// something else. `save` makes it known; every 50th call does so, so that a killed
  /// run makes few files again.
  void write(const std::string& file, std::string_view bytes);
  void save();
  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
  nlohmann::ordered_json hashes_;  ///< by file
  std::size_t unsaved_ = 0;
};

}  // namespace mosbench
