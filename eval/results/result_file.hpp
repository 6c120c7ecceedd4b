#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <mosbench/method.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "datasets/sequence/fingerprint.hpp"
#include "eval/protocols/confusion.hpp"

namespace mosbench {

/// What a run found out about one scan. Depends on nothing but the input, the configuration and the
/// code.
struct ScanRow {
  std::string stem;
  std::size_t points = 0;
  std::size_t predicted_moving_points = 0;
  std::size_t nonfinite_points = 0;
  bool judged = true;  ///< false: the method labelled all points static without looking
  std::optional<double> threshold;      ///< see LabelledScan
  std::optional<Confusion> counts;      ///< when the scan has truth
  std::optional<LabelHash> truth_hash;  ///< of that truth; older files do not tell
  std::optional<LabelHash> label_hash;  ///< of the labels that a run wrote; likewise
};

/// What one scan cost: wall milliseconds, and the memory the process held after it.
struct ScanCost {
  /// Spent waiting for the scan; with several threads it is read and observed ahead.
  double read_ms = 0.0;
  double push_ms = 0.0;           ///< the whole method, also what is done beside the scan before
  std::vector<double> stages_ms;  ///< as SequenceRows::stages; those after its end are 0
  double resident_mib = 0.0;
};

/// Everything per scan of one sequence, in scan order.
struct SequenceRows {
  std::vector<ScanRow> scans;
  std::vector<ScanCost> costs;      ///< as many as scans
  std::vector<std::string> stages;  ///< names, in the order in which they first ran
  double wall_s = 0.0;
  std::string fingerprint;                ///< of the frames, see ContentFingerprint
  std::string fingerprint_without_poses;  ///< empty in older results
  std::vector<std::string> remarks;       ///< of the method, see Method::remarks
};

/// Returns whether labels are those that the row of a run counts.
bool are_labels_of(const ScanRow& row, std::span<const std::uint32_t> labels);

/// Adds the times of a scan's stages to `cost`, and their names to `rows`.
void add_stages(const std::vector<StageTime>& stages, SequenceRows& rows, ScanCost& cost);

/// Mean of ScanCost::push_ms; nothing without scans.
std::optional<double> method_ms_per_scan(const SequenceRows& rows);

/// Text of a result.json: the members of `header`, then the scans, then under the one key "timing"
/// what depends on the clock or on `threads`, together with the members of `clock_header`.
std::string format_result(const nlohmann::ordered_json& header, const SequenceRows& rows,
                          unsigned threads, const nlohmann::ordered_json& clock_header);

/// The same without timing, for labels that nothing is known of but what they score.
std::string format_scored(const nlohmann::ordered_json& header, const std::vector<ScanRow>& scans);

struct ResultFile {
  nlohmann::ordered_json content;
  SequenceRows rows;
};

/// Every result.json below a folder (or the file itself), `deepest` levels of folders at most,
/// ordered by path, but not those that killed runs left; empty when there is none. Throws
/// DataError for a path that cannot be read, unless `how` passes over it.
std::vector<std::filesystem::path> find_result_files(
    const std::filesystem::path& path,
    std::filesystem::directory_options how = std::filesystem::directory_options::none,
    int deepest = std::numeric_limits<int>::max());
/// The same where there has to be one: throws DataError when there is none.
std::vector<std::filesystem::path> result_files(const std::filesystem::path& path);

/// Reads what `format_result` or `format_scored` wrote; throws DataError naming the file for
/// anything else.
ResultFile read_result(const std::filesystem::path& file);

}  // namespace mosbench
