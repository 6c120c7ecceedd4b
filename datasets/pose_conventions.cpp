#include "datasets/pose_conventions.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "datasets/calib_file.hpp"
#include "datasets/surface_cells.hpp"

namespace mosbench {
namespace {

constexpr std::size_t kPairs = 6;
constexpr std::size_t kSpreadPairs = 8;
constexpr std::size_t kReferencePoints = 40000;
constexpr std::size_t kMovedPoints = 1500;
constexpr std::size_t kFewestPoints = 200;

/// Two scans, `later` being some scans behind `earlier`.
struct ScanPair {
  std::size_t earlier = 0, later = 0;
};

Pose relative(const std::vector<Pose>& poses, const ScanPair& pair) {
  return poses[pair.earlier].inverse() * poses[pair.later];
}

/// How far the two motions put a point at 10 m from one another, about.
double difference_m(const Pose& a, const Pose& b) {
  constexpr double kRangeM = 10.0;
  const Pose between = a.inverse() * b;
  return between.translation().norm() + kRangeM * Eigen::AngleAxisd(between.linear()).angle();
}

Pose swapped_xy(const Pose& pose) {
  Eigen::Matrix4d swap = Eigen::Matrix4d::Zero();
  swap(0, 1) = swap(1, 0) = swap(2, 2) = swap(3, 3) = 1.0;
  Pose result;
  result.matrix() = swap * pose.matrix() * swap;
  return result;
}

template <typename Change>
PoseConvention changed(const char* name, const char* remedy, const std::vector<Pose>& poses,
                       Change&& change) {
  PoseConvention convention{name, remedy, {}};
  for (std::size_t i = 0; i < poses.size(); ++i) {
    convention.map_from_sensor.push_back(change(i));
  }
  return convention;
}

/// Scans read once and kept in the two forms that measuring needs.
class ScanPoints {
 public:
  explicit ScanPoints(const Sequence& sequence) : sequence_(sequence) {}

  struct Scan {
    std::vector<Eigen::Vector3d> moved_m;
    SurfaceCells cells;
  };
  const Scan& at(std::size_t scan_index) {
    auto& scan = scans_[scan_index];
    if (!scan) {
      const std::vector<Point> points = sequence_.read(scan_index).points;
      scan = std::make_unique<Scan>(Scan{near_points(points, kMovedPoints),
                                         SurfaceCells(near_points(points, kReferencePoints))});
    }
    return *scan;
  }
  std::size_t size() const { return scans_.size(); }

 private:
  const Sequence& sequence_;
  std::map<std::size_t, std::unique_ptr<Scan>> scans_;
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// Scans this far apart are some metres from one another, but not too far to overlap.
std::size_t stride_of(const std::vector<Pose>& given) {
  constexpr double kFarM = 2.0;
  std::size_t stride = 1;
  for (const std::size_t candidate : {2U, 4U, 8U}) {
    if (candidate * 2 >= given.size()) break;
    std::vector<double> steps_m;
    for (std::size_t i = 0; i + candidate < given.size(); ++i) {
      steps_m.push_back(relative(given, {i, i + candidate}).translation().norm());
    }
    if (median(steps_m) > kFarM) break;
    stride = candidate;
  }
  return stride;
}

class Measuring {
 public:
  Measuring(const Sequence& sequence, const std::vector<Pose>& given)
      : given_(given), points_(sequence), stride_(stride_of(given)) {}

  std::optional<PoseMeasurement> run(const std::vector<PoseConvention>& conventions) {
    if (!measure_given()) return std::nullopt;
    for (std::size_t i = 0; i < conventions.size(); ++i) measure(i, conventions[i]);
    result_.scans_read = points_.size();
    return result_;
  }

 private:
  double overlap(const ScanPair& pair, const Pose& motion) {
    return points_.at(pair.earlier).cells.overlap(points_.at(pair.later).moved_m, motion);
  }

  bool measure_given() {
    std::vector<double> given, best, corrections_m;
    const std::size_t last = given_.size() - stride_;
    for (std::size_t i = 0; i < std::min(kSpreadPairs, last); ++i) {
      const std::size_t earlier = i * last / std::min(kSpreadPairs, last);
      const ScanPair pair{earlier, earlier + stride_};
      if (points_.at(pair.later).moved_m.size() < kFewestPoints) continue;
      const auto& cells = points_.at(pair.earlier).cells;
      const Pose motion = relative(given_, pair);
      const Alignment from_given = align(cells, points_.at(pair.later).moved_m, motion);
      const Alignment from_rest = align(cells, points_.at(pair.later).moved_m, Pose::Identity());
      const Alignment& aligned = from_rest.overlap > from_given.overlap ? from_rest : from_given;
      given.push_back(overlap(pair, motion));
      best.push_back(aligned.overlap);
      corrections_m.push_back(difference_m(motion, aligned.cells_from_points));
    }
    if (given.size() < 2) return false;
    result_.given_overlap = median(given);
    result_.best_overlap = median(best);
    result_.median_correction_m = median(corrections_m);
    return true;
  }

  /// The pairs where the convention differs most from the given poses, apart from one another.
  std::vector<ScanPair> telling_pairs(const PoseConvention& convention) const {
    constexpr double kTellingM = 0.02;
    std::vector<std::pair<double, std::size_t>> differences;
    for (std::size_t i = 0; i + stride_ < given_.size(); ++i) {
      const ScanPair pair{i, i + stride_};
      const Pose theirs = relative(convention.map_from_sensor, pair);
      const double apart_m =
          difference_m(relative(given_, pair), convention.swaps_xy ? swapped_xy(theirs) : theirs);
      if (apart_m > kTellingM) differences.emplace_back(apart_m, i);
    }
    std::ranges::sort(differences, std::ranges::greater());
    std::vector<ScanPair> pairs;
    for (const auto& [unused, i] : differences) {
      const bool near = std::ranges::any_of(pairs, [&, i = i](const ScanPair& pair) {
        return std::max(pair.earlier, i) - std::min(pair.earlier, i) < stride_;
      });
      if (!near) pairs.push_back({i, i + stride_});
      if (pairs.size() == kPairs) break;
    }
    return pairs;
  }

  void measure(std::size_t index, const PoseConvention& convention) {
    ConventionScore score{.convention = index};
    for (const ScanPair& pair : telling_pairs(convention)) {
      if (points_.at(pair.later).moved_m.size() < kFewestPoints) continue;
      const Pose theirs = relative(convention.map_from_sensor, pair);
      const double given = overlap(pair, relative(given_, pair));
      const double other = overlap(pair, convention.swaps_xy ? swapped_xy(theirs) : theirs);
      ++score.pairs;
      score.given_overlap += given;
      score.overlap += other;
      if (other > given) ++score.pairs_better;
    }
    if (score.pairs == 0) return;
    score.given_overlap /= static_cast<double>(score.pairs);
    score.overlap /= static_cast<double>(score.pairs);
    result_.scores.push_back(score);
  }

  const std::vector<Pose>& given_;
  ScanPoints points_;
  std::size_t stride_;
  PoseMeasurement result_;
};

}  // namespace

bool ConventionScore::beats_given() const {
  constexpr double kGain = 0.015;
  return pairs >= 3 && 6 * pairs_better >= 5 * pairs && overlap > given_overlap + kGain;
}

bool PoseMeasurement::is_full(double overlap) const {
  // Sparse scans can be laid over one another a little better than they were taken.
  constexpr double kLossShare = 0.25;
  return overlap > (1.0 - kLossShare) * best_overlap;
}

bool PoseMeasurement::given_fits() const {
  constexpr double kCorrectionM = 0.3;
  return is_full(given_overlap) || median_correction_m < kCorrectionM;
}

std::vector<PoseConvention> other_conventions(const std::vector<Pose>& given,
                                              const std::optional<Pose>& camera_from_lidar,
                                              bool applied) {
  Pose looks_ahead = Pose::Identity();
  looks_ahead.linear() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  const Pose tr = camera_from_lidar.value_or(looks_ahead);
  const std::size_t last = given.size() - 1;
  const auto stored = [&](std::size_t i) {
    return applied ? tr * given[i] * tr.inverse() : given[i];
  };
  const auto as_read = [&](const Pose& pose) { return applied ? lidar_pose(pose, tr) : pose; };
  std::vector<PoseConvention> conventions;
  if (applied) {
    conventions.push_back(
        changed("the lidar's, Tr not to be applied", "run with --pose-frame lidar", given, stored));
  } else {
    conventions.push_back(changed(
        camera_from_lidar ? "the camera's, Tr to be applied" : "the camera's, Tr is missing",
        camera_from_lidar ? "run with --pose-frame camera"
                          : "put the data set's calib.txt with its Tr beside the poses",
        given, [&](std::size_t i) { return lidar_pose(given[i], tr); }));
  }
  conventions.push_back(changed("sensor_from_map (inverse)",
                                "run with --pose-direction sensor-from-map", given,
                                [&](std::size_t i) { return given[i].inverse(); }));
  conventions.push_back(changed("with transposed rotations", "write each row's rotation row by row",
                                given, [&](std::size_t i) {
                                  Pose pose = stored(i);
                                  pose.linear().transposeInPlace();
                                  return as_read(pose);
                                }));
  conventions.push_back(changed("one row later", "remove the first row and add one at the end",
                                given,
                                [&](std::size_t i) { return given[std::min(i + 1, last)]; }));
  conventions.push_back(changed("one row earlier", "remove the last row and add one in front",
                                given, [&](std::size_t i) { return given[i > 0 ? i - 1 : 0]; }));
  conventions.push_back(changed("right, but x and y of the points are swapped",
                                "export the scans anew with x before y", given,
                                [&](std::size_t i) { return given[i]; }));
  conventions.back().swaps_xy = true;
  return conventions;
}

std::optional<PoseMeasurement> measure_poses(const Sequence& sequence,
                                             const std::vector<Pose>& given,
                                             const std::vector<PoseConvention>& conventions) {
  constexpr std::size_t kFewestScans = 6;
  if (given.size() < kFewestScans) return std::nullopt;
  return Measuring(sequence, given).run(conventions);
}

}  // namespace mosbench
