#include "core/hmm_mos/reference.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <stdexcept>
#include <unordered_map>
#include <unordered_set>

#include "core/base/rigid.hpp"
#include "core/hmm_mos/pipeline.hpp"

namespace mosbench::hmm_mos {
namespace {

struct Voxel {
  int x = 0, y = 0, z = 0;
  bool operator==(const Voxel&) const = default;
};

struct Hash {
  std::size_t operator()(const Voxel& v) const {
    const auto mix = [](int c) { return static_cast<std::size_t>(static_cast<unsigned>(c)); };
    return (mix(v.x) * 73856093U) ^ (mix(v.y) * 19349669U) ^ (mix(v.z) * 83492791U);
  }
};

template <typename Value>
using MapOf = std::unordered_map<Voxel, Value, Hash>;
using SetOf = std::unordered_set<Voxel, Hash>;

enum Occupancy { kUnobserved, kOccupied, kFree };

/// A voxel of the map M.
struct Cell {
  std::array<double, 3> x = {1, 0, 0};  // belief: unobserved, occupied, free
  Occupancy state = kUnobserved;
  int last_change = 0, last_seen = 0;
};

/// A voxel of a scan, in P'_M within the range limit.
struct ScanVoxel {
  int votes = 0, median = 0, sum = 0;
  bool beside_unknown = false, dynamic = false, from_region = false;
};

/// A voxel of the dynamic region.
struct RegionVoxel {
  bool dynamic = false, high_confidence = false, beside_unknown = false;
  int neighbours = 0, last_seen = 0;
};

struct Scan final : Observed {
  std::vector<std::optional<Voxel>> voxel_of_point;
  SetOf measured;             // P'_M
  SetOf observed;             // P'_obs
  MapOf<ScanVoxel> occupied;  // P'_M within the range limit
  Eigen::Vector3d sensor_m = Eigen::Vector3d::Zero();
  LabelledScan result;
};

double squared(double value) { return value * value; }

/// |v Delta - t|^2, from the voxel's lower corner.
double distance_sq_m2(const Voxel& v, double voxel_size_m, const Eigen::Vector3d& t) {
  return squared(v.x * voxel_size_m - t.x()) + squared(v.y * voxel_size_m - t.y()) +
         squared(v.z * voxel_size_m - t.z());
}

template <typename Visit>
void for_neighbours(const Voxel& v, int radius, Visit visit) {
  for (int dx = -radius; dx <= radius; ++dx)
    for (int dy = -radius; dy <= radius; ++dy)
      for (int dz = -radius; dz <= radius; ++dz) visit(Voxel{v.x + dx, v.y + dy, v.z + dz});
}

/// Voxels from s to v on a Bresenham line, both ends included.
std::vector<Voxel> line(const Voxel& s, const Voxel& v) {
  const std::array<int, 3> end = {v.x, v.y, v.z};
  std::array<int, 3> q = {s.x, s.y, s.z}, d{}, g{}, e{};
  for (std::size_t a = 0; a < 3; ++a) d[a] = std::abs(end[a] - q[a]), g[a] = q[a] < end[a] ? 1 : -1;
  const int longest = *std::max_element(d.begin(), d.end());
  e.fill(longest / 2);
  std::vector<Voxel> visited;
  for (int step = 0; step <= longest; ++step) {
    visited.push_back({q[0], q[1], q[2]});
    for (std::size_t a = 0; a < 3; ++a) {
      e[a] -= d[a];
      if (e[a] < 0) e[a] += longest, q[a] += g[a];
    }
  }
  return visited;
}

/// Otsu's threshold over 100 bins: the level that maximises the variance between the two classes,
/// of equals the highest; nothing when no level separates the values.
std::optional<double> otsu(const std::vector<double>& values) {
  if (values.empty()) return std::nullopt;
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const double lo = *low, hi = *high, width = (hi - lo) / 100;
  std::array<double, 100> count{};
  for (const double s : values) {
    const double bin = s - lo < 1e-3 ? 0 : hi - s < 1e-3 ? 99 : std::ceil((s - lo) / width) - 1;
    count[static_cast<std::size_t>(bin)] += 1;
  }
  double moment = 0, weight = 0, sum = 0, best = 0;
  for (int i = 0; i < 100; ++i) moment += i * count[static_cast<std::size_t>(i)];
  const double total = static_cast<double>(values.size());
  std::optional<double> threshold;
  for (int i = 0; i < 100; ++i) {
    if (weight > 0 && total - weight > 0) {
      const double between =
          weight * (total - weight) * squared(sum / weight - (moment - sum) / (total - weight));
      if (between >= best) best = between, threshold = lo + i * (hi - lo) / 100;
    }
    weight += count[static_cast<std::size_t>(i)];
    sum += i * count[static_cast<std::size_t>(i)];
  }
  return threshold;
}

/// P'_M = voxels of P_M = T_{M->S} P_S, and P'_obs = voxels on the rays to them.
std::unique_ptr<Scan> observed_scan(const Config& c, std::span<const Point> points, const Pose& t) {
  auto scan = std::make_unique<Scan>();
  scan->sensor_m = t.translation();
  const auto voxel_at = [&](double x, double y, double z) {
    const auto index = [&](double m) { return static_cast<int>(std::floor(m / c.voxel_size_m)); };
    return Voxel{index(x), index(y), index(z)};
  };
  for (const Point& point : points) {
    scan->voxel_of_point.emplace_back();
    if (!std::isfinite(point.x) || !std::isfinite(point.y) || !std::isfinite(point.z)) {
      ++scan->result.nonfinite_points;
      continue;
    }
    Eigen::Vector3d p;
    for (int row = 0; row < 3; ++row)
      p[row] = ((t(row, 0) * point.x + t(row, 1) * point.y) + t(row, 2) * point.z) + t(row, 3);
    const Eigen::Vector3d ray = p - scan->sensor_m;
    if (squared(ray.x()) + squared(ray.y()) + squared(ray.z()) <= squared(c.min_range_m)) continue;
    scan->measured.insert(scan->voxel_of_point.back().emplace(voxel_at(p.x(), p.y(), p.z())));
  }
  const Voxel s = voxel_at(scan->sensor_m.x(), scan->sensor_m.y(), scan->sensor_m.z());
  for (const Voxel& v : scan->measured) {
    if (distance_sq_m2(v, c.voxel_size_m, scan->sensor_m) <= squared(c.max_range_m))
      scan->occupied[v] = {};
    for (const Voxel& q : line(s, v)) {
      const double range_sq_m2 = squared((s.x - q.x) * c.voxel_size_m) +
                                 squared((s.y - q.y) * c.voxel_size_m) +
                                 squared((s.z - q.z) * c.voxel_size_m);
      if (range_sq_m2 <= squared(c.max_range_m)) scan->observed.insert(q);
    }
  }
  return scan;
}

}  // namespace

struct Reference::State {
  void update_map(const Scan& scan, const SetOf& sources);
  bool known(const Voxel& v) const;
  void vote(Scan& scan) const;
  void take_medians(Scan& scan) const;
  void add_up(Scan& scan);
  void select(Scan& scan);
  void add_from_region(Scan& scan) const;
  void update_region(const Scan& scan);
  void detect(Scan& scan);
  void join_window(MapOf<int> medians);
  std::vector<LabelledScan> release();

  Config c;
  RunContext context;
  bool paper = true;
  int k = -1;
  MapOf<Cell> map;                // M
  std::deque<MapOf<int>> window;  // the last w_l scans
  SetOf carried;                  // moving voxels of the last detection
  MapOf<RegionVoxel> region;
  double region_threshold = 0;
  SetOf previous_measured;
  std::deque<Scan> held;  // the last n + 1 scans
  bool finished = false;
};

/// x_k = eta B A x_{k-1} with B = diag(0, L, 1 - L), L = exp(-d^2 / 2 sigma_o^2), d the distance to
/// the nearest measured voxel (EDF); the state S is the likeliest when its probability exceeds
/// p_min.
void Reference::State::update_map(const Scan& scan, const SetOf& sources) {
  const double epsilon = c.transition_epsilon;
  for (const Voxel& v : scan.observed) {
    double d_sq_voxels = std::numeric_limits<double>::max();
    for (const Voxel& u : sources)
      d_sq_voxels =
          std::min(d_sq_voxels, squared(v.x - u.x) + squared(v.y - u.y) + squared(v.z - u.z));
    const double l = std::exp(-squared(c.voxel_size_m) * d_sq_voxels / (2 * squared(c.sigma_m())));
    Cell& cell = map[v];
    const double occupied =
        l * (epsilon * cell.x[0] + (1 - epsilon) * cell.x[1] + epsilon * cell.x[2]);
    const double free =
        (1 - l) * (epsilon * cell.x[0] + epsilon * cell.x[1] + (1 - epsilon) * cell.x[2]);
    cell.x = {0, occupied / (occupied + free), free / (occupied + free)};
    const Occupancy likely = cell.x[kFree] > cell.x[kOccupied] ? kFree : kOccupied;
    if (cell.x[likely] > c.min_state_probability) {
      if (cell.state != kUnobserved && cell.state != likely) cell.last_change = k;
      cell.state = likely;
    }
    cell.last_seen = k;
  }
  // What was unobserved for w_g scans, or is out of range, leaves M.
  std::erase_if(map, [&](const auto& entry) {
    const int seen = entry.second.last_seen, w_g = c.global_window_scans;
    const bool expired = seen < k - w_g && (paper ? k > w_g : seen > w_g);
    return expired || distance_sq_m2(entry.first, c.voxel_size_m, scan.sensor_m) >
                          squared((paper ? 2.0 : 1.5) * c.max_range_m);
  });
}

bool Reference::State::known(const Voxel& v) const {
  const auto cell = map.find(v);
  return cell != map.end() && cell->second.state != kUnobserved &&
         k - cell->second.last_seen < c.global_window_scans;
}

/// K_m * P'_chg: changed voxels among the m^3 around each, less one for each unknown one, at least
/// 0.
void Reference::State::vote(Scan& scan) const {
  for (auto& [v, voxel] : scan.occupied) {
    for_neighbours(v, (c.kernel_width_voxels - 1) / 2, [&](const Voxel& u) {
      if (!known(u)) {
        --voxel.votes;
        voxel.beside_unknown = true;
      } else if (scan.occupied.contains(u) && map.at(u).last_change >= k - c.delay_scans) {
        ++voxel.votes;
      }
    });
    voxel.votes = std::max(voxel.votes, 0);
  }
}

/// Median of the votes among the 27 around each, of an even count the mean of the middle two.
void Reference::State::take_medians(Scan& scan) const {
  for (auto& [v, voxel] : scan.occupied) {
    std::vector<int> votes;
    for_neighbours(v, 1, [&](const Voxel& u) {
      const auto near = scan.occupied.find(u);
      if (near != scan.occupied.end()) votes.push_back(near->second.votes);
    });
    std::sort(votes.begin(), votes.end());
    const std::size_t n = votes.size();
    voxel.median = n % 2 == 1 ? votes[n / 2] : (votes[n / 2 - 1] + votes[n / 2]) / 2;
  }
}

void Reference::State::join_window(MapOf<int> medians) {
  window.push_back(std::move(medians));
  if (static_cast<int>(window.size()) > c.local_window_scans) window.pop_front();
}

/// L^dyn = sum of the medians over the last w_l scans.
void Reference::State::add_up(Scan& scan) {
  MapOf<int> medians;
  for (const auto& [v, voxel] : scan.occupied) medians[v] = voxel.median;
  join_window(std::move(medians));
  for (auto& [v, voxel] : scan.occupied)
    for (const MapOf<int>& earlier : window)
      if (const auto found = earlier.find(v); found != earlier.end()) voxel.sum += found->second;
}

/// L^dyn > T by Otsu, or moving in the last detection and L^dyn > otsu_min; dilated by one voxel.
void Reference::State::select(Scan& scan) {
  std::vector<double> sums;
  for (const auto& [v, voxel] : scan.occupied) sums.push_back(voxel.sum);
  const std::optional<double> threshold = scan.result.threshold = otsu(sums);
  SetOf dynamic;
  for (const auto& [v, voxel] : scan.occupied)
    if ((threshold && voxel.sum > *threshold) ||
        (carried.contains(v) && voxel.sum > c.min_otsu_score))
      dynamic.insert(v);
  carried.clear();
  for (const Voxel& v : dynamic)
    for_neighbours(v, 1, [&](const Voxel& u) {
      if (scan.occupied.contains(u)) carried.insert(u);
    });
  for (const Voxel& v : carried) scan.occupied[v].dynamic = true;
}

/// Voxels near many of the region's high-confidence ones, by Otsu again, move as well.
void Reference::State::add_from_region(Scan& scan) const {
  MapOf<int> near;
  std::vector<double> positive;
  for (const auto& [v, voxel] : scan.occupied) {
    if (voxel.beside_unknown) continue;
    for_neighbours(v, (c.kernel_width_voxels - 1) / 2, [&, &count = near[v]](const Voxel& u) {
      const auto found = region.find(u);
      if (found != region.end() && found->second.high_confidence) ++count;
    });
    if (near[v] > 0) positive.push_back(near[v]);
  }
  const std::optional<double> threshold = otsu(positive);
  for (const auto& [v, count] : near)
    if (threshold && count > *threshold)
      scan.occupied[v].dynamic = scan.occupied[v].from_region = true;
}

/// The dynamic region keeps moving voxels for w_d scans.
void Reference::State::update_region(const Scan& scan) {
  for (auto& [v, voxel] : region) voxel.high_confidence = false;
  for (const auto& [v, now] : scan.occupied) {
    RegionVoxel& voxel = region[v];
    if (voxel.last_seen == k) continue;
    if (scan.result.threshold.value_or(0) > c.min_otsu_score && !voxel.dynamic) {
      voxel.dynamic = now.dynamic && !now.from_region;
      voxel.last_seen = k;
    }
    voxel.beside_unknown = now.beside_unknown;
  }
  std::vector<double> counts;
  for (auto& [v, voxel] : region) {
    if (!voxel.dynamic) continue;
    voxel.neighbours = 0;
    for_neighbours(v, 1, [&, &count = voxel.neighbours](const Voxel& u) {
      const auto found = region.find(u);
      if (found != region.end() && found->second.dynamic) ++count;
    });
    counts.push_back(voxel.neighbours);
  }
  region_threshold = otsu(counts).value_or(region_threshold);
  for (auto& [v, voxel] : region)
    voxel.high_confidence =
        voxel.dynamic && !voxel.beside_unknown && voxel.neighbours > region_threshold;
  std::erase_if(region, [&](const auto& entry) {
    return distance_sq_m2(entry.first, c.voxel_size_m, scan.sensor_m) >
               squared(2 * c.max_range_m) ||
           (k > c.dynamic_window_scans && entry.second.last_seen < k - c.dynamic_window_scans);
  });
}

void Reference::State::detect(Scan& scan) {
  scan.result.judged = true;
  if (scan.occupied.empty()) return join_window({});
  vote(scan);
  take_medians(scan);
  add_up(scan);
  select(scan);
  if (paper) add_from_region(scan);
  const bool moves = scan.result.threshold.value_or(0) > c.min_otsu_score;
  for (std::size_t i = 0; i < scan.voxel_of_point.size(); ++i) {
    if (!scan.voxel_of_point[i]) continue;
    const auto voxel = scan.occupied.find(*scan.voxel_of_point[i]);
    if (voxel == scan.occupied.end()) continue;
    if (moves && voxel->second.dynamic) scan.result.labels[i] = kMovingLabel;
    if (context.scores) scan.result.scores[i] = static_cast<float>(voxel->second.sum);
  }
  if (paper) update_region(scan);
}

std::vector<LabelledScan> Reference::State::release() {
  std::vector<LabelledScan> results;
  results.push_back(std::move(held.front().result));
  held.pop_front();
  return results;
}

Reference::Reference(const Config& config, const RunContext& context)
    : state_(std::make_unique<State>()) {
  check(config);
  state_->c = config;
  state_->context = context;
  state_->paper = config.variant == Variant::kPaper2024;
}

Reference::~Reference() = default;

std::unique_ptr<Observed> Reference::observe(std::span<const Point> points, const Pose& pose) {
  check_rigid(pose);
  return observed_scan(state_->c, points, pose);
}

std::vector<LabelledScan> Reference::push(std::unique_ptr<Observed> observed) {
  State& s = *state_;
  auto* scan = dynamic_cast<Scan*>(observed.get());
  if (scan == nullptr) throw std::logic_error("pushed a scan that this method did not observe");
  const int n = s.c.delay_scans;
  const bool ends = s.context.scan_count.has_value();
  const int scan_count = ends ? static_cast<int>(*s.context.scan_count) : 0;
  if (s.finished || (ends && s.k + 1 >= scan_count))
    throw std::logic_error("pushed too many scans");
  scan->result.scan_index = static_cast<std::size_t>(++s.k);
  scan->result.labels.assign(scan->voxel_of_point.size(), kStaticLabel);
  if (s.context.scores) scan->result.scores.assign(scan->voxel_of_point.size(), 0);
  SetOf sources = scan->measured;
  if (s.c.distance_field_scans == 2)
    sources.insert(s.previous_measured.begin(), s.previous_measured.end());
  s.update_map(*scan, sources);
  s.previous_measured = scan->measured;
  s.held.push_back(std::move(*scan));
  if (s.k <= s.c.local_window_scans) {
    s.join_window({});
  } else if (n == 0) {
    s.detect(s.held.back());
  } else if (s.k > n) {
    s.detect(s.held.front());
    if (ends && s.k + n > scan_count) s.detect(s.held.back());
  }
  return static_cast<int>(s.held.size()) > n ? s.release() : std::vector<LabelledScan>{};
}

std::vector<LabelledScan> Reference::finish() {
  state_->finished = true;
  std::vector<LabelledScan> results;
  while (!state_->held.empty()) results.push_back(std::move(state_->release().front()));
  return results;
}

std::vector<std::string> Reference::remarks() const {
  return remarks_on_delay(state_->c, state_->context);
}

}  // namespace mosbench::hmm_mos
