#include "core/methods/hmm_mos_plus/tracks.hpp"

#include <cmath>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

#include "core/methods/hmm_mos_plus/objects.hpp"

namespace mosbench::hmm_mos_plus {
namespace {

/// How far from where it is expected an object is still the same one. 10 and 40 find as much.
constexpr double kMaxError_m_s = 20;
/// Nothing is followed over more.
constexpr double kLongestStep_s = 1;
/// Voxels by which a prediction is corrected at most along x and y: two or three scans tell no
/// better how fast a surface moves that is one voxel thick.
constexpr int kCorrection = 2;
/// Centres are rounded down to these parts of a voxel, so that they shift exactly with the map.
constexpr std::int64_t kParts = 256;

double mean_of(std::int64_t sum, std::int64_t count) {
  const std::int64_t parts = sum * kParts;
  return static_cast<double>(parts / count - (parts % count < 0 ? 1 : 0)) / kParts;
}

std::array<double, 3> centre_of(const std::vector<Voxel>& voxels) {
  std::int64_t x = 0, y = 0, z = 0;
  for (const Voxel& v : voxels) x += v.x, y += v.y, z += v.z;
  const auto count = static_cast<std::int64_t>(voxels.size());
  return {mean_of(x, count), mean_of(y, count), mean_of(z, count)};
}

/// Returns the voxels of the scan where those of an object are when moved on by `shift`, and may
/// move. Gives up when there cannot be `worth` of them.
std::vector<std::uint32_t> match(const std::vector<Voxel>& voxels, const Voxel& shift,
                                 std::size_t worth, const VoxelizedScan& scan, LowVoxels& low,
                                 const ArrivalClasses& classes) {
  std::vector<std::uint32_t> found;
  for (std::size_t i = 0; i < voxels.size() && found.size() + voxels.size() - i >= worth; ++i) {
    const Voxel& v = voxels[i];
    const Voxel at{v.x + shift.x, v.y + shift.y, v.z + shift.z};
    const std::uint32_t slot = scan.measured.find(block_of(at)), cell = cell_of(at);
    if (slot == kNoSlot || !scan.occupied[slot].test(cell)) continue;
    if (classes.standing[slot].test(cell) || low.in(slot).test(cell)) continue;
    found.push_back(slot * kBlockVoxels + cell);
  }
  return found;
}

/// Whether two steps make less than a right angle. Others would let what stops be its own evidence.
bool leads_along(const Voxel& step, const Voxel& other) {
  return step.x * other.x + step.y * other.y + step.z * other.z > 0;
}

/// The same with the correction that finds most, the smallest of those.
std::vector<std::uint32_t> best_match(const std::vector<Voxel>& voxels, const Voxel& shift,
                                      const VoxelizedScan& scan, LowVoxels& low,
                                      const ArrivalClasses& classes) {
  std::vector<std::uint32_t> best = match(voxels, shift, 0, scan, low, classes);
  if (best.size() == voxels.size()) return best;
  int best_squared = 0;
  for (int dy = -kCorrection; dy <= kCorrection; ++dy) {
    for (int dx = -kCorrection; dx <= kCorrection; ++dx) {
      const Voxel corrected{shift.x + dx, shift.y + dy, shift.z};
      const int squared = dx * dx + dy * dy;
      if (squared == 0 || !leads_along(corrected, shift)) continue;
      std::vector<std::uint32_t> found = match(voxels, corrected, best.size(), scan, low, classes);
      if (found.size() < best.size()) continue;
      if (found.size() == best.size() && squared >= best_squared) continue;
      best = std::move(found);
      best_squared = squared;
    }
  }
  return best;
}

/// Whether velocities, in voxels, are of something that goes on: half a voxel or more, and at most
/// half of that off.
bool are_alike(const std::array<double, 3>& velocity, const std::array<double, 3>& before) {
  double length_sq = 0, error_sq = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double error = velocity[axis] - before[axis];
    length_sq += before[axis] * before[axis];
    error_sq += error * error;
  }
  return length_sq >= 0.25 && 4 * error_sq <= length_sq;
}

double seconds_of(const Tick& tick) { return tick.period_s * tick.periods; }

/// After so many scans most voxels that an object left are free.
constexpr std::size_t kScans = 2;

}  // namespace

Tracks::Tracks(const Config& config)
    : min_steps_(config.min_track_steps),
      max_error_voxels_s_(kMaxError_m_s / config.map.voxel_size_m) {}

void Tracks::add_seeds(const VoxelizedScan& scan, LowVoxels& low, const Tick& tick,
                       ArrivalClasses& classes) const {
  if (seconds_of(tick) > kLongestStep_s) return;
  for (const Track& track : tracks_) {
    if (track.steps < min_steps_) continue;
    const auto ahead = [&](std::size_t axis) {
      return static_cast<std::int32_t>(std::lround(track.velocity[axis] * tick.periods));
    };
    const Voxel shift{ahead(0), ahead(1), ahead(2)};
    if (shift == Voxel{}) continue;  // else what stops would be its own evidence
    for (const std::uint32_t voxel : best_match(track.voxels, shift, scan, low, classes)) {
      classes.seeds[voxel / kBlockVoxels].set(voxel % kBlockVoxels);
      classes.fresh[voxel / kBlockVoxels].set(voxel % kBlockVoxels);
    }
  }
}

const Tracks::Track* Tracks::nearest_to(const Vector& centre, const Tick& tick) const {
  const auto error_sq = [&](const Track& track) {
    double sum = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double error = centre[axis] - track.centre[axis] - track.velocity[axis] * tick.periods;
      sum += error * error;
    }
    return sum;
  };
  // The order in which objects were found decides nothing.
  const auto rank = [&](const Track& track) {
    return std::tuple(error_sq(track), track.centre, track.velocity, track.steps);
  };
  const double limit = max_error_voxels_s_ * seconds_of(tick);
  const Track* nearest = nullptr;
  for (const Track& track : tracks_) {
    if (error_sq(track) > limit * limit) continue;
    if (nearest == nullptr || rank(track) < rank(*nearest)) nearest = &track;
  }
  return nearest;
}

void Tracks::follow(const VoxelizedScan& scan, std::vector<Component>& components,
                    const Tick& tick) {
  if (seconds_of(tick) > kLongestStep_s) tracks_.clear();
  std::vector<Track> followed;
  for (Component& component : components) {
    if (!component.moves) continue;
    Track& track = followed.emplace_back();
    for (const std::uint32_t voxel : component.voxels) {
      track.voxels.push_back(
          voxel_at(scan.measured.blocks[voxel / kBlockVoxels], voxel % kBlockVoxels));
    }
    track.centre = centre_of(track.voxels);
    const Track* before = nearest_to(track.centre, tick);
    if (before == nullptr) continue;
    track.steps = before->steps + 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      track.velocity[axis] = (track.centre[axis] - before->centre[axis]) / tick.periods;
    }
    if (are_alike(track.velocity, before->velocity)) track.steady_steps = before->steady_steps + 1;
    component.steady_steps = track.steady_steps;
  }
  tracks_ = std::move(followed);
}

std::size_t Tracks::memory_bytes() const {
  std::size_t bytes = tracks_.capacity() * sizeof(Track);
  for (const Track& track : tracks_) bytes += track.voxels.capacity() * sizeof(Voxel);
  return bytes;
}

LookBack::LookBack(const Config& config) : config_(config), tracks_(config) {}

void LookBack::look(const RememberedMap& map, ThreadPool& pool) {
  if (past_.size() < kScans) return;
  Past& then = past_.front();
  add_departures(then.scan, map, config_, pool, then.classes);
  LowVoxels low(then.scan, *then.ground);
  std::vector<Component> found =
      find_components(then.scan, then.classes, *then.ground, low, config_);
  tracks_.follow(then.scan, found, then.tick);
  past_.pop_front();
}

void LookBack::add_seeds(const VoxelizedScan& scan, LowVoxels& low, ArrivalClasses& classes) const {
  Tick since = past_.back().tick;
  since.periods = 0;
  for (const Past& later : past_) since.periods += later.tick.periods;
  tracks_.add_seeds(scan, low, since, classes);
}

void LookBack::enter(const VoxelizedScan& scan, const ArrivalClasses& classes,
                     std::shared_ptr<const Ground> ground, const Tick& tick,
                     const RememberedMap& map, ThreadPool& pool) {
  look(map, pool);
  ScanMasks may_move(scan.occupied.size());
  for (std::uint32_t slot = 0; slot < may_move.size(); ++slot) {
    may_move[slot] = without(scan.occupied[slot], classes.settled[slot]) | classes.seeds[slot];
  }
  const std::vector<std::uint32_t> slots = slots_with_any(may_move);
  const auto of_slots = [&](const ScanMasks& masks) {
    ScanMasks kept(slots.size());
    for (std::size_t i = 0; i < slots.size(); ++i) kept[i] = masks[slots[i]];
    return kept;
  };
  VoxelizedScan part;
  part.measured.reserve(slots.size());
  for (const std::uint32_t slot : slots) part.measured.insert(scan.measured.blocks[slot]);
  part.occupied = of_slots(may_move);
  past_.push_back({std::move(part),
                   {.seeds = of_slots(classes.seeds),
                    .arrived = ScanMasks(slots.size()),
                    .fresh = of_slots(classes.fresh),
                    .settled = ScanMasks(slots.size()),
                    .aged = of_slots(classes.aged),
                    .open = ScanMasks(slots.size()),
                    .standing = of_slots(classes.standing)},
                   std::move(ground),
                   tick});
}

std::size_t LookBack::memory_bytes() const {
  std::size_t bytes = tracks_.memory_bytes();
  for (const Past& past : past_) {
    bytes += past.scan.memory_bytes() + past.classes.memory_bytes() + past.ground->memory_bytes();
  }
  return bytes;
}

}  // namespace mosbench::hmm_mos_plus
