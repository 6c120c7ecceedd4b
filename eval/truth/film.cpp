#include "eval/truth/film.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "datasets/formats/label_file.hpp"
#include "datasets/formats/point_range.hpp"

namespace mosbench {
namespace {

constexpr std::size_t kMostFrames = 40, kScansAround = 5, kMostPointsAround = 3000;
constexpr double kLeastHalf_m = 8, kMargin_m = 4;

struct FilmScan {
  std::size_t scan_index;
  std::vector<Eigen::Vector2d> track_m, rest_m;  // in the map
};

FilmScan film_scan(const ResultScans& scans, std::size_t scan_index, std::uint32_t number) {
  const Frame frame = scans.sequence().read(scan_index);
  const auto objects =
      read_labels(object_file(scans.result().folder(), frame.stem), frame.points.size());
  FilmScan film{scan_index, {}, {}};
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const Eigen::Vector3d place_m = frame.map_from_sensor * position_of(frame.points[i]);
    if (!place_m.allFinite()) continue;
    (objects[i] == number ? film.track_m : film.rest_m).push_back(place_m.head<2>());
  }
  return film;
}

/// Adds x and y of the points within the square, at most `most` of them.
nlohmann::ordered_json centimetres(const std::vector<Eigen::Vector2d>& points_m,
                                   const Eigen::Vector2d& middle_m, double half_m,
                                   std::size_t most) {
  std::vector<Eigen::Vector2d> inside_m;
  for (const Eigen::Vector2d& point_m : points_m) {
    const Eigen::Vector2d from_m = point_m - middle_m;
    if (from_m.cwiseAbs().maxCoeff() <= half_m) inside_m.push_back(from_m);
  }
  nlohmann::ordered_json numbers = nlohmann::ordered_json::array();
  const std::size_t step = inside_m.size() / most + 1;
  for (std::size_t i = 0; i < inside_m.size(); i += step) {
    for (const double part_m : inside_m[i]) numbers.push_back(std::lround(100 * part_m));
  }
  return numbers;
}

}  // namespace

nlohmann::ordered_json film_of(const ResultScans& scans, const TruthTrack& track) {
  const std::size_t first = track.first_scan - std::min(track.first_scan, kScansAround);
  const std::size_t last = std::min(track.last_scan + kScansAround, scans.rows().size() - 1);
  const std::size_t step = (last - first) / kMostFrames + 1;
  std::vector<FilmScan> film;
  Eigen::AlignedBox2d way;
  for (std::size_t k = first; k <= last; k += step) {
    film.push_back(film_scan(scans, k, track.number));
    for (const Eigen::Vector2d& point_m : film.back().track_m) way.extend(point_m);
  }
  Eigen::Vector2d middle_m = Eigen::Vector2d::Zero();
  if (!way.isEmpty()) middle_m = way.center();
  const double extent_m = way.isEmpty() ? 0 : way.sizes().maxCoeff();
  const double half_m = std::max(kLeastHalf_m, extent_m / 2 + kMargin_m);
  nlohmann::ordered_json frames = nlohmann::ordered_json::array();
  for (const FilmScan& scan : film) {
    frames.push_back({{"scan", scan.scan_index},
                      {"track", centimetres(scan.track_m, middle_m, half_m, kMostPointsAround)},
                      {"around", centimetres(scan.rest_m, middle_m, half_m, kMostPointsAround)}});
  }
  return {{"half_cm", std::lround(100 * half_m)}, {"frames", std::move(frames)}};
}

}  // namespace mosbench
