#pragma once

#include <memory>
#include <mosbench/method.hpp>
#include <span>
#include <vector>

#include "core/base/push_order.hpp"
#include "core/base/thread_pool.hpp"

namespace mosbench {

/// A scan that was checked and copied, nothing else.
struct PosedScan final : NumberedScan {
  std::vector<Point> points;
  Pose map_from_sensor = Pose::Identity();
  std::size_t nonfinite_points = 0;
};

/// Base of methods that do all their work on a scan when it is pushed. Keeps what Method promises
/// about points, poses and the order of scans.
class SequentialMethod : public Method {
 public:
  std::unique_ptr<Observed> observe(std::span<const Point> points,
                                    const Pose& map_from_sensor) final;
  using Method::push;
  std::vector<LabelledScan> push(std::unique_ptr<Observed> observed) final;
  std::vector<LabelledScan> finish() final;

 protected:
  /// Points with a coordinate beyond `reach_m` are refused. Throws std::invalid_argument for 0
  /// threads.
  SequentialMethod(const RunContext& context, double reach_m);

  const RunContext& context() const { return context_; }
  ThreadPool& pool() { return pool_; }

 private:
  /// Takes the next scan in. `result` is that of a scan that is not judged: its index is set, all
  /// points are static and have the score 0. Returns scans as Method::push does.
  virtual std::vector<LabelledScan> take(PosedScan& scan, LabelledScan result) = 0;
  /// Returns the scans that are still held.
  virtual std::vector<LabelledScan> release() { return {}; }

  RunContext context_;
  double reach_m_;
  PushOrder order_;
  ThreadPool pool_;
};

}  // namespace mosbench
