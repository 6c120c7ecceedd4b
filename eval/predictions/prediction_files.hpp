#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mosbench/scan.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/formats/npy_file.hpp"
#include "datasets/sequence/sequence.hpp"
#include "datasets/text/errors.hpp"
#include "eval/predictions/predictions.hpp"
#include "eval/protocols/confusion.hpp"
#include "eval/protocols/protocol.hpp"

namespace mosbench {

/// Collects errors of predictions: throws the first one or, where the user allows missing
/// predictions, keeps each as a remark.
class PredictionErrors {
 public:
  explicit PredictionErrors(bool allowed) : allowed_(allowed) {}

  /// Throws `error` unless it is allowed.
  void report(const DataError& error) {
    if (!allowed_) throw error;
    texts_.push_back(std::string("passed over: ") + error.what());
  }
  const std::vector<std::string>& texts() const { return texts_; }

 private:
  bool allowed_;
  std::vector<std::string> texts_;
};

/// Path of the predictions of a sequence and their format.
struct PredictionPlace {
  std::filesystem::path path;  ///< the folder of files per scan, or the one file
  PredictionFormat format;
};

/// Searches the layouts of `mosbench run`, of semantic-kitti-api and of Dynablox; for an
/// `only_sequence` also `root` itself. With a given format, files of others are ignored; otherwise
/// it is recognised by file names and first lines. Throws DataError when nothing is found, or when
/// it is the truth itself.
PredictionPlace find_predictions(const std::filesystem::path& root, const Sequence& sequence,
                                 bool only_sequence, std::optional<PredictionFormat> format);

/// A file of predictions with the name by which its scan is found.
struct NamedFile {
  std::string stem;
  std::filesystem::path file;
};

/// Lists the files per scan of a place. 4DMOS keeps a folder of confidences per scan; its
/// SCAN_dt_*.npy are for earlier scans too. The scan's own file, without delay, is listed.
std::vector<NamedFile> prediction_files(const PredictionPlace& place);

/// Throws DataError where predictions that name scans by position may mean other ones, because some
/// are left out.
void check_positions(const std::filesystem::path& path, const Sequence& sequence);

/// Parses labels (9 or 251) from a text file with a row per point: "0" or "1", or "moveable moving
/// class". Throws DataError with the line.
std::vector<std::uint32_t> parse_point_text(std::string_view text, std::size_t point_count,
                                            const std::filesystem::path& file);

/// Parses the labels of each cloud of Dynablox's clouds.csv, by CloudNo from 0. Throws DataError.
std::vector<std::vector<std::uint32_t>> parse_dynablox_clouds(std::string_view text,
                                                              DynabloxLevel level,
                                                              const std::filesystem::path& file);

/// Counts in a row of Dynablox's scores.csv.
struct DynabloxCounts {
  Confusion counts;
  std::uint64_t total_points = 0;
};

/// Throws DataError with the line, also when the counts do not add up to EvaluatedPoints.
std::vector<DynabloxCounts> parse_dynablox_counts(std::string_view text, DynabloxLevel level,
                                                  const std::filesystem::path& file);

/// Parses the first column of Dynablox's scores.csv, whatever levels it evaluated. Throws DataError
/// with the line.
std::vector<std::uint64_t> parse_dynablox_stamps_ns(std::string_view text,
                                                    const std::filesystem::path& file);

/// Says what a NumPy .npy file holds: integers are label ids or classes, others confidences.
NumpyKind read_npy_kind(const std::filesystem::path& file);
/// Reads ids of a .npy file of integers, for a scan one per point. Throw DataError.
std::vector<std::uint32_t> read_npy_ids(const std::filesystem::path& file);
std::vector<std::uint32_t> read_npy_labels(const std::filesystem::path& file,
                                           std::size_t point_count);

/// Reads confidences 0..1 per point from a NumPy .npy file (of reals or booleans, and of any
/// shape with as many numbers as the scan has points). Throws DataError.
std::vector<double> read_npy_confidences(const std::filesystem::path& file,
                                         std::size_t point_count);

/// Above 0.5 a point is moving, as in 4DMOS's confidences_to_labels.py.
std::vector<std::uint32_t> labels_of_confidences(std::span<const double> confidences);

/// Opens predictions in a file per scan, paired by stem or by position. Files without scan and
/// label files of the wrong size go to `errors`, what was recognised to `remarks`.
std::unique_ptr<Predictions> open_scan_files(const PredictionPlace& place, const Sequence& sequence,
                                             const std::vector<std::size_t>& wanted,
                                             const PredictionOptions& options,
                                             PredictionErrors& errors,
                                             std::vector<std::string>& remarks);

/// Opens predictions of a whole sequence in one file: HMM-MOS's rows, indices.csv, Dynablox's
/// clouds.csv and scores.csv. Rows that match no scan go to `errors`. Throws DataError.
std::unique_ptr<Predictions> open_sequence_file(const PredictionPlace& place,
                                                const Sequence& sequence,
                                                const PredictionOptions& options,
                                                PredictionErrors& errors);

}  // namespace mosbench
