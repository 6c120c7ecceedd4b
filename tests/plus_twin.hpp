#pragma once

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <memory>
#include <mosbench/method.hpp>
#include <tuple>
#include <vector>

#include "core/methods/hmm_mos/reference_voxels.hpp"
#include "core/methods/hmm_mos_plus/config.hpp"

/// The method of core/methods/hmm_mos_plus as its README reads: single voxels in hash maps,
/// comparisons of all pairs, double precision.
namespace mosbench::plus_twin {
using namespace hmm_mos::reference;
using hmm_mos::reference::Voxel;

/// A voxel of the map.
struct Cell {
  double occupied = 0, free = 0, unobserved = 1;  // belief
  Occupancy state = kUnobserved;
  int last_seen = 0, free_ticks = 0, occupied_ticks = 0, arrived_at = 0, left_at = 0;
  bool arrived = false, sure = false, left = false;
};

struct Scan final : Observed {
  std::vector<std::optional<Voxel>> of_point;
  SetOf measured, observed, occupied, ground, seeds, arrived, open, fresh, settled, aged, standing,
      departed;
  SetOf predicted;
  Eigen::Vector3d sensor_m = Eigen::Vector3d::Zero();
  int periods = 1;  // since the scan before
  int tick = 0;
  LabelledScan result;
};

/// Connected voxels that hold a seed.
struct Component {
  SetOf voxels;  // of one that moves, those near its seeds
  float share = 0;
  bool moves = false;
  int steady_steps = 0;
};

/// A component that passed all tests but that for what stands.
struct Seen {
  SetOf voxels;
  double arrived = 0, settled_beside = 0;
  int tick = 0;
};

/// What moved in a scan before.
struct Object {
  SetOf voxels;
  Eigen::Vector3d centre, velocity = Eigen::Vector3d::Zero();  // voxels, voxels per period
  int steps = 0, steady_steps = 0;
};

class PlusTwin final : public Method {
 public:
  explicit PlusTwin(const hmm_mos_plus::Config& config,
                    const std::vector<std::int64_t>& stamps_ns = {})
      : c_(config), stamps_ns_(stamps_ns) {}

  std::unique_ptr<Observed> observe(std::span<const Point> points, const Pose& t,
                                    const RayOrigins& origins) override {
    auto scan = std::make_unique<Scan>();
    scan->sensor_m = t.translation();
    SeenVoxels seen =
        see(points, t, origins, {c_.map.min_range_m, c_.map.max_range_m}, c_.map.voxel_size_m);
    scan->result.nonfinite_points = seen.nonfinite_points;
    scan->of_point = std::move(seen.of_point);
    scan->measured = std::move(seen.measured);
    scan->occupied = std::move(seen.occupied);
    scan->observed = std::move(seen.observed);
    return scan;
  }

  using Method::push;
  std::vector<LabelledScan> push(std::unique_ptr<Observed> observed) override {
    auto& scan = dynamic_cast<Scan&>(*observed);
    scan.result.scan_index = static_cast<std::size_t>(++k_);
    const int tick_before = tick_;
    tick_ = tick_of_scan(static_cast<std::size_t>(k_));
    ticks_passed_ = tick_ - tick_before;
    scan.tick = tick_;
    scan.periods = periods_before(static_cast<std::size_t>(k_));
    for (const Voxel& v : scan.observed) update(v, scan.measured);
    std::erase_if(map_, [&](const auto& entry) {
      const bool expired = k_ > c_.map.global_window_scans &&
                           entry.second.last_seen < k_ - c_.map.global_window_scans;
      return expired ||
             distance_sq_m2(entry.first, scan.sensor_m) > squared(2 * c_.map.max_range_m);
    });
    for (const Voxel& v : scan.occupied) {
      const Cell* cell = find(map_, v);
      if (cell == nullptr || cell->state != kOccupied) continue;
      if (young(*cell)) scan.arrived.insert(v);
      const auto sees_through = [&](const Voxel& u) {
        const Cell* other = find(map_, u);
        return other != nullptr && other->last_seen == k_ && !scan.occupied.contains(u);
      };
      const bool is_open = sees_through({v.x, v.y, v.z - 1}) || sees_through({v.x, v.y, v.z + 1});
      if (is_open) scan.open.insert(v);
      if (young(*cell) && may_be_seed(v, true)) scan.seeds.insert(v);
      if (young(*cell) && is_within(*cell, c_.fresh_age_s)) scan.fresh.insert(v);
      if (cell->occupied_ticks >= 5) scan.aged.insert(v);
      const bool of_late = cell->arrived && is_within(*cell, c_.object_age_s);
      if (cell->occupied_ticks >= 8 && !of_late) scan.settled.insert(v);
      const int half_age = static_cast<int>(std::lround(c_.object_age_s * 10)) / 2;
      if (cell->occupied_ticks >= 5 && !(cell->arrived && tick_ - cell->arrived_at <= half_age))
        scan.standing.insert(v);
    }
    scan.ground = scan.occupied;
    held_.push_back(std::move(scan));
    return release(static_cast<std::size_t>(c_.map.delay_scans));
  }

  std::vector<LabelledScan> finish() override { return release(0); }

 private:
  /// A step of the hidden Markov model and of the history.
  void update(const Voxel& v, const SetOf& sources) {
    double d_sq = std::numeric_limits<double>::max();
    for (const Voxel& u : sources) d_sq = std::min(d_sq, norm_sq(v.x - u.x, v.y - u.y, v.z - u.z));
    const double e = c_.map.transition_epsilon;
    const double l =
        std::exp(-squared(c_.map.voxel_size_m) * d_sq / (2 * squared(c_.map.sigma_m())));
    Cell& c = map_[v];
    const double occupied = l * (e * c.unobserved + (1 - e) * c.occupied + e * c.free);
    const double free = (1 - l) * (e * c.unobserved + e * c.occupied + (1 - e) * c.free);
    c.unobserved = 0, c.occupied = occupied / (occupied + free), c.free = free / (occupied + free);
    const Occupancy before = c.state;
    if (std::max(c.occupied, c.free) > c_.map.min_state_probability)
      c.state = c.free > c.occupied ? kFree : kOccupied;
    c.last_seen = k_;
    if (c.state == kOccupied && before == kOccupied) c.occupied_ticks += ticks_passed_;
    if (c.state == kFree && before == kFree) c.free_ticks += ticks_passed_;
    if (c.state == kOccupied && before != kOccupied) {
      const bool is_back = c.left && tick_ - c.left_at <= 10;
      c.arrived = before == kFree, c.sure = c.arrived && c.free_ticks >= 3 && !is_back;
      c.arrived_at = tick_, c.free_ticks = 0, c.occupied_ticks = 1, c.left = false;
    }
    if (c.state == kFree && before != kFree) {
      c.arrived = c.sure = false;
      c.occupied_ticks = 0, c.free_ticks = 1;
      c.left = before == kOccupied, c.left_at = tick_;
    }
  }

  /// Tenths of a second, as far as the stamps tell: periods since the first scan, by their median
  /// length, which is 0.1 s when it is near that.
  int tick_of_scan(std::size_t k) const {
    int periods = 0;
    for (std::size_t i = 1; i <= k; ++i) periods += periods_before(i);
    return static_cast<int>(std::floor(periods * (period_s() / 0.1)));
  }

  double median_s() const {
    std::vector<double> apart_s;
    for (std::size_t i = 1; i < stamps_ns_.size(); ++i) apart_s.push_back(seconds_before(i));
    std::ranges::sort(apart_s);
    return apart_s.empty() ? 0.1 : apart_s[apart_s.size() / 2];
  }
  double period_s() const { return median_s() >= 0.08 && median_s() <= 0.125 ? 0.1 : median_s(); }
  double seconds_before(std::size_t k) const {
    return static_cast<double>(stamps_ns_.at(k) - stamps_ns_.at(k - 1)) * 1e-9;
  }
  int periods_before(std::size_t k) const {
    if (stamps_ns_.empty() || k == 0) return 1;
    return static_cast<int>(std::max(1.0, std::round(seconds_before(k) / median_s())));
  }

  bool is_within(const Cell& c, double age_s) const {
    return tick_ - c.arrived_at <= std::lround(age_s * 10);
  }
  bool young(const Cell& c) const { return c.sure && is_within(c, c_.seed_age_s); }

  bool is_known(const Cell* c) const {
    return c != nullptr && c->state != kUnobserved &&
           k_ - c->last_seen < c_.map.global_window_scans;
  }

  /// Apart from settled surfaces and from what an arrival may have come from by noise, in known
  /// space.
  bool may_be_seed(const Voxel& v, bool arrived) const {
    const int firm = count_neighbours(v, 1, [&](const Voxel& u) {
      const Cell* c = find(map_, u);
      if (!is_known(c)) return false;
      if (arrived && c->left && tick_ - c->left_at <= 5) return true;
      if (!arrived && c->state == kOccupied && c->arrived && tick_ - c->arrived_at <= 5)
        return true;
      return c->state == kOccupied && c->occupied_ticks >= 8 && !young(*c);
    });
    const auto known = [&](const Voxel& u) { return is_known(find(map_, u)); };
    const int unknown =
        count_neighbours(v, 2, [&](const Voxel& u) { return !known(u) && !in_gap(u, known); });
    return firm == 0 && unknown <= c_.max_unknown_voxels;
  }

  /// Between known voxels above and below, with so few unknown ones between them.
  bool in_gap(const Voxel& v, const auto& known) const {
    const auto steps_to_known = [&](int dz) {
      int steps = 1;
      while (steps <= c_.max_gap_voxels && !known({v.x, v.y, v.z + dz * steps})) ++steps;
      return steps;
    };
    return steps_to_known(1) + steps_to_known(-1) - 1 <= c_.max_gap_voxels;
  }

  void add_departures(Scan& scan) const {
    for (const Voxel& v : scan.occupied) {
      const Cell* cell = find(map_, v);
      if (!is_known(cell) || cell->state != kFree) continue;
      scan.settled.erase(v);
      scan.aged.erase(v);
      scan.standing.erase(v);
      scan.fresh.insert(v);
      scan.arrived.insert(v);
      if (may_be_seed(v, false) && scan.seeds.insert(v).second) scan.departed.insert(v);
    }
  }

  bool is_low(const Voxel& v, const SetOf& occupied) const {
    return std::all_of(occupied.begin(), occupied.end(), [&](const Voxel& u) {
      return std::abs(u.x - v.x) > c_.ground_radius_voxels ||
             std::abs(u.y - v.y) > c_.ground_radius_voxels || v.z <= u.z + c_.ground_layers_voxels;
    });
  }

  std::vector<Component> components_of(const Scan& scan) const {
    std::vector<Component> found;
    SetOf left = scan.seeds;
    for (const Voxel& v : scan.occupied)
      if (!scan.settled.contains(v) && !is_low(v, scan.ground)) left.insert(v);
    for (const Voxel& seed : scan.seeds) {
      std::vector<Voxel> members;
      if (left.erase(seed) > 0) members.push_back(seed);
      for (std::size_t next = 0; next < members.size(); ++next)
        for_neighbours(Voxel(members[next]), 1, [&](const Voxel& u) {
          if (left.erase(u) > 0) members.push_back(u);
        });
      if (members.empty()) continue;
      const auto is_seed = [&](const Voxel& v) { return scan.seeds.contains(v); };
      const auto is_fresh = [&](const Voxel& v) { return is_seed(v) && scan.fresh.contains(v); };
      const auto seeds = static_cast<double>(std::ranges::count_if(members, is_seed));
      const auto fresh = static_cast<double>(std::ranges::count_if(members, is_fresh));
      const auto is_aged = [&](const Voxel& v) { return scan.aged.contains(v); };
      const auto aged = static_cast<double>(std::ranges::count_if(members, is_aged));
      const auto size = static_cast<double>(members.size());
      const double share = seeds / size;
      const bool moves =
          share >= c_.min_seed_share && fresh >= c_.min_fresh_share * seeds &&
          (seeds >= c_.min_seeds_voxels || (share >= 0.5 && seeds >= c_.min_pure_seeds_voxels)) &&
          (share >= 0.5 || aged <= c_.max_aged_share * size) &&
          has_size_of_object(members, share >= 0.5) && rises_from_ground(members, scan.ground);
      found.push_back({moves ? near_seeds(members, scan) : SetOf(members.begin(), members.end()),
                       static_cast<float>(share), moves});
    }
    return found;
  }

  void judge(Scan& scan) {
    if (c_.map.delay_scans > 0) {
      add_departures(scan);
    } else {
      look_back();
      past_.push_back(scan);
      int since = 0;
      for (const Scan& later : past_) since += later.periods;
      predict(late_, since, scan);
      predict(last_, scan.periods, scan);
    }
    std::vector<Component> components = components_of(scan);
    last_ = followed(components, scan.periods, last_);
    judge_attachments(scan, components);
    SetOf low, objects;
    for (const Voxel& v : scan.occupied)
      if (!scan.settled.contains(v) && is_low(v, scan.ground)) low.insert(v);
    MapOf<float> shares;
    for (const Component& component : components) {
      for (const Voxel& v : component.voxels) shares[v] = component.share;
      if (component.moves) objects.insert(component.voxels.begin(), component.voxels.end());
    }
    SetOf moving = objects;
    for (const Voxel& v : low)
      for_neighbours({v.x, v.y, v.z + 1}, 1, [&](const Voxel& u) {
        const bool is_straight = u.x == v.x && u.y == v.y;
        if (u.z == v.z + 1 && objects.contains(u) && (is_straight || !scan.aged.contains(v)))
          moving.insert(v);
      });
    for (const auto& v : scan.of_point) {
      scan.result.labels.push_back(v && moving.contains(*v) ? kMovingLabel : kStaticLabel);
      const float* share = v ? find(shares, *v) : nullptr;
      scan.result.scores.push_back(share == nullptr ? 0 : *share);
      scan.result.reasons.push_back(!v || !moving.contains(*v)    ? Reason::kNone
                                    : !objects.contains(*v)       ? Reason::kFeet
                                    : scan.departed.contains(*v)  ? Reason::kDeparted
                                    : scan.predicted.contains(*v) ? Reason::kPredicted
                                    : scan.seeds.contains(*v)     ? Reason::kArrived
                                                                  : Reason::kGrown);
    }
  }

  /// What is beside settled voxels and did not arrive is part of what stands. Looks at all that was
  /// near, by boxes, in the last second.
  void judge_attachments(const Scan& scan, std::vector<Component>& components) {
    const int reach = std::min(8, static_cast<int>(0.6 / c_.map.voxel_size_m));
    std::erase_if(seen_, [&](const Seen& seen) { return scan.tick - seen.tick > 10; });
    for (const Component& component : components) {
      if (!component.moves) continue;
      const SetOf& own = component.voxels;
      Seen& seen = seen_.emplace_back(Seen{own, 0, 0, scan.tick});
      for (const Voxel& v : own) seen.arrived += scan.arrived.contains(v) ? 1 : 0;
      for (const Voxel& v : scan.settled) {
        const bool is_beside =
            count_neighbours(v, reach, [&](const Voxel& u) { return own.contains(u); }) > 0;
        if (is_beside && !own.contains(v) && !is_low(v, scan.ground)) ++seen.settled_beside;
      }
    }
    for (Component& component : components) {
      if (!component.moves) continue;
      double voxels = 0, arrived = 0, settled = 0;
      int since = scan.tick;
      SetOf all;
      for (const Seen& seen : seen_) {
        if (gap_between(seen.voxels, component.voxels) > reach) continue;
        since = std::min(since, seen.tick);
        all.insert(seen.voxels.begin(), seen.voxels.end());
        voxels += static_cast<double>(seen.voxels.size());
        arrived += seen.arrived, settled += seen.settled_beside;
      }
      const bool stays =
          scan.tick - since >= 2 && arrived < (settled > 0.05 * voxels ? 0.9 : 0.3) * voxels &&
          left_in_box(all, scan.tick) < 0.1 * static_cast<double>(component.voxels.size());
      const bool is_attached =
          stays || (settled > c_.max_settled_share * voxels && arrived < 0.8 * voxels);
      component.moves =
          component.steady_steps >= 2 ||
          !(is_attached || is_doubtful(scan, component.voxels) || is_flat(scan, component.voxels));
    }
  }

  /// One voxel high, with all that was near, and seen through straight above or below.
  bool is_flat(const Scan& scan, const SetOf& voxels) const {
    const int reach = std::min(8, static_cast<int>(0.6 / c_.map.voxel_size_m));
    double arrived = 0, open = 0;
    for (const Voxel& v : voxels) {
      arrived += scan.arrived.contains(v) ? 1 : 0;
      open += scan.arrived.contains(v) && scan.open.contains(v) ? 1 : 0;
    }
    const auto are_level = [&](const SetOf& others) {
      return std::ranges::all_of(others, [&](const Voxel& v) { return v.z == voxels.begin()->z; });
    };
    return open > 0.2 * arrived && std::ranges::all_of(seen_, [&](const Seen& seen) {
             return are_level(seen.voxels) || gap_between(seen.voxels, voxels) > reach;
           });
  }

  /// How many voxels were left since a second before a tick within the box around others.
  double left_in_box(const SetOf& voxels, int tick) const {
    double count = 0;
    for (const auto& [v, cell] : map_) {
      const bool was_left = is_known(&cell) && cell.state == kFree && cell.left &&
                            tick_ - cell.left_at <= std::min(10 + tick_ - tick, 100);
      if (was_left && gap_between({v}, voxels) <= 0) ++count;
    }
    return count;
  }

  /// New, and came into view, or is small.
  bool is_doubtful(const Scan& scan, const SetOf& voxels) const {
    const int reach = std::min(8, static_cast<int>(0.6 / c_.map.voxel_size_m));
    const auto size = static_cast<double>(voxels.size());
    const auto arrived = static_cast<double>(
        std::ranges::count_if(voxels, [&](const Voxel& v) { return scan.arrived.contains(v); }));
    const bool is_new = std::ranges::none_of(seen_, [&](const Seen& seen) {
      return seen.tick != scan.tick && gap_between(seen.voxels, voxels) <= reach;
    });
    return is_new && scan.tick >= 8 && (arrived < 0.3 * size || size < c_.min_seeds_voxels);
  }

  /// Between the boxes around voxels, along the axis where it is widest.
  static int gap_between(const SetOf& a, const SetOf& b) {
    const auto gap = [](const SetOf& first, const SetOf& second, auto axis) {
      int highest = std::numeric_limits<int>::min(), lowest = std::numeric_limits<int>::max();
      for (const Voxel& v : first) highest = std::max(highest, axis(v));
      for (const Voxel& v : second) lowest = std::min(lowest, axis(v));
      return lowest - highest;
    };
    const auto either = [&](auto axis) { return std::max(gap(a, b, axis), gap(b, a, axis)); };
    return std::max({either([](const Voxel& v) { return v.x; }),
                     either([](const Voxel& v) { return v.y; }),
                     either([](const Voxel& v) { return v.z; })});
  }

  /// What moved two scans ago, as its departures tell by now. Settled voxels do not depart.
  void look_back() {
    if (past_.size() < 2) return;
    Scan then = past_.front();
    past_.pop_front();
    std::erase_if(then.occupied, [&](const Voxel& v) {
      return then.settled.contains(v) && !then.seeds.contains(v);
    });
    then.settled.clear();
    add_departures(then);
    std::vector<Component> components = components_of(then);
    late_ = followed(components, then.periods, late_);
  }

  /// Where objects of a scan `periods` before are by now: moved on by their last step, corrected by
  /// up to two voxels along x and y to where most of them is found, by less than a right angle.
  void predict(const std::vector<Object>& objects, int periods, Scan& scan) const {
    if (periods * period_s() > 1) return;
    for (const Object& object : objects) {
      if (c_.min_track_steps == 0 || object.steps < c_.min_track_steps) continue;
      const auto ahead = [&](int axis) {
        return static_cast<int>(std::lround(object.velocity[axis] * periods));
      };
      if (ahead(0) == 0 && ahead(1) == 0 && ahead(2) == 0) continue;
      const auto found = [&](int dx, int dy) {
        std::vector<Voxel> at;
        for (const Voxel& v : object.voxels)
          at.push_back({v.x + ahead(0) + dx, v.y + ahead(1) + dy, v.z + ahead(2)});
        std::erase_if(at, [&](const Voxel& v) {
          return !scan.occupied.contains(v) || scan.standing.contains(v) || is_low(v, scan.ground);
        });
        return at;
      };
      std::vector<std::tuple<std::size_t, int, int, int>> corrections;  // the best first
      for (int dy = -2; dy <= 2; ++dy)
        for (int dx = -2; dx <= 2; ++dx)
          if ((ahead(0) + dx) * ahead(0) + (ahead(1) + dy) * ahead(1) + ahead(2) * ahead(2) > 0)
            corrections.emplace_back(object.voxels.size() - found(dx, dy).size(), dx * dx + dy * dy,
                                     dy, dx);
      const auto [missed, squared, dy, dx] = *std::ranges::min_element(corrections);
      for (const Voxel& v : found(dx, dy)) {
        scan.fresh.insert(v);
        if (scan.seeds.insert(v).second) scan.predicted.insert(v);
      }
    }
  }

  std::vector<Object> followed(std::vector<Component>& components, int periods,
                               const std::vector<Object>& before) const {
    std::vector<Object> objects;
    for (Component& component : components) {
      if (!component.moves) continue;
      objects.push_back(followed(component.voxels, periods, before));
      component.steady_steps = objects.back().steady_steps;
    }
    return objects;
  }

  /// With its past: that of the object that is nearest to it, within 20 m/s, when moved on.
  Object followed(const SetOf& voxels, int periods, const std::vector<Object>& before) const {
    Object found{voxels, centre_of(voxels)};
    const double limit = 20 * (period_s() * periods) / c_.map.voxel_size_m;
    const auto apart = [&](const Object& object) -> Eigen::Vector3d {
      return found.centre - object.centre - object.velocity * periods;
    };
    const auto rank = [&](const Object& o) {
      return std::tuple(apart(o).squaredNorm(), o.centre.x(), o.centre.y(), o.centre.z(),
                        o.velocity.x(), o.velocity.y(), o.velocity.z(), o.steps);
    };
    const Object* nearest = nullptr;
    for (const Object& object : before)
      if (apart(object).squaredNorm() <= squared(limit) && period_s() * periods <= 1 &&
          (nearest == nullptr || rank(object) < rank(*nearest)))
        nearest = &object;
    if (nearest != nullptr) {
      found.velocity = (found.centre - nearest->centre) / periods;
      found.steps = nearest->steps + 1;
      const double was_sq = nearest->velocity.squaredNorm();
      const double off_sq = (found.velocity - nearest->velocity).squaredNorm();
      if (was_sq >= 0.25 && 4 * off_sq <= was_sq) found.steady_steps = nearest->steady_steps + 1;
    }
    return found;
  }

  /// Rounded down to 1/256 of a voxel.
  static Eigen::Vector3d centre_of(const SetOf& voxels) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Voxel& v : voxels) sum += Eigen::Vector3d(v.x, v.y, v.z);
    return (sum * 256 / static_cast<double>(voxels.size())).array().floor() / 256;
  }

  bool has_size_of_object(const std::vector<Voxel>& members, bool is_pure) const {
    const double max_m =
        is_pure ? std::max(c_.max_extent_m, c_.max_pure_extent_m) : c_.max_extent_m;
    for (const Voxel& a : members)
      for (const Voxel& b : members)
        if ((a.x - b.x) * c_.map.voxel_size_m > max_m ||
            (a.y - b.y) * c_.map.voxel_size_m > max_m ||
            (a.z - b.z) * c_.map.voxel_size_m > c_.max_height_m)
          return false;
    return true;
  }

  bool rises_from_ground(const std::vector<Voxel>& members, const SetOf& occupied) const {
    const int r = static_cast<int>(c_.rise_radius_m / c_.map.voxel_size_m);
    const auto risen = std::ranges::count_if(members, [&](const Voxel& v) {
      return std::any_of(occupied.begin(), occupied.end(), [&](const Voxel& u) {
        return std::abs(u.x - v.x) <= r && std::abs(u.y - v.y) <= r &&
               v.z >= u.z + c_.min_rise_voxels;
      });
    });
    return static_cast<double>(risen) >= 0.25 * static_cast<double>(members.size());
  }

  /// Those that are reached from a seed within max_growth_m, from voxel to voxel.
  SetOf near_seeds(const std::vector<Voxel>& members, const Scan& scan) const {
    SetOf near;
    for (const Voxel& v : members)
      if (scan.seeds.contains(v)) near.insert(v);
    const int steps = static_cast<int>(c_.max_growth_m / c_.map.voxel_size_m);
    for (int step = 0; step < steps; ++step) {
      const SetOf before = near;
      for (const Voxel& v : members)
        for_neighbours(v, 1, [&](const Voxel& u) {
          if (before.contains(u) && !scan.standing.contains(v)) near.insert(v);
        });
      if (near.size() == before.size()) break;
    }
    return near;
  }

  std::vector<LabelledScan> release(std::size_t held) {
    std::vector<LabelledScan> results;
    for (; held_.size() > held; held_.pop_front()) {
      judge(held_.front());
      results.push_back(std::move(held_.front().result));
    }
    return results;
  }

  double distance_sq_m2(const Voxel& v, const Eigen::Vector3d& p) const {
    const double size = c_.map.voxel_size_m;
    return norm_sq(v.x * size - p.x(), v.y * size - p.y(), v.z * size - p.z());
  }

  hmm_mos_plus::Config c_;
  MapOf<Cell> map_;
  std::deque<Scan> held_;
  std::deque<Scan> past_;            // to look back at
  std::vector<Seen> seen_;           // of the last second
  std::vector<Object> last_, late_;  // of the scan before, and of the one looked back at
  std::vector<std::int64_t> stamps_ns_;
  int k_ = -1, tick_ = -1, ticks_passed_ = 1;
};

}  // namespace mosbench::plus_twin
