#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/layouts/dataset.hpp"
#include "datasets/layouts/helimos_layout.hpp"
#include "datasets/simulator/simulator.hpp"

namespace mosbench {

/// One sensor's folder within a simulated data set.
struct SimulatedRecording {
  std::filesystem::path folder;  ///< relative to the root
  SensorKind sensor;
};

/// Returns nothing when no layout of that name is simulated.
std::optional<DatasetKind> simulated_layout_from_string(std::string_view name);
/// Returns "doals, ... or helipr", for help and errors.
std::string simulated_layout_names();

/// Returns the recordings that a layout consists of: DOALS an OS1-64, Sipailou an Avia (sequence
/// 06, its valid split), HeLiMOS its four sensors, SemanticKITTI an HDL-64E (sequence 08, its valid
/// split), OpenSceneFlow one as well, nuScenes an HDL-32E, HeLiPR its Aeva and its Ouster, KITTI's
/// drives an HDL-64E. A sensor named by the scene replaces that of the layout. Throws UsageError
/// where it may not.
std::vector<SimulatedRecording> recordings_of(DatasetKind layout, const Scene& scene);

/// Returns the indices of the scans that get labels: ten for DOALS, the last scan included, from
/// the fifth on; every fourth for HeLiMOS, every fifth for nuScenes; none for HeLiPR, which has no
/// labels; all otherwise. Else never empty.
std::set<std::size_t> labelled_scans(DatasetKind layout, std::size_t scans);

/// Returns blocks of 68, 16 and 16 % of HeLiMOS's labelled scans; the test block is never empty.
HelimosSplits simulated_splits(const std::set<std::size_t>& labelled);

/// Returns the value in the label file of a point that has a return.
/// Sipailou: 9, 251 or for vehicles 252 within 3..50 m, else 0. HeLiMOS: 9 or 251 within 80 m, else
/// 0. SemanticKITTI: its class ids, with the owner as instance of movable things. OpenSceneFlow: 9,
/// 251 or 0 with such instances, where only 0 is kept, as its truth is a flow. nuScenes: 9 or 251,
/// as what is in no box is static. KITTI's drives: 9, 251 or 0, which all beyond the camera's view
/// has. The owner is the instance of what moves in both.
std::uint32_t layout_label(DatasetKind layout, const SimulatedScan& scan, std::size_t point);

/// Returns DOALS's truth, by appearance: moving are the points of what moves and of what looks as
/// if it could, static all others.
std::vector<std::uint32_t> doals_truth(const SimulatedScan& scan);

}  // namespace mosbench
