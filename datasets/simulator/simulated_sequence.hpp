#pragma once

#include <cstddef>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/layouts/layout.hpp"
#include "datasets/sequence/sequence.hpp"
#include "datasets/simulator/scene.hpp"
#include "datasets/simulator/simulate.hpp"

namespace mosbench {

/// Returns nothing when no layout of that name is simulated.
std::optional<DatasetKind> simulated_layout_from_string(std::string_view name);
/// Returns "doals, ... or kitti-tracking", for help and errors.
std::string simulated_layout_names();

/// Returns the recordings that a layout consists of, with the scene's name and the sensor that it
/// asks for. Throws UsageError where it may not, or no data set of the layout is simulated.
std::vector<SimulatedRecording> recordings_of(DatasetKind layout, const Scene& scene);

/// Returns the indices of the scans that get labels.
std::set<std::size_t> labelled_scans(DatasetKind layout, std::size_t scans);

/// Returns train, val and test, blocks of 68, 16 and 16 % of labelled scans; the test block is
/// never empty.
SplitNumbers simulated_splits(const std::set<std::size_t>& labelled);

/// Returns one recording as its layout stores it, but with the LiDAR's poses; disturbed where the
/// options say so.
std::unique_ptr<Sequence> simulated_sequence(const SimulateOptions& options, const Scene& scene,
                                             const SimulatedRecording& recording);

}  // namespace mosbench
