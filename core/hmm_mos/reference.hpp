#pragma once

#include <memory>
#include <mosbench/method.hpp>

#include "core/hmm_mos/config.hpp"

namespace mosbench::hmm_mos {

/// The paper's section III step by step, in double precision, with hash maps of single voxels,
/// comparisons of all pairs and triple loops. Labels equal those of Pipeline, with which it shares
/// the config and nothing else.
class Reference final : public Method {
 public:
  /// Throws std::invalid_argument as `check` does.
  explicit Reference(const Config& config, const RunContext& context = {});
  ~Reference() override;

  using Method::push;
  std::unique_ptr<Observed> observe(std::span<const Point> points,
                                    const Pose& map_from_sensor) override;
  std::vector<LabelledScan> push(std::unique_ptr<Observed> observed) override;
  std::vector<LabelledScan> finish() override;
  std::vector<std::string> remarks() const override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mosbench::hmm_mos
