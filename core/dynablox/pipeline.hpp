#pragma once

#include <memory>
#include <mosbench/method.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/dynablox/config.hpp"

namespace mosbench::dynablox {

/// Schmid, Andersson, Sulser, Pfreundschuh, Siegwart: Dynablox, RA-L 2023, in the order of the
/// authors' program: points of scan k are judged by the map of the scans before, then the ever-free
/// voxels are brought up to date, then the scan enters the map. Online. Scores are the distance of
/// the point's voxel to the nearest surface, metres, tau more where it is ever-free, 0 where it was
/// not observed; no threshold is compared with them. With level=object, objects are the tracks.
class Pipeline final : public Method {
 public:
  /// Throws std::invalid_argument as `check` does, and for 0 threads.
  explicit Pipeline(const Config& config, const RunContext& context = {});
  ~Pipeline() override;

  std::unique_ptr<Observed> observe(std::span<const Point> points,
                                    const Pose& map_from_sensor) override;
  std::vector<LabelledScan> push(std::unique_ptr<Observed> observed) override;
  std::vector<LabelledScan> push(std::span<const Point> points,
                                 const Pose& map_from_sensor) override;
  std::vector<LabelledScan> finish() override;
  std::optional<MemoryUse> memory() const override;
  std::vector<std::string> remarks() const override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mosbench::dynablox
