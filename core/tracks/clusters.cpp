#include "core/tracks/clusters.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/base/median.hpp"
#include "core/tracks/low_points.hpp"

namespace mosbench::tracks {
namespace {

constexpr int kJoinCells = 2, kRimCells = 3;
constexpr std::size_t kLeastOwn = 8;
constexpr float kBeyond_m = 0.3F;  // so much above or below its cluster, few looks suffice

/// What a point is before clusters are known.
enum class Part : std::uint8_t { kOutside, kRest, kProposed, kOwn };

/// The points of a scan with what is known of them.
struct Points {
  std::vector<Part> parts;
  std::vector<Evidence> evidence;  // of those proposed or of its own
  std::vector<std::uint8_t> is_low;
};

bool stands(const Evidence& evidence) { return evidence.through() == 0 && evidence.hit() >= 3; }

bool is_seen_through(const Evidence& evidence) {
  const int judged = evidence.through() + evidence.hit();
  return judged >= 4 && 10 * evidence.through() >= 9 * judged;
}

/// Every third of the looks, to leave out quickly what stands.
std::vector<Look> some_of(std::span<const Look> looks) {
  std::vector<Look> some;
  for (std::size_t i = 1; i < looks.size(); i += 3) some.push_back(looks[i]);
  return some;
}

/// Says whether some looks leave open that a point is_seen_through: a second hit does not.
bool may_be_seen_through(const Eigen::Vector3f& point, std::span<const Look> some) {
  int through = 0, hit = 0;
  for (const Look& look : some) {
    const Sight sight = look.at(point);
    through += sight == Sight::kThrough ? 1 : 0;
    hit += sight == Sight::kHit ? 1 : 0;
    if (hit == 2) return false;
  }
  return through > 0;
}

Part part_of(const Eigen::Vector3f& point, bool proposed, std::span<const Look> looks,
             std::span<const Look> some, Evidence& evidence) {
  if (!proposed && !may_be_seen_through(point, some)) return Part::kRest;
  evidence = evidence_of(point, looks);
  if (proposed ? stands(evidence) : !is_seen_through(evidence)) return Part::kRest;
  if (is_carrier(point, looks)) return Part::kRest;
  return proposed ? Part::kProposed : Part::kOwn;
}

std::vector<std::uint8_t> in_range(const LookedScan& scan) {
  const auto least = static_cast<float>(scan.min_range_m);
  const auto most = static_cast<float>(scan.max_range_m);
  std::vector<std::uint8_t> inside;
  inside.reserve(scan.points_m.size());
  for (std::size_t i = 0; i < scan.points_m.size(); ++i) {
    const float range = (scan.points_m[i] - scan.origins.at(i).cast<float>()).norm();
    inside.push_back(range > least && range <= most ? 1 : 0);  // NaN is not
  }
  return inside;
}

Points look_at(const LookedScan& scan, std::span<const Look> looks, ThreadPool& pool) {
  const std::size_t count = scan.points_m.size();
  Points points{std::vector<Part>(count), std::vector<Evidence>(count), {}};
  const std::vector<Look> some = some_of(looks);
  const std::vector<std::uint8_t> inside = in_range(scan);
  points.is_low = low_points(scan.positions_m, inside);
  pool.for_ranges(count, 1024, [&](std::size_t begin, std::size_t end, unsigned) {
    for (std::size_t i = begin; i < end; ++i) {
      if (inside[i] == 0) continue;
      const bool proposed = scan.proposed[i] != 0;
      points.parts[i] = Part::kRest;
      if (!proposed && points.is_low[i] != 0) continue;
      points.parts[i] = part_of(scan.points_m[i], proposed, looks, some, points.evidence[i]);
    }
  });
  return points;
}

/// The cells of points that make clusters, joined; clusters are numbered by their first point.
class JoinedCells {
 public:
  JoinedCells(const LookedScan& scan, const Points& points) {
    for (std::uint32_t i = 0; i < scan.points_m.size(); ++i) {
      if (points.parts[i] < Part::kProposed) continue;
      const Cell cell = cell_of(scan.positions_m[i], kCell_m);
      if (members_[cell].empty()) cells_.push_back(cell);
      members_[cell].push_back(i);
    }
  }

  std::vector<Cluster> clusters() {
    std::vector<Cluster> found;
    CellMap<bool> taken;
    for (const Cell& first : cells_) {
      if (!taken.try_emplace(first, true).second) continue;
      Cluster& cluster = found.emplace_back();
      cluster.cells = {first};
      for (std::size_t next = 0; next < cluster.cells.size(); ++next) {
        const std::vector<std::uint32_t>& members = members_.at(cluster.cells[next]);
        cluster.points.insert(cluster.points.end(), members.begin(), members.end());
        for_cells_around(cluster.cells[next], kJoinCells, [&](const Cell& cell) {
          if (members_.contains(cell) && taken.try_emplace(cell, true).second) {
            cluster.cells.push_back(cell);
          }
        });
      }
      std::ranges::sort(cluster.points);
    }
    return found;
  }

 private:
  std::vector<Cell> cells_;
  CellMap<std::vector<std::uint32_t>> members_;
};

Seen seen_of(const Evidence& e) {
  const auto one_if = [](bool is) { return is ? 1U : 0U; };
  return {.points = 1,
          .through_before = one_if(e.through_before >= 2),
          .judged_before = one_if(e.through_before + e.hit_before > 0),
          .through_after = one_if(e.through_after >= 2),
          .judged_after = one_if(e.through_after + e.hit_after > 0),
          .looks_through = static_cast<std::uint32_t>(e.through()),
          .looks = static_cast<std::uint32_t>(e.through() + e.hit())};
}

Reason reason_of(const Evidence& evidence) {
  if (evidence.through_before > 0) return Reason::kArrived;
  return evidence.through_after > 0 ? Reason::kDeparted : Reason::kGrown;
}

void measure(const LookedScan& scan, const Points& points, Cluster& cluster) {
  std::vector<double> x, y;
  for (const std::uint32_t i : cluster.points) {
    cluster.seen += seen_of(points.evidence[i]);
    cluster.reasons.push_back(reason_of(points.evidence[i]));
    x.push_back(scan.positions_m[i].x());
    y.push_back(scan.positions_m[i].y());
  }
  cluster.median_m = {static_cast<float>(upper_median(std::move(x))),
                      static_cast<float>(upper_median(std::move(y)))};
}

/// Completes clusters with the points around them.
class Completion {
 public:
  Completion(const LookedScan& scan, const Points& points, std::vector<Cluster>& clusters)
      : clusters_(clusters) {
    for (std::uint32_t c = 0; c < clusters.size(); ++c) {
      Height& height = heights_.emplace_back();
      for (const std::uint32_t i : clusters[c].points) {
        height.low_m = std::min(height.low_m, scan.positions_m[i].z());
        height.high_m = std::max(height.high_m, scan.positions_m[i].z());
      }
    }
    mark_rim();
    for (std::uint32_t i = 0; i < points.parts.size(); ++i) {
      if (points.parts[i] != Part::kRest) continue;
      if (points.is_low[i] != 0 && scan.proposed[i] == 0) continue;
      const Cell cell = cell_of(scan.positions_m[i], kCell_m);
      const auto found = rim_.find(cell);
      if (found != rim_.end()) wanted_.push_back({i, found->second});
    }
  }

  void add(const LookedScan& scan, std::span<const Look> looks, ThreadPool& pool) {
    std::vector<Evidence> evidence(wanted_.size());
    pool.for_ranges(wanted_.size(), 256, [&](std::size_t begin, std::size_t end, unsigned) {
      for (std::size_t i = begin; i < end; ++i) {
        evidence[i] = evidence_of(scan.points_m[wanted_[i].point], looks);
      }
    });
    for (std::size_t i = 0; i < wanted_.size(); ++i) {
      const Wanted& wanted = wanted_[i];
      if (scan.proposed[wanted.point] == 0 &&
          !belongs(wanted, evidence[i], scan.positions_m[wanted.point].z())) {
        continue;
      }
      clusters_[wanted.cluster].points.push_back(wanted.point);
      clusters_[wanted.cluster].reasons.push_back(Reason::kGrown);
    }
  }

 private:
  struct Height {
    float low_m = std::numeric_limits<float>::infinity();
    float high_m = -std::numeric_limits<float>::infinity();
  };
  struct Wanted {
    std::uint32_t point, cluster;
  };

  void mark_rim() {
    for (std::uint32_t c = 0; c < clusters_.size(); ++c) {
      for (const Cell& own : clusters_[c].cells) {
        for_cells_around(own, kRimCells, [&](const Cell& cell) { rim_.try_emplace(cell, c); });
      }
    }
  }

  bool belongs(const Wanted& wanted, const Evidence& evidence, float z_m) const {
    const int judged = evidence.through() + evidence.hit();
    if (judged == 0) return false;
    if (2 * evidence.through() >= judged) return true;
    const Height& height = heights_[wanted.cluster];
    return 10 * evidence.through() >= judged && z_m >= height.low_m - kBeyond_m &&
           z_m <= height.high_m + kBeyond_m;
  }

  std::vector<Cluster>& clusters_;
  std::vector<Height> heights_;
  CellMap<std::uint32_t> rim_;
  std::vector<Wanted> wanted_;
};

}  // namespace

Seen& Seen::operator+=(const Seen& other) {
  points += other.points;
  through_before += other.through_before;
  judged_before += other.judged_before;
  through_after += other.through_after;
  judged_after += other.judged_after;
  looks_through += other.looks_through;
  looks += other.looks;
  return *this;
}

std::vector<Cluster> find_clusters(const LookedScan& scan, std::span<const Look> looks,
                                   ThreadPool& pool) {
  const Points points = look_at(scan, looks, pool);
  std::vector<Cluster> clusters = JoinedCells(scan, points).clusters();
  std::erase_if(clusters, [&](const Cluster& cluster) {
    return cluster.points.size() < kLeastOwn &&
           std::ranges::all_of(cluster.points,
                               [&](std::uint32_t i) { return points.parts[i] == Part::kOwn; });
  });
  for (Cluster& cluster : clusters) measure(scan, points, cluster);
  if (!clusters.empty()) Completion(scan, points, clusters).add(scan, looks, pool);
  return clusters;
}

}  // namespace mosbench::tracks
