#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/sequence/sequence.hpp"
#include "datasets/text/errors.hpp"
#include "eval/protocols/confusion.hpp"
#include "eval/protocols/protocol.hpp"

namespace mosbench {

/// File formats of predictions; docs/formats/predictions.md describes them.
enum class PredictionFormat : std::uint8_t {
  kLabel,
  kLabelByIndex,
  kMaskedLabel,
  kText,
  kPcd,
  kCsv,
  kNpy,
  kRows,
  kIndices,
  kDynabloxClouds,
  kDynabloxScores,
  kHdf5
};

struct DescribedFormat {
  PredictionFormat format;
  std::string_view name;       ///< for --format
  std::string_view extension;  ///< of its files
  bool per_scan;               ///< a file per scan; otherwise one for the whole sequence
  std::string_view description;
};

std::span<const DescribedFormat> prediction_formats();
const DescribedFormat& describe(PredictionFormat format);
/// Throws UsageError naming all formats.
PredictionFormat prediction_format_named(std::string_view name);

/// Which of Dynablox's three decisions per point counts; its paper reports objects.
enum class DynabloxLevel : std::uint8_t { kPoint, kCluster, kObject };

/// Throws UsageError for a name that is not point, cluster or object.
DynabloxLevel dynablox_level_named(std::string_view name);
/// Returns the name that `dynablox_level_named` takes.
std::string_view to_string(DynabloxLevel level);

/// A label id in prediction files.
struct PredictedId {
  std::uint16_t id;
  std::uint64_t points;              ///< that have it, in all files
  std::filesystem::path first_file;  ///< that holds it
};

/// Reads every .label file, or .npy file of integers, and returns the ids in them in ascending
/// order. Throws DataError naming the first file that holds something else than little-endian
/// uint32: big-endian numbers or float32.
std::vector<PredictedId> ids_in(std::span<const std::filesystem::path> files);

/// Returns a remark if no point is predicted moving, or more than half of the points: methods find
/// few moving points, so the ids may have another meaning. Empty otherwise. `ids` are those of the
/// files, empty for formats without ids.
std::string strange_share(std::uint64_t moving, std::uint64_t points,
                          std::span<const PredictedId> ids, const Protocol& protocol);

/// From a network's class numbers to the data set's label ids.
using LabelIdMap = std::map<std::uint16_t, std::uint16_t>;

/// What the user specified about predictions; the rest is recognised.
struct PredictionOptions {
  std::optional<PredictionFormat> format;
  std::optional<RangeGate> mask;
  std::optional<LabelIdMap> id_map;
  DynabloxLevel level = DynabloxLevel::kObject;
  bool allow_missing = false;  ///< leave out scans with bad files instead of throwing
};

/// Predicted labels of one sequence.
class Predictions {
 public:
  virtual ~Predictions() = default;
  virtual bool has(std::size_t scan_index) const = 0;
  /// Reads raw labels, one per point of the scan. Safe to call from several threads. Throws
  /// DataError.
  virtual std::vector<std::uint32_t> read(std::size_t scan_index) const = 0;
  /// Reads how sure it is that each point moves; none for formats of labels. Throws DataError.
  virtual std::vector<double> confidences(std::size_t) const { return {}; }
  /// Returns what `read` returns, without reading again what `confidences` returned.
  virtual std::vector<std::uint32_t> labels(std::size_t scan_index,
                                            std::span<const double> /*confidences*/) const {
    return read(scan_index);
  }
  /// Returns the scan's counts for formats that hold counts instead of labels.
  virtual std::optional<Confusion> counts(std::size_t) const { return std::nullopt; }
  /// Returns the ids in the files of the wanted scans; none for formats without ids.
  virtual std::span<const PredictedId> ids() const { return {}; }
};

struct OpenedPredictions {
  std::unique_ptr<Predictions> labels;
  PredictionFormat format;
  bool guessed;                ///< the format; false when the user named it
  std::filesystem::path path;  ///< file or folder
  std::vector<std::string>
      remarks;  ///< what was recognised and, with allow_missing, what was left out
  std::vector<std::string> missing;   ///< stems of wanted scans without a usable prediction
  std::vector<std::string> doubts{};  ///< whether these are labels of these scans
  /// Returns the error with the format in which the predictions were read.
  DataError with_format(const DataError& error) const;
};

/// Parses "0:0,1:9,2:251". Throws UsageError.
LabelIdMap parse_id_map(const std::string& text);
/// Returns the text that `parse_id_map` takes.
std::string id_map_text(const LabelIdMap& map);

/// Finds the predictions of a sequence below `root` (or `root` itself for an `only_sequence`),
/// recognises their format and pairs them with the scans. Unless allow_missing,
/// throws DataError naming the file when one of the `wanted` scans has no prediction, a file
/// matches no scan or has another size than its scan, or when `root` holds the truth.
OpenedPredictions open_predictions(const std::filesystem::path& root, const Sequence& sequence,
                                   const std::vector<std::size_t>& wanted, bool only_sequence,
                                   const PredictionOptions& options);

}  // namespace mosbench
