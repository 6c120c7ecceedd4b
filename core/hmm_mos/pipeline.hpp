#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mosbench/scan.hpp>
#include <optional>
#include <span>
#include <vector>

#include "core/base/stage_times.hpp"
#include "core/hmm_mos/config.hpp"
#include "core/voxel/voxel_set.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench {

/// What is known about one scan once its labels are final.
struct ScanResult {
  std::size_t scan_index = 0;         ///< counts pushed scans from 0
  std::vector<std::uint32_t> labels;  ///< kStaticLabel or kMovingLabel, one per pushed point
  std::vector<std::int32_t> scores;   ///< see Pipeline::record_scores; empty unless asked for
  std::optional<double> threshold;   ///< Otsu's T; nothing when no detection ran or no level exists
  std::size_t nonfinite_points = 0;  ///< NaN or infinite, left out of the map, labelled static
  StageTimes stage_times{};          ///< of the push that took this scan in
};

/// A scan that is ready to enter the map: what was found about it without the map.
struct ObservedScan {
  VoxelizedScan scan;
  VoxelList observed;  ///< by its rays
  StageTimes stage_times{};
  std::vector<StageEvent> events;  ///< see Pipeline::record_stages
};

/// The whole method: push scans in order, receive labels. Independent pipelines share nothing.
/// Results are the same bits for any thread count.
class Pipeline {
 public:
  /// Throws std::invalid_argument as `check` does. `scan_count` is the length of the sequence when
  /// it is known: a delayed run then labels its last scans as the authors' program does; without it
  /// they are labelled static. release-2025 has no delay: delay_scans must be 0.
  Pipeline(const Config& config, Variant variant, unsigned threads = 1,
           std::optional<std::size_t> scan_count = std::nullopt);
  ~Pipeline();
  Pipeline(Pipeline&&) noexcept;
  Pipeline& operator=(Pipeline&&) noexcept;

  /// Takes one scan in and returns the scans whose labels became final, in scan order: exactly this
  /// one when online; none or earlier ones when delayed. Throws std::range_error naming the
  /// point when a voxel coordinate would overflow, std::logic_error beyond `scan_count` scans
  /// or after `finish`.
  std::vector<ScanResult> push(std::span<const Point> points, const Pose& map_from_sensor);

  /// `push` in two halves: the first, algorithm steps 1 and 2, needs nothing of the scans before.
  /// It may run in another thread while an earlier scan is pushed, so that two scans are under way;
  /// scans are still observed one at a time, in order, and pushed here. Throws std::range_error.
  ObservedScan observe(std::span<const Point> points, const Pose& map_from_sensor);
  std::vector<ScanResult> push(ObservedScan observed);

  /// The labels still held back by the delay, in scan order. Nothing when online.
  std::vector<ScanResult> finish();

  /// From now on appends every run of a stage to `events`, which must outlive that; null stops it.
  /// Reading the CPU clock twice per stage costs some microseconds per scan. To be called while no
  /// scan is observed.
  void record_stages(std::vector<StageEvent>* events);

  /// To be called before the first scan. Results then hold one dynamic score per point: S of its
  /// voxel, which Otsu's T is compared with (algorithm step 5c); 0 outside the map and in scans
  /// without detection. Labels stay as they are; off, which is the default, it costs nothing.
  void record_scores(bool record);

  /// Voxel blocks of 8x8x8 voxels held in the map, and the bytes of all memory kept between scans,
  /// the latter to be asked while no scan is observed.
  std::size_t map_blocks() const;
  std::size_t memory_bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mosbench
