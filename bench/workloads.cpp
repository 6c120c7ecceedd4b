#include "bench/workloads.hpp"

#include <algorithm>

#include "datasets/layouts/dataset.hpp"
#include "datasets/simulator/simulator.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

constexpr std::size_t kScans = 24;

Workload simulated(const std::string& name, const char* scene, const char* sensor,
                   double voxel_size_m, double max_range_m) {
  Workload workload{name, {}, {}};
  workload.config.voxel_size_m = voxel_size_m;
  workload.config.max_range_m = max_range_m;
  const Simulator simulator = built_in_simulator(scene, sensor, 1);
  for (std::size_t k = 0; k < kScans; ++k) workload.frames.push_back(simulator.frame(k));
  return workload;
}

}  // namespace

std::vector<Workload> simulated_workloads() {
  std::vector<Workload> workloads;
  workloads.push_back(simulated("indoor", "mall", "os1-64", 0.20, 20));
  workloads.push_back(simulated("campus", "campus", "avia", 0.25, 50));
  workloads.push_back(simulated("highway", "highway", "hdl-64e", 0.25, 120));
  return workloads;
}

Workload recorded_workload(const std::filesystem::path& folder) {
  Workload workload{"recorded", {}, {}};
  workload.config.voxel_size_m = 0.25;
  workload.config.max_range_m = 50;
  const Dataset dataset = open_dataset(folder, {});
  const Sequence& sequence = *dataset.sequences.front();
  const auto needed = static_cast<std::size_t>(workload.config.local_window_scans) + 2;
  if (sequence.size() < needed) {
    throw DataError(folder, "has " + std::to_string(sequence.size()) + " scans",
                    "at least " + std::to_string(needed) + ", so that detection runs");
  }
  for (std::size_t k = 0; k < std::min(kScans, sequence.size()); ++k) {
    workload.frames.push_back(sequence.read(k));
  }
  return workload;
}

}  // namespace mosbench
