#include "tests/differential/slow_method.hpp"

#include <algorithm>

namespace mosbench::slow {

Scan Method::voxelize(std::span<const Point> points, const Pose& pose) const {
  Scan scan;
  scan.sensor_m = pose.translation();
  for (const Point& point : points) {
    scan.voxel_of_point.emplace_back();
    if (!std::isfinite(point.x) || !std::isfinite(point.y) || !std::isfinite(point.z)) continue;
    double p[3];
    for (int row = 0; row < 3; ++row)
      p[row] = ((pose(row, 0) * point.x + pose(row, 1) * point.y) + pose(row, 2) * point.z) +
               pose(row, 3);
    const double range_sq_m2 = squared(p[0] - scan.sensor_m.x()) +
                               squared(p[1] - scan.sensor_m.y()) +
                               squared(p[2] - scan.sensor_m.z());
    if (!(range_sq_m2 > squared(config_.min_range_m))) continue;
    const auto index = [&](double c) {
      return static_cast<int>(std::floor(c / config_.voxel_size_m));
    };
    scan.voxel_of_point.back() = Voxel{index(p[0]), index(p[1]), index(p[2])};
    scan.measured.insert(*scan.voxel_of_point.back());
  }
  for (const Voxel& v : scan.measured) {
    if (corner_distance_sq_m2(v, config_.voxel_size_m, scan.sensor_m) <=
        squared(config_.max_range_m))
      scan.occupied[v] = {};
  }
  return scan;
}

VoxelSet Method::raycast(const Scan& scan) const {
  const double size = config_.voxel_size_m;
  const Voxel s{static_cast<int>(std::floor(scan.sensor_m.x() / size)),
                static_cast<int>(std::floor(scan.sensor_m.y() / size)),
                static_cast<int>(std::floor(scan.sensor_m.z() / size))};
  VoxelSet observed;
  for (const Voxel& v : scan.measured) {
    for (const Voxel& q : line(s, v)) {
      const double distance_sq_m2 =
          squared((s.x - q.x) * size) + squared((s.y - q.y) * size) + squared((s.z - q.z) * size);
      if (distance_sq_m2 <= squared(config_.max_range_m)) observed.insert(q);
    }
  }
  return observed;
}

void Method::update_map(const VoxelSet& observed, const std::vector<Voxel>& sources) {
  const double e = config_.transition_epsilon;
  for (const Voxel& v : observed) {
    MapRecord& record = map_[v];
    const double distance_sq_m2 = squared(config_.voxel_size_m) * nearest_sq_voxels(v, sources);
    const double likelihood = std::exp(-distance_sq_m2 / (2 * squared(config_.sigma_m())));
    const double* x = record.belief;
    const double occupied = likelihood * (e * x[0] + (1 - e) * x[1] + e * x[2]);
    const double free = (1 - likelihood) * (e * x[0] + e * x[1] + (1 - e) * x[2]);
    record.belief[0] = 0;
    record.belief[1] = occupied / (occupied + free);
    record.belief[2] = free / (occupied + free);
    const State likely = record.belief[2] > record.belief[1] ? State::kFree : State::kOccupied;
    const double probability = std::max(record.belief[1], record.belief[2]);
    if (probability > config_.min_state_probability) {
      if (record.state != State::kUnobserved && record.state != likely) record.last_change = k_;
      record.state = likely;
    }
    record.last_seen = k_;
  }
}

void Method::evict(const Eigen::Vector3d& sensor_m) {
  const double radius_m = (paper_ ? 2.0 : 1.5) * config_.max_range_m;
  const int w_g = config_.global_window_scans;
  std::erase_if(map_, [&](const auto& entry) {
    const int last_seen = entry.second.last_seen;
    const bool expired = last_seen < k_ - w_g && (paper_ ? k_ > w_g : last_seen > w_g);
    return expired ||
           corner_distance_sq_m2(entry.first, config_.voxel_size_m, sensor_m) > squared(radius_m);
  });
}

bool Method::known(const Voxel& v) const {
  const auto found = map_.find(v);
  return found != map_.end() && found->second.state != State::kUnobserved &&
         k_ - found->second.last_seen < config_.global_window_scans;
}

void Method::score(Scan& scan) const {
  const int radius = (config_.kernel_width_voxels - 1) / 2;
  for (auto& [v, voxel] : scan.occupied) {
    int sum = 0;
    bool beside_unknown = false;
    for_neighbours(v, radius, [&](const Voxel& u) {
      if (!known(u)) {
        sum -= 1;
        beside_unknown = true;
      } else if (scan.occupied.contains(u) && map_.at(u).last_change >= k_ - config_.delay_scans) {
        sum += 1;
      }
    });
    voxel.score = std::max(sum, 0);
    voxel.beside_unknown = beside_unknown;
  }
}

void Method::filter(Scan& scan) const {
  for (auto& [v, voxel] : scan.occupied) {
    std::vector<int> scores;
    for_neighbours(v, 1, [&](const Voxel& u) {
      const auto found = scan.occupied.find(u);
      if (found != scan.occupied.end()) scores.push_back(found->second.score);
    });
    std::sort(scores.begin(), scores.end());
    const std::size_t n = scores.size();
    voxel.filtered = n % 2 == 1 ? scores[n / 2] : (scores[n / 2 - 1] + scores[n / 2]) / 2;
  }
}

void Method::back_end(Scan& scan) const {
  const int radius = (config_.kernel_width_voxels - 1) / 2;
  VoxelMap<int> near_region;
  std::vector<double> positive;
  for (const auto& [v, voxel] : scan.occupied) {
    if (voxel.beside_unknown) continue;
    int count = 0;
    for_neighbours(v, radius, [&](const Voxel& u) {
      const auto found = region_.find(u);
      if (found != region_.end() && found->second.high_confidence) ++count;
    });
    near_region[v] = count;
    if (count > 0) positive.push_back(count);
  }
  const std::optional<double> threshold = otsu(positive);
  if (!threshold) return;
  for (const auto& [v, count] : near_region) {
    if (count > *threshold) {
      scan.occupied[v].is_dynamic = true;
      scan.occupied[v].from_region = true;
    }
  }
}

void Method::update_region(const Scan& scan, double threshold) {
  for (auto& [v, record] : region_) record.high_confidence = false;
  for (const auto& [v, voxel] : scan.occupied) {
    RegionRecord& record = region_[v];
    if (record.last_seen == k_) continue;
    if (threshold > config_.min_otsu_score && !record.is_dynamic) {
      record.is_dynamic = voxel.is_dynamic && !voxel.from_region;
      record.last_seen = k_;
    }
    record.beside_unknown = voxel.beside_unknown;
  }
  std::vector<double> scores;
  for (auto& [v, record] : region_) {
    if (!record.is_dynamic) continue;
    int score = 0;
    for_neighbours(v, 1, [&](const Voxel& u) {
      const auto found = region_.find(u);
      if (found != region_.end() && found->second.is_dynamic) ++score;
    });
    record.score = score;
    scores.push_back(score);
  }
  if (const auto level = otsu(scores)) region_threshold_ = *level;
  for (auto& [v, record] : region_)
    record.high_confidence =
        record.is_dynamic && !record.beside_unknown && record.score > region_threshold_;
  const int w_d = config_.dynamic_window_scans;
  std::erase_if(region_, [&](const auto& entry) {
    return corner_distance_sq_m2(entry.first, config_.voxel_size_m, scan.sensor_m) >
               squared(2 * config_.max_range_m) ||
           (k_ > w_d && entry.second.last_seen < k_ - w_d);
  });
}

std::vector<bool> Method::detect(Scan& scan) {
  std::vector<bool> moving(scan.voxel_of_point.size(), false);
  const auto join_window = [&](VoxelMap<int> scores) {
    window_.push_back(std::move(scores));
    while (static_cast<int>(window_.size()) > config_.local_window_scans) window_.pop_front();
  };
  if (scan.occupied.empty()) {
    join_window({});
    return moving;
  }
  score(scan);
  filter(scan);
  VoxelMap<int> filtered;
  for (const auto& [v, voxel] : scan.occupied) filtered[v] = voxel.filtered;
  join_window(std::move(filtered));

  std::vector<double> sums;
  for (auto& [v, voxel] : scan.occupied) {
    for (const auto& scores : window_)
      if (const auto found = scores.find(v); found != scores.end())
        voxel.window_sum += found->second;
    sums.push_back(voxel.window_sum);
  }
  const std::optional<double> level = otsu(sums);
  const double threshold = level.value_or(0);
  VoxelSet dynamic;
  for (const auto& [v, voxel] : scan.occupied) {
    if (level && voxel.window_sum > threshold) dynamic.insert(v);
    if (carried_.contains(v) && voxel.window_sum > config_.min_otsu_score) dynamic.insert(v);
  }
  carried_.clear();
  for (const Voxel& v : dynamic)
    for_neighbours(v, 1, [&](const Voxel& u) {
      if (scan.occupied.contains(u)) carried_.insert(u);
    });
  for (const Voxel& v : carried_) scan.occupied[v].is_dynamic = true;
  if (paper_) back_end(scan);
  for (std::size_t i = 0; i < moving.size(); ++i) {
    if (!scan.voxel_of_point[i] || threshold <= config_.min_otsu_score) continue;
    const auto found = scan.occupied.find(*scan.voxel_of_point[i]);
    moving[i] = found != scan.occupied.end() && found->second.is_dynamic;
  }
  if (paper_) update_region(scan, threshold);
  return moving;
}

std::vector<bool> Method::detect_as(std::size_t scan_index, Scan& scan) {
  std::vector<bool> moving = detect(scan);
  for (std::size_t i = 0; i < scan.voxel_of_point.size(); ++i) {
    if (!scan.voxel_of_point[i]) continue;
    const auto found = scan.occupied.find(*scan.voxel_of_point[i]);
    if (found != scan.occupied.end()) scores_[scan_index][i] = found->second.window_sum;
  }
  return moving;
}

std::vector<std::vector<bool>> Method::run(const std::vector<std::vector<Point>>& scans,
                                           const std::vector<Pose>& poses) {
  const int n = config_.delay_scans;
  std::vector<std::vector<bool>> labels;
  for (const auto& points : scans) {
    labels.emplace_back(points.size(), false);
    scores_.emplace_back(points.size(), 0);
  }
  std::vector<Scan> voxelized;
  for (k_ = 0; k_ < static_cast<int>(scans.size()); ++k_) {
    const auto k = static_cast<std::size_t>(k_);
    voxelized.push_back(voxelize(scans[k], poses[k]));
    Scan& scan = voxelized.back();
    std::set<Voxel> sources(scan.measured.begin(), scan.measured.end());
    if (k > 0 && config_.distance_field_scans == 2)
      sources.insert(voxelized[k - 1].measured.begin(), voxelized[k - 1].measured.end());
    update_map(raycast(scan), {sources.begin(), sources.end()});
    evict(scan.sensor_m);
    if (k_ <= config_.local_window_scans) {
      window_.emplace_back();
      while (static_cast<int>(window_.size()) > config_.local_window_scans) window_.pop_front();
      continue;
    }
    if (n == 0) {
      labels[k] = detect_as(k, scan);
      continue;
    }
    if (k_ <= n) continue;
    const std::size_t delayed = k - static_cast<std::size_t>(n);
    labels[delayed] = detect_as(delayed, voxelized[delayed]);
    if (k_ > scan_count_ - n) labels[k] = detect_as(k, scan);
  }
  if (n > 0 && !labels.empty()) {
    labels.front().assign(labels.front().size(), false);
    if (const int tail = scan_count_ - n; tail >= 0 && tail < static_cast<int>(labels.size())) {
      std::vector<bool>& held = labels[static_cast<std::size_t>(tail)];
      held.assign(held.size(), false);
    }
  }
  return labels;
}

}  // namespace mosbench::slow
