#pragma once

#include <algorithm>
#include <memory>
#include <mosbench/method.hpp>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

#include "core/base/thread_pool.hpp"

namespace mosbench {

/// A scan that remembers which method observed it, and when.
struct NumberedScan : Observed {
  const void* observer = nullptr;
  std::size_t number = 0;
};

/// Throws std::range_error for a pose that is not finite, or whose rotation departs from an
/// orthonormal right-handed one by more than a thousandth.
void check_rigid(const Pose& pose);

/// Throws std::invalid_argument unless each of `points` points has one finite origin, or none any.
void check_origins(const RayOrigins& origins, std::size_t points);

/// Throws std::invalid_argument for several origins: of a method that looks from one place.
void expect_one_origin(const RayOrigins& origins);

/// Returns the context. Throws std::invalid_argument for 0 threads.
const RunContext& checked(const RunContext& context);

/// Base of methods. Keeps what Method promises about poses and the order of scans: own scans alone,
/// in the order in which they were observed, no more than announced, none after the end.
template <typename Scan>
class ScanMethod : public Method {
 public:
  std::unique_ptr<Observed> observe(std::span<const Point> points, const Pose& map_from_sensor,
                                    const RayOrigins& origins = {}) final {
    // The other half of the threads pushes the previous scan.
    if (!observing_pool_) observing_pool_.emplace(std::max(1U, pool_.size() / 2));
    return observe_by(points, map_from_sensor, origins, *observing_pool_);
  }
  std::vector<LabelledScan> push(std::unique_ptr<Observed> observed) final {
    expect_scan();
    auto* scan = dynamic_cast<Scan*>(observed.get());
    if (scan == nullptr || scan->observer != this) {
      throw std::logic_error("pushed a scan that this method did not observe");
    }
    if (scan->number <= last_number_) {
      throw std::logic_error("pushed scans in another order than they were observed in");
    }
    last_number_ = scan->number;
    ++pushed_;
    return enter(*scan);
  }
  std::vector<LabelledScan> push(std::span<const Point> points, const Pose& map_from_sensor,
                                 const RayOrigins& origins = {}) final {
    expect_scan();
    return push(observe_by(points, map_from_sensor, origins, pool_));
  }
  std::vector<LabelledScan> finish() final {
    finished_ = true;
    return release();
  }

 protected:
  /// Throws std::invalid_argument for 0 threads.
  explicit ScanMethod(const RunContext& context)
      : context_(checked(context)), pool_(context.threads) {}

  const RunContext& context() const { return context_; }
  ThreadPool& pool() { return pool_; }
  /// The index of the last scan that entered, or enters.
  std::uint32_t k() const { return static_cast<std::uint32_t>(pushed_ - 1); }

 private:
  /// Does what needs no scan before it, as Method::observe, with the threads of a pool.
  virtual std::unique_ptr<Scan> see(std::span<const Point> points, const Pose& map_from_sensor,
                                    const RayOrigins& origins, ThreadPool& pool) = 0;
  /// Takes the next scan in. Returns scans as Method::push does.
  virtual std::vector<LabelledScan> enter(Scan& scan) = 0;
  /// Returns the scans that are still held.
  virtual std::vector<LabelledScan> release() { return {}; }

  std::unique_ptr<Scan> observe_by(std::span<const Point> points, const Pose& map_from_sensor,
                                   const RayOrigins& origins, ThreadPool& pool) {
    check_rigid(map_from_sensor);
    check_origins(origins, points.size());
    auto scan = see(points, map_from_sensor, origins, pool);
    scan->observer = this;
    scan->number = ++observed_;  // while another thread pushes the scan before
    return scan;
  }
  void expect_scan() const {
    if (finished_) throw std::logic_error("pushed a scan after finish");
    if (context_.scan_count && pushed_ >= *context_.scan_count) {
      throw std::logic_error("pushed more scans than scan_count announced");
    }
  }

  RunContext context_;
  ThreadPool pool_;
  std::optional<ThreadPool> observing_pool_;  // for scans observed during a push
  std::size_t observed_ = 0, pushed_ = 0, last_number_ = 0;
  bool finished_ = false;
};

/// A scan that was checked and copied, nothing else.
struct PosedScan final : NumberedScan {
  std::vector<Point> points;
  Pose map_from_sensor = Pose::Identity();
  RayOrigins origins;
  std::size_t nonfinite_points = 0;
};

/// Base of methods that do all their work on a scan when it is pushed.
class SequentialMethod : public ScanMethod<PosedScan> {
 protected:
  /// Points with a coordinate beyond `reach_m` are refused, and several origins unless it takes
  /// them. Throws std::invalid_argument for 0 threads.
  SequentialMethod(const RunContext& context, double reach_m, bool takes_origins = false)
      : ScanMethod(context), reach_m_(reach_m), takes_origins_(takes_origins) {}

 private:
  /// Takes the next scan in. `result` is that of a scan that is not judged: its index is set, all
  /// points are static and have the score 0. Returns scans as Method::push does.
  virtual std::vector<LabelledScan> take(PosedScan& scan, LabelledScan result) = 0;

  std::unique_ptr<PosedScan> see(std::span<const Point> points, const Pose& map_from_sensor,
                                 const RayOrigins& origins, ThreadPool& pool) final;
  std::vector<LabelledScan> enter(PosedScan& scan) final;

  double reach_m_;
  bool takes_origins_;
};

}  // namespace mosbench
