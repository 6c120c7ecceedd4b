#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
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
};

/// Who writes to a folder of results.
enum class Writers : std::uint8_t {
  kOne,  ///< who holds the lock of the folder around it
  kMany  ///< processes of several hosts, whose results are the same
};

/// The folder <out>/<sequence> of a run: labels/<stem>.label, scores/<stem>.score and
/// reasons/<stem>.reason when they were asked for, and result.json. It appears as a whole when the
/// sequence is done; until then everything lies in `<folder>.partial`, which the next run clears.
/// So a killed or failed run never mixes with earlier results.
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

}  // namespace mosbench
