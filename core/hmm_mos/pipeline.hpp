#pragma once

#include <memory>
#include <mosbench/method.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/hmm_mos/config.hpp"

namespace mosbench::hmm_mos {

/// The whole method (paper, III). Scores are L^dyn of a point's voxel, which Otsu's T is compared
/// with; 0 outside the map and in scans that are not judged.
class Pipeline final : public Method {
 public:
  /// With a scan_count a delayed run labels its last scans as the authors' program does; without it
  /// they are static. Throws std::invalid_argument as `check` does, and for 0 threads.
  explicit Pipeline(const Config& config, const RunContext& context = {});
  ~Pipeline() override;
  Pipeline(Pipeline&&) noexcept;
  Pipeline& operator=(Pipeline&&) noexcept;

  std::unique_ptr<Observed> observe(std::span<const Point> points,
                                    const Pose& map_from_sensor) override;
  std::vector<LabelledScan> push(std::unique_ptr<Observed> observed) override;
  std::vector<LabelledScan> push(std::span<const Point> points,
                                 const Pose& map_from_sensor) override;
  std::vector<LabelledScan> finish() override;
  MemoryUse memory() const override;
  std::vector<std::string> remarks() const override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Describes how the end of a delayed sequence is labelled; empty when online or of unknown length.
std::vector<std::string> remarks_on_delay(const Config& config, const RunContext& context);

}  // namespace mosbench::hmm_mos
