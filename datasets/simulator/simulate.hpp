#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/thread_pool.hpp"
#include "datasets/layouts/layout.hpp"
#include "datasets/sequence/sequence.hpp"
#include "datasets/simulator/scene.hpp"

namespace mosbench {

struct SimulateOptions {
  DatasetKind layout = DatasetKind::kSemanticKitti;
  std::string scene;  ///< name of a built-in scene, or the path of a .json file
  std::size_t scans = 0;
  std::uint64_t seed = 1;
  std::optional<Perturbation> perturb = std::nullopt;
  std::filesystem::path out;              ///< becomes the data set's root
  unsigned threads = hardware_threads();  ///< the files do not depend on it
};

/// Writes a simulated data set in the layout of a real one, each file atomically and the poses
/// last: what a killed run leaves cannot be opened and is completed by the same call. Throws
/// UsageError when `out` holds anything but a simulation of the same parameters, DataError for a
/// bad scene file or an unwritable folder. `progress` is called with the scans done and to do,
/// never from two threads at once. Returns a sentence for all that the layout did not keep.
std::vector<std::string> simulate(
    const SimulateOptions& options,
    const std::function<void(std::size_t done, std::size_t total)>& progress = {});

/// Returns a hash of the whole scene.
std::string fingerprint_of(const Scene& scene);

/// Returns whether a simulation of this layout consists of several sequences.
bool simulates_several(DatasetKind layout);

/// Returns the names of the sequences that a simulation consists of. Throws UsageError as
/// `simulate`.
std::vector<std::string> simulated_names(DatasetKind layout, const Scene& scene);

/// Returns the scene of a built-in name, or of a file when the name ends in .json or has a slash.
Scene load_scene(const std::string& name_or_file);

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
