#include "eval/engine/shared_reading.hpp"

#include <algorithm>
#include <utility>

#include "eval/result/machine.hpp"

namespace mosbench {
namespace {

std::size_t most_kept_bytes() { return std::min(memory_bytes() / 4, std::size_t{2} << 30); }

}  // namespace

void SharedReading::share(Dataset& dataset) {
  for (std::size_t i = 0; i < dataset.sequences.size(); ++i) {
    std::shared_ptr<KeptScans>& scans = scans_[i];
    if (!scans) scans = std::make_shared<KeptScans>(most_kept_bytes());
    dataset.sequences[i] = std::make_unique<KeptSequence>(std::move(dataset.sequences[i]), scans);
  }
}

std::vector<ScanPose> SharedReading::poses_of(std::size_t position, const Sequence& sequence,
                                              const OdometryChoice& choice, unsigned threads) {
  if (choice.filter) return find_poses(sequence, choice, threads);
  const auto known = poses_.find(position);
  if (known != poses_.end()) return known->second;
  return poses_[position] = find_poses(sequence, choice, threads);
}

void SharedReading::forget(std::size_t position) {
  scans_.at(position)->clear();
  poses_.erase(position);
}

}  // namespace mosbench
