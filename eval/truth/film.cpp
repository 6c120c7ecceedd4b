#include "eval/truth/film.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace mosbench {
namespace {

constexpr std::size_t kMostFrames = 40, kScansAround = 5, kMostPoints = 3000, kMostOfOther = 600;
constexpr double kLeastHalf_m = 8, kMargin_m = 4;

struct FilmScan {
  std::size_t scan_index;
  std::map<std::uint32_t, std::vector<Eigen::Vector3d>> points_m;  // by track, in the map
};

FilmScan film_scan(const ResultScans& scans, std::span<const MadeTrack> made,
                   std::size_t scan_index) {
  const TruthScan scan = read_truth_scan(scans, made, scan_index);
  FilmScan film{scan_index, {}};
  for (std::size_t i = 0; i < scan.objects.size(); ++i) {
    const Eigen::Vector3d& place_m = scan.positions_m[i];
    if (place_m.allFinite()) film.points_m[scan.objects[i]].push_back(place_m);
  }
  return film;
}

/// Adds the points within the square, at most `most` of them.
nlohmann::ordered_json centimetres(const std::vector<Eigen::Vector3d>& points_m,
                                   const Eigen::Vector3d& middle_m, double half_m,
                                   std::size_t most) {
  std::vector<Eigen::Vector3d> inside_m;
  for (const Eigen::Vector3d& point_m : points_m) {
    const Eigen::Vector3d from_m = point_m - middle_m;
    if (from_m.head<2>().cwiseAbs().maxCoeff() <= half_m) inside_m.push_back(from_m);
  }
  nlohmann::ordered_json numbers = nlohmann::ordered_json::array();
  const std::size_t step = inside_m.size() / most + 1;
  for (std::size_t i = 0; i < inside_m.size(); i += step) {
    for (const double part_m : inside_m[i]) numbers.push_back(std::lround(100 * part_m));
  }
  return numbers;
}

/// Where the track goes, with its height.
Eigen::AlignedBox3d way_of(const std::vector<FilmScan>& film, std::uint32_t number) {
  Eigen::AlignedBox3d way;
  for (const FilmScan& scan : film) {
    const auto points = scan.points_m.find(number);
    if (points == scan.points_m.end()) continue;
    for (const Eigen::Vector3d& point_m : points->second) way.extend(point_m);
  }
  return way.isEmpty() ? Eigen::AlignedBox3d(Eigen::Vector3d::Zero()) : way;
}

}  // namespace

nlohmann::ordered_json film_of(const ResultScans& scans, std::span<const MadeTrack> made,
                               const TruthTrack& track, std::size_t wider) {
  const std::size_t first = track.first_scan - std::min(track.first_scan, kScansAround * wider);
  const std::size_t last =
      std::min(track.last_scan + kScansAround * wider, scans.rows().size() - 1);
  const std::size_t step = (last - first) / kMostFrames + 1;
  std::vector<FilmScan> film;
  for (std::size_t k = first; k <= last; k += step) film.push_back(film_scan(scans, made, k));
  const Eigen::AlignedBox3d way = way_of(film, track.number);
  Eigen::Vector3d middle_m = way.center();
  middle_m.z() = way.min().z();
  const double extent_m = way.sizes().head<2>().maxCoeff();
  const double half_m =
      std::max(kLeastHalf_m, extent_m / 2 + kMargin_m) * static_cast<double>(wider);
  nlohmann::ordered_json frames = nlohmann::ordered_json::array();
  for (FilmScan& scan : film) {
    const auto told = [&](std::uint32_t number) {
      return centimetres(scan.points_m[number], middle_m, half_m, kMostPoints);
    };
    nlohmann::ordered_json& frame = frames.emplace_back();
    frame = {{"scan", scan.scan_index}, {"track", told(track.number)}, {"around", told(0)}};
    frame["others"] = nlohmann::ordered_json::object();
    for (const auto& [number, points_m] : scan.points_m) {
      if (number == 0 || number == track.number) continue;
      auto other = centimetres(points_m, middle_m, half_m, kMostOfOther);
      if (!other.empty()) frame["others"][std::to_string(number)] = std::move(other);
    }
  }
  return {{"middle_m", {middle_m.x(), middle_m.y()}},
          {"half_cm", std::lround(100 * half_m)},
          {"frames", std::move(frames)}};
}

}  // namespace mosbench
