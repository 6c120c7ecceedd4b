#pragma once

#include <memory>
#include <string>

#include "datasets/layouts/dataset.hpp"
#include "datasets/sequence/sequence.hpp"
#include "datasets/simulator/scene.hpp"
#include "datasets/simulator/simulate.hpp"
#include "datasets/simulator/simulated_layouts.hpp"

namespace mosbench {

/// Returns the name that readers give a sequence: of DOALS with the scene's folder, of HeLiPR with
/// the sensor.
std::string simulated_name(DatasetKind layout, const SimulatedRecording& recording);

/// Returns one recording as its layout stores it, but with the LiDAR's poses; disturbed where the
/// options say so.
std::unique_ptr<Sequence> simulated_sequence(const SimulateOptions& options, const Scene& scene,
                                             const SimulatedRecording& recording);

}  // namespace mosbench
