#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "datasets/sequence/sequence.hpp"
#include "eval/predictions/prediction_format.hpp"

namespace mosbench {

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

/// Lists the files of `folder` with this extension, without hidden ones, sorted; empty when the
/// folder cannot be read.
std::vector<std::filesystem::path> files_with_extension(const std::filesystem::path& folder,
                                                        std::string_view extension);

}  // namespace mosbench
