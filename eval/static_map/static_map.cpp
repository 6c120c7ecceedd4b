#include "eval/static_map/static_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <system_error>
#include <utility>
#include <vector>

#include "datasets/disk/files.hpp"
#include "datasets/formats/point_range.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/result/tell.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

/// Of the place of a voxel: along each axis the low bits are in the tile, the others are the tile.
constexpr int kTileBits = 9;
constexpr std::int64_t kTileVoxels = std::int64_t{1} << kTileBits;

/// The largest error of a position in float32, as a share of the voxels.
constexpr double kMostRounding = 0.1;

static_assert(std::endian::native == std::endian::little);

template <typename Value>
void append(std::string& bytes, const Value& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

/// Hands over the bytes of the points, some at a time.
template <typename Coordinate>
void format_points(const StaticMap& map, const ByteSink& sink) {
  constexpr std::size_t kPart = 1U << 20;
  std::string bytes;
  map.for_each([&](const MapPoint& point) {
    for (const double x_m : point.position_map_m) append(bytes, static_cast<Coordinate>(x_m));
    append(bytes, point.intensity);
    if (bytes.size() < kPart) return;
    sink(bytes);
    bytes.clear();
  });
  sink(bytes);
}

}  // namespace

bool is_labelled_moving(PointOutcome outcome) {
  return outcome == PointOutcome::kTruePositive || outcome == PointOutcome::kFalsePositive ||
         outcome == PointOutcome::kIgnoredMoving;
}

StaticMap::StaticMap(const StaticMapConfig& config, fs::path spill_folder)
    : config_(config), spill_folder_(std::move(spill_folder)) {}

StaticMap::~StaticMap() {
  std::error_code nobody_asks;
  if (!spilled_.empty()) fs::remove_all(spill_folder_, nobody_asks);
}

double StaticMap::side_m() const { return static_cast<double>(kTileVoxels) * config_.voxel_m; }

fs::path StaticMap::file_of(const Place& place) const {
  return spill_folder_ / fmt::format("{}_{}_{}", place[0], place[1], place[2]);
}

StaticMap::Tile StaticMap::read_tile(const Place& place) const {
  const std::string bytes = read_file(file_of(place));
  Tile tile;
  constexpr std::size_t kEntry = sizeof(std::uint32_t) + sizeof(Voxel);
  for (std::size_t at = 0; at + kEntry <= bytes.size(); at += kEntry) {
    std::pair<std::uint32_t, Voxel> entry;
    std::memcpy(&entry.first, bytes.data() + at, sizeof(entry.first));
    std::memcpy(&entry.second, bytes.data() + at + sizeof(entry.first), sizeof(entry.second));
    tile.insert(entry);
  }
  return tile;
}

StaticMap::Tile& StaticMap::tile_at(const Place& place) {
  const auto [at, is_new] = tiles_.try_emplace(place);
  if (is_new && spilled_.erase(place) > 0) {
    at->second = read_tile(place);
    voxels_ += at->second.size();
    if (spilled_.empty()) fs::remove_all(spill_folder_);
  }
  return at->second;
}

void StaticMap::spill_far_from(const Eigen::Vector3d& sensor_m) {
  std::vector<std::pair<double, Place>> tiles;
  for (const auto& [place, tile] : tiles_) {
    const Eigen::Vector3d middle_voxels(static_cast<double>(place[0]),
                                        static_cast<double>(place[1]),
                                        static_cast<double>(place[2]));
    const Eigen::Vector3d middle_m = side_m() * (middle_voxels.array() + 0.5).matrix();
    tiles.emplace_back((middle_m - sensor_m).norm(), place);
  }
  std::ranges::sort(tiles, std::greater<>());
  fs::create_directories(spill_folder_);
  for (const auto& [distance_m, place] : tiles) {
    if (2 * voxels_ <= config_.most_voxels) return;
    const auto at = tiles_.find(place);
    std::string bytes;
    for (const auto& [in_tile, voxel] : at->second) {
      append(bytes, in_tile);
      append(bytes, voxel);
    }
    write_file_atomic(file_of(place), bytes);
    spilled_.insert(place);
    voxels_ -= at->second.size();
    tiles_.erase(at);
  }
}

void StaticMap::add_point(const Eigen::Vector3d& position_m, float intensity,
                          PointOutcome outcome) {
  Place place{};
  std::uint32_t in_tile = 0;
  Eigen::Vector3d corner_m;
  for (std::size_t axis = 0; axis < place.size(); ++axis) {
    const auto at = static_cast<Eigen::Index>(axis);
    const auto voxel = static_cast<std::int64_t>(std::floor(position_m[at] / config_.voxel_m));
    place[axis] = voxel >> kTileBits;
    in_tile = in_tile << kTileBits | static_cast<std::uint32_t>(voxel & (kTileVoxels - 1));
    corner_m[at] = static_cast<double>(place[axis]) * side_m();
  }
  const auto [entry, is_new] = tile_at(place).try_emplace(in_tile);
  voxels_ += is_new ? 1U : 0U;
  Voxel& voxel = entry->second;
  voxel.truth_moving |=
      outcome == PointOutcome::kTruePositive || outcome == PointOutcome::kFalseNegative;
  voxel.truth_static |=
      outcome == PointOutcome::kTrueNegative || outcome == PointOutcome::kFalsePositive;
  if (is_labelled_moving(outcome)) {
    ++voxel.moving_points;
    return;
  }
  if (voxel.static_points++ > 0) return;
  for (std::size_t axis = 0; axis < place.size(); ++axis) {
    const auto at = static_cast<Eigen::Index>(axis);
    voxel.in_tile_m[axis] = static_cast<float>(position_m[at] - corner_m[at]);
  }
  voxel.intensity = intensity;
}

void StaticMap::add(const JudgedScan& scan) {
  for (std::size_t i = 0; i < scan.outcomes.size(); ++i) {
    const Point& point = scan.frame.points[i];
    if (!is_return(point) || !config_.range.contains(range_m(point))) continue;
    add_point(scan.frame.map_from_sensor * position_of(point), point.intensity, scan.outcomes[i]);
  }
  if (voxels_ > config_.most_voxels) spill_far_from(scan.frame.map_from_sensor.translation());
}

bool StaticMap::is_kept(const Voxel& voxel) const {
  return voxel.static_points > 0 &&
         (!config_.by_majority || voxel.static_points > voxel.moving_points);
}

void StaticMap::for_each_tile(const std::function<void(const Place&, const Tile&)>& visit) const {
  std::set<Place> places = spilled_;
  for (const auto& [place, tile] : tiles_) places.insert(place);
  for (const Place& place : places) {
    const auto at = tiles_.find(place);
    visit(place, at == tiles_.end() ? read_tile(place) : at->second);
  }
}

void StaticMap::for_each(const std::function<void(const MapPoint&)>& visit) const {
  for_each_tile([&](const Place& place, const Tile& tile) {
    std::vector<std::pair<std::uint32_t, const Voxel*>> kept;
    for (const auto& [in_tile, voxel] : tile) {
      if (is_kept(voxel)) kept.emplace_back(in_tile, &voxel);
    }
    std::ranges::sort(kept, {}, &std::pair<std::uint32_t, const Voxel*>::first);
    for (const auto& [in_tile, voxel] : kept) {
      Eigen::Vector3d position_m;
      for (std::size_t axis = 0; axis < place.size(); ++axis) {
        position_m[static_cast<Eigen::Index>(axis)] =
            static_cast<double>(place[axis]) * side_m() + double{voxel->in_tile_m[axis]};
      }
      visit({position_m, voxel->intensity});
    }
  });
}

std::uint64_t StaticMap::size() const {
  std::uint64_t kept = 0;
  for_each_tile([&](const Place& /*place*/, const Tile& tile) {
    for (const auto& [in_tile, voxel] : tile) kept += is_kept(voxel) ? 1U : 0U;
  });
  return kept;
}

MapCounts StaticMap::voxels_with_truth() const {
  MapCounts counts;
  for_each_tile([&](const Place& /*place*/, const Tile& tile) {
    for (const auto& [in_tile, voxel] : tile) {
      if (voxel.truth_static) {
        ++counts.static_points;
        counts.kept_static += is_kept(voxel) ? 1U : 0U;
      } else if (voxel.truth_moving) {
        ++counts.dynamic_points;
        counts.removed_dynamic += is_kept(voxel) ? 0U : 1U;
      }
    }
  });
  return counts;
}

void for_each_judged(const ResultScans& scans,
                     const std::function<void(const JudgedScan& scan)>& visit) {
  const std::vector<ScanRow>& rows = scans.rows();
  if (std::ranges::none_of(rows, &ScanRow::judged)) {
    throw DataError(
        files_of(scans.sequence().recording()).front(),
        fmt::format("has {}, in which nothing can be seen to move", counted(rows.size(), "scan")),
        "the scans of a drive: a map says nothing of what moved");
  }
  Progress progress("static map", rows.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (rows[k].judged) visit(scans.read(k));
    progress.advance();
  }
}

void format_ply(const StaticMap& map, const ByteSink& sink) {
  sink(fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty double x\nproperty double "
      "y\nproperty double z\nproperty float intensity\nend_header\n",
      map.size()));
  format_points<double>(map, sink);
}

void format_pcd(const StaticMap& map, const fs::path& file, const ByteSink& sink) {
  double most_m = 0.0;
  std::uint64_t points = 0;
  map.for_each([&](const MapPoint& point) {
    most_m = std::max(most_m, point.position_map_m.cwiseAbs().maxCoeff());
    ++points;
  });
  const float step_m = float_step_m(static_cast<float>(most_m));
  if (step_m > kMostRounding * map.config().voxel_m) {
    throw DataError(
        file, fmt::format("positions up to {:.0f} m are {} m apart in float32", most_m, step_m),
        "poses nearer to their origin, or a .ply, which has float64");
  }
  sink(fmt::format(
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z intensity\nSIZE 4 4 4 "
      "4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH {0}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS "
      "{0}\nDATA binary\n",
      points));
  format_points<float>(map, sink);
}

}  // namespace mosbench
