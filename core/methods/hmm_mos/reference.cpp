#include <deque>
#include <limits>
#include <utility>

#include "core/base/scan_method.hpp"
#include "core/methods/hmm_mos/pipeline.hpp"
#include "core/methods/hmm_mos/reference_voxels.hpp"

namespace mosbench::hmm_mos {
namespace reference {
namespace {

struct Scan final : NumberedScan {
  SeenVoxels seen;
  MapOf<ScanVoxel> occupied;  // P'_M within the range limit
  Eigen::Vector3d sensor_m = Eigen::Vector3d::Zero();
  LabelledScan result;
};

class Reference final : public ScanMethod<Scan> {
 public:
  Reference(const Config& config, const RunContext& context) : ScanMethod(context), c_(config) {}

  std::vector<std::string> remarks() const override { return remarks_on_delay(c_, context()); }

 private:
  std::unique_ptr<Scan> see(std::span<const Point> points, const Pose& t, const RayOrigins& origins,
                            ThreadPool&) override {
    auto scan = std::make_unique<Scan>();
    scan->sensor_m = t.translation();
    scan->seen =
        reference::see(points, t, origins, {c_.min_range_m, c_.max_range_m}, c_.voxel_size_m);
    scan->result.nonfinite_points = scan->seen.nonfinite_points;
    for (const Voxel& v : scan->seen.occupied) scan->occupied[v] = {};
    return scan;
  }

  /// Scan k enters M; scan k - n is judged.
  std::vector<LabelledScan> enter(Scan& scan) override {
    const int n = c_.delay_scans, scan_count = static_cast<int>(context().scan_count.value_or(0));
    scan.result.scan_index = static_cast<std::size_t>(++k_);
    scan.result.labels.assign(scan.seen.of_point.size(), kStaticLabel);
    if (context().scores) scan.result.scores.assign(scan.seen.of_point.size(), 0);
    SetOf sources = std::exchange(previous_measured_, scan.seen.measured);
    if (c_.distance_field_scans == 1) sources.clear();
    sources.insert(scan.seen.measured.begin(), scan.seen.measured.end());
    update_map(scan, sources);
    forget(scan.sensor_m);
    held_.push_back(std::move(scan));
    if (k_ <= c_.local_window_scans) {
      join_window({});
    } else if (n == 0 || k_ > n) {
      detect(held_.front());
      // The last n scans, but for the first of them, are judged online.
      if (n > 0 && context().scan_count && k_ + n > scan_count) detect(held_.back());
    }
    return release(static_cast<std::size_t>(n));
  }

  std::vector<LabelledScan> release() override { return release(0); }

  /// x_k = eta B A x_{k-1} with B = diag(0, L, 1 - L), L = exp(-d^2 / (2 sigma_o^2)), d the
  /// distance to the nearest measured voxel (EDF). S = argmax x where max x > p_min; P'_chg where S
  /// changed.
  void update_map(const Scan& scan, const SetOf& sources) {
    const double e = c_.transition_epsilon;
    for (const Voxel& v : scan.seen.observed) {
      double d_sq = std::numeric_limits<double>::max();  // voxels
      for (const Voxel& u : sources)
        d_sq = std::min(d_sq, norm_sq(v.x - u.x, v.y - u.y, v.z - u.z));
      const double l = std::exp(-squared(c_.voxel_size_m) * d_sq / (2 * squared(c_.sigma_m())));
      Cell& cell = map_[v];
      const double occupied = l * (e * cell.x[0] + (1 - e) * cell.x[1] + e * cell.x[2]);
      const double free = (1 - l) * (e * cell.x[0] + e * cell.x[1] + (1 - e) * cell.x[2]);
      cell.x = {0, occupied / (occupied + free), free / (occupied + free)};
      const Occupancy likely = cell.x[kFree] > cell.x[kOccupied] ? kFree : kOccupied;
      if (cell.x[likely] > c_.min_state_probability) {
        if (cell.state != kUnobserved && cell.state != likely) cell.last_change = k_;
        cell.state = likely;
      }
      cell.last_seen = k_;
    }
  }

  /// Voxels that were unobserved for w_g scans or are out of range leave M.
  void forget(const Eigen::Vector3d& sensor_m) {
    std::erase_if(map_, [&](const auto& entry) {
      const int seen = entry.second.last_seen, w_g = c_.global_window_scans;
      const double d_sq = distance_sq_m2(entry.first, sensor_m);
      return d_sq > squared((paper_ ? 2.0 : 1.5) * c_.max_range_m) ||
             (seen < k_ - w_g && (paper_ ? k_ > w_g : seen > w_g));
    });
  }

  void detect(Scan& scan) {
    scan.result.judged = true;
    if (scan.occupied.empty()) return join_window({});
    vote(scan);
    add_up(scan);
    select(scan);
    if (paper_) add_from_region(scan);
    label(scan);
    if (paper_) update_region(scan);
  }

  /// K_m * P'_chg: changed voxels among the m^3 around each, less one per unknown one, at least 0.
  void vote(Scan& scan) const {
    for (auto& [v, voxel] : scan.occupied) {
      const int unknown = count_neighbours(v, radius_, [&](const Voxel& u) { return !known(u); });
      const int changed = count_neighbours(v, radius_, [&](const Voxel& u) {
        return scan.occupied.contains(u) && known(u) &&
               map_.at(u).last_change >= k_ - c_.delay_scans;
      });
      voxel.votes = std::max(changed - unknown, 0);
      voxel.beside_unknown = unknown > 0;
    }
  }

  /// L^dyn = sum over the last w_l scans of the medians of the votes of the 27 around each.
  void add_up(Scan& scan) {
    MapOf<int> medians;
    for (const auto& [v, voxel] : scan.occupied) {
      std::vector<int> votes;
      for_neighbours(v, 1, [&](const Voxel& u) {
        if (const ScanVoxel* near = find(scan.occupied, u)) votes.push_back(near->votes);
      });
      medians[v] = median(std::move(votes));
    }
    join_window(std::move(medians));
    for (auto& [v, voxel] : scan.occupied)
      for (const MapOf<int>& earlier : window_)
        if (const int* votes = find(earlier, v)) voxel.sum += *votes;
  }

  void join_window(MapOf<int> medians) {
    window_.push_back(std::move(medians));
    if (static_cast<int>(window_.size()) > c_.local_window_scans) window_.pop_front();
  }

  /// L^dyn > T by Otsu, or dynamic in the last detection and L^dyn > otsu_min; then dilation.
  void select(Scan& scan) {
    std::vector<double> sums;
    for (const auto& [v, voxel] : scan.occupied) sums.push_back(voxel.sum);
    const std::optional<double> threshold = scan.result.threshold = otsu(sums);
    SetOf dilated;
    for (const auto& [v, voxel] : scan.occupied) {
      const bool above = threshold && voxel.sum > *threshold;
      if (!above && !(carried_.contains(v) && voxel.sum > c_.min_otsu_score)) continue;
      for_neighbours(v, 1, [&](const Voxel& u) {
        if (scan.occupied.contains(u)) dilated.insert(u);
      });
    }
    for (const Voxel& v : dilated) scan.occupied[v].dynamic = true;
    carried_ = std::move(dilated);
  }

  /// Voxels near many of the region's high-confidence ones, by Otsu again, move as well.
  void add_from_region(Scan& scan) const {
    MapOf<int> near;
    std::vector<double> counts;
    for (const auto& [v, voxel] : scan.occupied) {
      const int count = count_neighbours(v, radius_, [&](const Voxel& u) {
        return has(region_, u, &RegionVoxel::high_confidence);
      });
      if (count > 0 && !voxel.beside_unknown) near[v] = count, counts.push_back(count);
    }
    const std::optional<double> threshold = otsu(counts);
    for (const auto& [v, count] : near)
      if (threshold && count > *threshold)
        scan.occupied[v].dynamic = scan.occupied[v].from_region = true;
  }

  /// Points take the label of their voxel; a scan has moving points where T > otsu_min.
  void label(Scan& scan) const {
    for (std::size_t i = 0; i < scan.seen.of_point.size(); ++i) {
      const std::optional<Voxel>& v = scan.seen.of_point[i];
      const ScanVoxel* voxel = v ? find(scan.occupied, *v) : nullptr;
      if (voxel == nullptr) continue;
      if (moves(scan) && voxel->dynamic) scan.result.labels[i] = kMovingLabel;
      if (context().scores) scan.result.scores[i] = static_cast<float>(voxel->sum);
    }
  }

  /// The dynamic region keeps dynamic voxels for w_d scans.
  void update_region(const Scan& scan) {
    for (const auto& [v, now] : scan.occupied) {
      RegionVoxel& voxel = region_[v];
      if (voxel.last_seen == k_) continue;
      if (moves(scan) && !voxel.dynamic) {
        voxel.dynamic = now.dynamic && !now.from_region;
        voxel.last_seen = k_;
      }
      voxel.beside_unknown = now.beside_unknown;
    }
    std::vector<double> counts;
    for (auto& [v, voxel] : region_) {
      if (!voxel.dynamic) continue;
      voxel.neighbours = count_neighbours(
          v, 1, [&](const Voxel& u) { return has(region_, u, &RegionVoxel::dynamic); });
      counts.push_back(voxel.neighbours);
    }
    region_threshold_ = otsu(counts).value_or(region_threshold_);
    for (auto& [v, voxel] : region_)
      voxel.high_confidence =
          voxel.dynamic && !voxel.beside_unknown && voxel.neighbours > region_threshold_;
    std::erase_if(region_, [&, w_d = c_.dynamic_window_scans](const auto& entry) {
      return distance_sq_m2(entry.first, scan.sensor_m) > squared(2 * c_.max_range_m) ||
             (k_ > w_d && entry.second.last_seen < k_ - w_d);
    });
  }

  std::vector<LabelledScan> release(std::size_t kept) {
    std::vector<LabelledScan> done;
    for (; held_.size() > kept; held_.pop_front()) done.push_back(std::move(held_.front().result));
    return done;
  }
  /// |v Delta - t|^2, from the voxel's lower corner.
  double distance_sq_m2(const Voxel& v, const Eigen::Vector3d& t) const {
    const double size_m = c_.voxel_size_m;
    return norm_sq(v.x * size_m - t.x(), v.y * size_m - t.y(), v.z * size_m - t.z());
  }
  bool known(const Voxel& v) const {
    const Cell* cell = find(map_, v);
    return cell && cell->state != kUnobserved && k_ - cell->last_seen < c_.global_window_scans;
  }
  bool moves(const Scan& s) const { return s.result.threshold.value_or(0) > c_.min_otsu_score; }

  const Config c_;
  const bool paper_ = c_.variant == Variant::kPaper2024;
  const int radius_ = (c_.kernel_width_voxels - 1) / 2;
  int k_ = -1;                     // the current scan
  MapOf<Cell> map_;                // M
  SetOf previous_measured_;        // P'_M of scan k - 1
  std::deque<MapOf<int>> window_;  // of the last w_l scans
  SetOf carried_;                  // dynamic voxels of the last detection
  MapOf<RegionVoxel> region_;      // dynamic voxels of the last w_d scans
  double region_threshold_ = 0;
  std::deque<Scan> held_;  // the last n + 1 scans
};

}  // namespace
}  // namespace reference

std::unique_ptr<Method> make_reference(const Config& config, const RunContext& context) {
  check(config);
  return std::make_unique<reference::Reference>(config, context);
}

}  // namespace mosbench::hmm_mos
