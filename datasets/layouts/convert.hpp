#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>

#include "datasets/layouts/dataset.hpp"

namespace mosbench {

struct ConvertOptions {
  DatasetKind layout = DatasetKind::kSemanticKitti;  ///< one that `simulate` writes, too
  bool as_bag = false;                               ///< of kDoals: a bag instead of .bin scans
  std::string compression = "lz4";                   ///< of the bag's chunks: none, lz4, bz2
  std::filesystem::path out;                         ///< becomes the data set's root
};

/// Where a sequence of the source goes, relative to `ConvertOptions::out`, `position` being its
/// place in the source. Throws UsageError when the layout has no place for it.
std::filesystem::path converted_folder(DatasetKind layout, const std::string& name,
                                       std::size_t position);

/// Writes every frame of a data set in the layout, poses as the lidar's own, and for HeLiMOS the
/// splits that the source has. What was simulated stays marked as such. Throws UsageError when
/// `out` is not empty or the layout is one that is only read. `progress` is called with the scans
/// done and to do.
void convert(const Dataset& dataset, const ConvertOptions& options,
             const std::function<void(std::size_t done, std::size_t total)>& progress = {});

}  // namespace mosbench
