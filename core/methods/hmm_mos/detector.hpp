#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/base/stage_clock.hpp"
#include "core/base/thread_pool.hpp"
#include "core/methods/hmm_mos/config.hpp"
#include "core/methods/hmm_mos/dynamic_region.hpp"
#include "core/methods/hmm_mos/local_window.hpp"
#include "core/methods/hmm_mos/voxel_map.hpp"
#include "core/voxel/voxel_field.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench::hmm_mos {

/// The motion found in a scan.
struct Detection {
  VoxelSet moving;                  ///< among its occupied voxels
  SumField sums;                    ///< L^dyn
  std::optional<double> threshold;  ///< Otsu's T
};

/// Which of the held scans are judged when scan k has entered the map.
struct DueScans {
  bool none_yet = false;  ///< too few scans entered
  bool oldest = false;    ///< scan k - n
  bool newest = false;    ///< scan k
};

/// `scan_count`: of the sequence, when it is known. The authors' program labels the end of a
/// delayed sequence online, and leaves scan N - n static.
DueScans due_at(std::uint32_t k, const Config& config, std::optional<std::size_t> scan_count);

/// The method after its map (paper, III), with what it remembers between scans.
class Detector {
 public:
  Detector(const Config& config, const VoxelGrid& grid);

  /// Takes in a scan that is not judged: `due_at` says so.
  void skip() { window_.join({}); }

  /// Finds what moves in a scan with the map as it is after scan k.
  Detection detect(const VoxelizedScan& scan, VoxelMap& map, std::uint32_t k, ThreadPool& pool,
                   const StageRecord& record);

  std::size_t memory_bytes() const {
    return window_.memory_bytes() + region_.memory_bytes() + carried_.memory_bytes();
  }

 private:
  Config config_;
  LocalWindow window_;
  DynamicRegion region_;
  VoxelSet carried_;  // dynamic voxels of the previous detection
};

}  // namespace mosbench::hmm_mos
