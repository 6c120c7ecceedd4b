#pragma once

#include <cstddef>
#include <memory>
#include <mosbench/method.hpp>
#include <optional>
#include <span>
#include <vector>

#include "core/methods/hmm_mos/mapping.hpp"

namespace mosbench::hmm_mos {

/// A method that judges scans with the map of HMM-MOS. Here scans are observed and enter the map;
/// what happens then is the method's own.
class MappedMethod : public Method {
 public:
  std::unique_ptr<Observed> observe(std::span<const Point> points,
                                    const Pose& map_from_sensor) final {
    return mapping_->observe_ahead(points, map_from_sensor);
  }
  std::vector<LabelledScan> push(std::unique_ptr<Observed> observed) final {
    return entered(mapping_->enter(observed.get()));
  }
  std::vector<LabelledScan> push(std::span<const Point> points, const Pose& map_from_sensor) final {
    mapping_->expect_scan();
    return push(mapping_->observe(points, map_from_sensor));
  }
  std::vector<LabelledScan> finish() final {
    mapping_->finish();
    return release_all();
  }
  std::optional<MemoryUse> memory() const final {
    return MemoryUse{mapping_->memory_bytes() + held_bytes(), mapping_->map_blocks()};
  }

 protected:
  /// Throws std::invalid_argument for 0 threads.
  MappedMethod(const Config& config, const RunContext& context)
      : mapping_(std::make_unique<Mapping>(config, context)) {}

  Mapping& mapping() { return *mapping_; }
  const RunContext& context() const { return mapping_->context(); }

 private:
  /// Returns the scans whose labels became final when `current` entered the map.
  virtual std::vector<LabelledScan> entered(ObservedScan& current) = 0;
  virtual std::vector<LabelledScan> release_all() = 0;
  /// What the method keeps beside the map.
  virtual std::size_t held_bytes() const = 0;

  std::unique_ptr<Mapping> mapping_;
};

/// Returns what is known of a scan before it is judged. Takes its stages away.
inline LabelledScan begun_result(ObservedScan& scan, std::size_t k) {
  LabelledScan result;
  result.scan_index = k;
  result.nonfinite_points = scan.scan.nonfinite_points;
  result.stages = std::move(scan.stages);
  return result;
}

}  // namespace mosbench::hmm_mos
