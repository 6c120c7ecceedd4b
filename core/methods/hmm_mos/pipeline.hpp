#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mosbench/method.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/base/stage_clock.hpp"
#include "core/base/thread_pool.hpp"
#include "core/methods/hmm_mos/config.hpp"
#include "core/methods/hmm_mos/convolution.hpp"
#include "core/methods/hmm_mos/dynamic_region.hpp"
#include "core/methods/hmm_mos/mapping.hpp"
#include "core/methods/hmm_mos/voxel_map.hpp"
#include "core/voxel/voxel_set.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench::hmm_mos {

/// Returns a label per point (paper, III: points take the label of their voxel): kMovingLabel in
/// voxels of `moving`, kStaticLabel elsewhere.
std::vector<std::uint32_t> project_labels(const VoxelizedScan& scan, const VoxelSet& moving);

/// Returns L^dyn of every point's voxel; 0 where the point has no voxel or the voxel no score.
std::vector<float> project_scores(const VoxelizedScan& scan, const SumField& sums);

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

/// The whole method (paper, III). Scores are L^dyn of a point's voxel, which Otsu's T is compared
/// with; 0 outside the map and in scans that are not judged.
class Pipeline final : public MappedMethod {
 public:
  /// With a scan_count a delayed run labels its last scans as the authors' program does; without it
  /// they are static. Throws std::invalid_argument as `check` does, and for 0 threads.
  explicit Pipeline(const Config& config, const RunContext& context = {});

  std::vector<std::string> remarks() const override;

 private:
  /// A scan whose labels are not final yet.
  struct HeldScan {
    VoxelizedScan scan;
    LabelledScan result;
  };

  std::vector<LabelledScan> entered(ObservedScan& current, LabelledScan begun) override;
  std::vector<LabelledScan> release() override { return release(held_.size()); }
  std::size_t held_bytes() const override;
  void judge(HeldScan& held);
  std::vector<LabelledScan> release(std::size_t count);

  Config config_;
  std::optional<Detector> detector_;
  std::deque<HeldScan> held_;  // the last delay + 1 scans, current one last
};

/// Says that a long delay costs precision, and how the end of a delayed sequence of known length is
/// labelled.
std::vector<std::string> remarks_on_delay(const Config& config, const RunContext& context);

/// Makes the method that follows the paper's section III step by step: hash maps of single voxels,
/// all pairs, triple loops. Its labels equal those of Pipeline, with which it shares the config and
/// nothing else. Throws std::invalid_argument as `check` does.
std::unique_ptr<Method> make_reference(const Config& config, const RunContext& context = {});

}  // namespace mosbench::hmm_mos
