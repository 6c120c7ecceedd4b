#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mosbench/method.hpp>
#include <vector>

#include "core/base/scan_method.hpp"
#include "core/tracks/clusters.hpp"
#include "core/tracks/object_tracks.hpp"

namespace mosbench::tracks {

/// A scan that waits for what later ones say of its points.
struct SeenScan final : NumberedScan {
  std::unique_ptr<Observed> proposing;  ///< as the method that proposes observed it
  std::vector<Eigen::Vector3f> points_m;
  Pose map_from_sensor = Pose::Identity();
  RayOrigins origins;
  SightImage image;
  std::vector<StageTime> stages;
};

/// Seconds, counted in the scans of a sequence.
struct ScanPeriod {
  /// The median distance of the stamps; 0.1 s without stamps, or if it is below 2 ms or above 20 s.
  explicit ScanPeriod(const std::vector<std::int64_t>& stamps_ns);

  std::uint32_t scans(double seconds) const;

  double period_s = 0.1;
};

/// How much later than scan k the method that proposes is to label it, seconds.
inline constexpr double kProposalDelay_s = 1;

/// How whole tracks are judged.
struct WholeTracksConfig {
  double window_s = 60;
  double min_range_m = 0, max_range_m = 0;
};

/// Judges whole objects: takes what another method calls moving, looks at each point from scans up
/// to 3 s earlier and later, follows clusters over time, and decides once for each track. A scan is
/// labelled when its tracks have ended, at the latest window_s later: memory is bounded by that.
/// Scores are the share of looks that went through a track's points, 0 elsewhere.
class WholeTracks final : public ScanMethod<SeenScan> {
 public:
  WholeTracks(const WholeTracksConfig& config, std::unique_ptr<Method> proposing,
              const RunContext& context);

  std::optional<MemoryUse> memory() const override;

  /// Scans whose ranges, points or clusters are held, whichever are more.
  std::size_t held_scans() const { return held_.size(); }

 private:
  /// A scan between its push and its labels.
  struct HeldScan {
    SeenScan seen;  ///< without points when it was looked at, without image when no other needs it
    LabelledScan result;  ///< of the method that proposes, without labels
    std::size_t points = 0;
    std::vector<std::uint8_t> proposed;
    std::vector<Cluster> clusters;
    std::vector<std::shared_ptr<Track>> tracks;
  };

  std::unique_ptr<SeenScan> see(std::span<const Point> points, const Pose& map_from_sensor,
                                const RayOrigins& origins, ThreadPool& pool) override;
  std::vector<LabelledScan> enter(SeenScan& scan) override;
  std::vector<LabelledScan> release() override;

  HeldScan& held(std::uint32_t scan) { return held_[scan - first_held_]; }
  void take_proposals(std::vector<LabelledScan> labelled);
  std::vector<Look> looks_at(std::uint32_t scan);
  void look_at_next();
  bool is_due(const HeldScan& front) const;
  std::vector<LabelledScan> release_due(bool all);
  LabelledScan judged(HeldScan& scan);

  WholeTracksConfig config_;
  std::unique_ptr<Method> proposing_;
  ScanPeriod period_;
  std::vector<std::uint32_t> offsets_;  // of the scans that look, increasing
  std::uint32_t window_scans_;
  ObjectTracks tracks_;
  Eigen::Vector3d origin_m_ = Eigen::Vector3d::Zero();  // of the first scan
  std::deque<HeldScan> held_;
  std::uint32_t first_held_ = 0, proposed_ = 0, looked_ = 0;  // scans so far
  std::uint32_t numbered_ = 0;                                // tracks
};

}  // namespace mosbench::tracks
