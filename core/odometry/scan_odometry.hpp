#pragma once

#include <cstdint>
#include <memory>
#include <mosbench/odometry.hpp>
#include <optional>
#include <span>
#include <string>

#include "core/base/thread_pool.hpp"
#include "core/odometry/config.hpp"
#include "core/odometry/engine.hpp"
#include "core/odometry/pose_certainty.hpp"
#include "core/odometry/scan_points.hpp"

namespace mosbench::odometry {

/// The time between scans.
class ScanClock {
 public:
  explicit ScanClock(double default_period_s);

  struct Interval {
    std::int64_t period_ns;  ///< usual time between scans
    double periods = 1;      ///< since the scan before; 1 unless scans are missing
    std::string doubt;       ///< what is wrong with the stamp; empty when nothing is
  };
  /// Takes the stamp of the next scan. Intervals up to 2.5 times the usual one are taken as usual.
  Interval tick(std::optional<std::int64_t> stamp_ns);

 private:
  std::optional<std::int64_t> last_ns_;
  std::int64_t period_ns_;
  bool measured_ = false;
};

/// Odometry by any engine: takes points in range, corrects them for the sensor's motion, predicts
/// by constant velocity, registers, and judges the result.
class ScanOdometry : public Odometry {
 public:
  template <typename Config>
  ScanOdometry(const Config& config, unsigned threads)
      : config_(config.scan),
        pool_(threads),
        engine_(make_engine(config, pool_)),
        clock_(config.scan.scan_period_s) {}

  ScanPose push(std::span<const Point> points, const ScanTimes& times) override;
  void leave_out(std::span<const std::uint8_t> moving) override;
  std::size_t map_points() const override { return engine_->map_points(); }
  std::size_t memory_bytes() const override { return engine_->memory_bytes(); }

 private:
  Pose predict(double periods) const;
  void take(const ScanPoints& scan, const ScanTimes& times, const Pose& motion,
            std::int64_t period_ns);
  Alignment align(const ScanPoints& scan, const ScanTimes& times, const Pose& seed,
                  std::int64_t period_ns);
  Alignment align_with_first(const ScanPoints& scan, const ScanTimes& times, const Pose& seed,
                             std::int64_t period_ns);
  void keep_first(const ScanPoints& scan, const ScanTimes& times);
  void enter_last();
  double plausible_jump_m(const ScanClock::Interval& interval) const;
  Certainty certainty_at(const Pose& map_from_sensor) const;
  void doubt_unless_it_comes_back(const Eigen::Vector3d& weakest_shift, ScanPose& pose) const;
  ScanPose judged(const Alignment& alignment, const Pose& seed, double plausible_m) const;

  ScanConfig config_;
  ThreadPool pool_;
  std::unique_ptr<Engine> engine_;
  ScanClock clock_;
  Pose previous_ = Pose::Identity(), last_ = Pose::Identity();
  int poses_ = 0;  // up to 2
  // The last scan as it was aligned, and of how many points. It enters the map when the next one
  // comes, so that its moving points can be left out before.
  ScanPoints last_scan_;
  std::size_t last_points_ = 0;
  bool enters_ = false;
  // Kept until the motion is known that it has to be corrected by.
  ScanPoints first_scan_;
  std::vector<std::int64_t> first_times_ns_;
};

}  // namespace mosbench::odometry
