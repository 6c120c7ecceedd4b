#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "datasets/sequence/sequence.hpp"
#include "eval/predictions/prediction_format.hpp"

namespace mosbench {

/// Where the predictions of a sequence lie and, by their names and first lines, in which format.
struct PredictionPlace {
  std::filesystem::path path;  ///< the folder of files per scan, or the one file
  PredictionFormat format;
};

/// Looks in the layouts of `mosbench run`, of semantic-kitti-api and of Dynablox; for an
/// `only_sequence` also in `root` itself. A format that is given is looked for, any other is
/// passed over. Throws DataError when there is nothing, or when it is the truth itself.
PredictionPlace find_predictions(const std::filesystem::path& root, const Sequence& sequence,
                                 bool only_sequence, std::optional<PredictionFormat> format);

/// Files of `folder` with this extension, hidden ones aside, sorted; none when it cannot be read.
std::vector<std::filesystem::path> files_with_extension(const std::filesystem::path& folder,
                                                        std::string_view extension);

}  // namespace mosbench
