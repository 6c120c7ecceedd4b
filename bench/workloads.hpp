#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/methods/hmm_mos/config.hpp"
#include "datasets/sequence/sequence.hpp"

namespace mosbench {
using namespace hmm_mos;

/// Scans to measure on, with the configuration that segments them.
struct Workload {
  std::string name;
  Config config;
  std::vector<Frame> frames;
};

/// Simulated: `indoor` (hand-held OS1-64, 20 m), `campus` (robot with a Livox Avia, 50 m) and
/// `highway` (car with an HDL-64E, 120 m).
std::vector<Workload> simulated_workloads();

/// The first scans of a recording, at 0.25 m and 50 m. Throws DataError and UsageError.
Workload recorded_workload(const std::filesystem::path& folder);

}  // namespace mosbench
