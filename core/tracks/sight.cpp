#include "core/tracks/sight.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace mosbench::tracks {
namespace {

constexpr int kColumns = 900;
constexpr float kRowsPerRadian = 360 / std::numbers::pi_v<float>;
constexpr float kColumnsPerRadian = kColumns / (2 * std::numbers::pi_v<float>);
// A ray that passes a place by this much went on; one that ends this near to it hit it.
constexpr float kThrough_m = 0.3F, kThroughShare = 0.01F;
constexpr float kHit_m = 0.2F, kHitShare = 0.005F;
constexpr float kRepeats_m = 0.1F;

/// Returns the angle of (x, y), to 1e-5 rad: a polynomial, so that its bits are those of every
/// machine.
float angle_of(float y, float x) {
  const float ax = std::abs(x), ay = std::abs(y);
  const float most = std::max(ax, ay);
  if (!(most > 0)) return 0;
  const float t = std::min(ax, ay) / most, s = t * t;
  float angle = ((((0.0208351F * s - 0.085133F) * s + 0.180141F) * s - 0.3302995F) * s + 0.999866F);
  angle *= t;
  if (ay > ax) angle = std::numbers::pi_v<float> / 2 - angle;
  if (x < 0) angle = std::numbers::pi_v<float> - angle;
  return y < 0 ? -angle : angle;
}

/// std::floor is a call of the library on baseline x86-64.
int floor_of(float value) {
  const int whole = static_cast<int>(value);
  return whole - (value < static_cast<float>(whole) ? 1 : 0);
}

}  // namespace

Bearing bearing_of(const Eigen::Vector3f& p) {
  const float level = p.x() * p.x() + p.y() * p.y();
  Bearing bearing;
  bearing.range_m = std::sqrt(level + p.z() * p.z());
  if (!std::isfinite(bearing.range_m)) return bearing;
  bearing.row = floor_of(-angle_of(p.z(), std::sqrt(level)) * kRowsPerRadian);
  const int column = floor_of(angle_of(p.y(), p.x()) * kColumnsPerRadian);
  bearing.column = column < 0 ? column + kColumns : column;
  return bearing;
}

SensorImage::SensorImage(std::span<const Point> points, double min_range_m) {
  std::vector<Bearing> bearings;
  bearings.reserve(points.size());
  const auto least = static_cast<float>(min_range_m);
  int low = std::numeric_limits<int>::max(), high = std::numeric_limits<int>::min();
  for (const Point& point : points) {
    const Bearing bearing = bearing_of({point.x, point.y, point.z});
    // Negated, so that NaN fails as well.
    if (!(bearing.range_m > least && std::isfinite(bearing.range_m))) continue;
    low = std::min(low, bearing.row);
    high = std::max(high, bearing.row);
    bearings.push_back(bearing);
  }
  if (bearings.empty()) return;
  first_row_ = low - 1;  // a ray tells of the pixels around its own
  const int rows = high - low + 3;
  constexpr float kFar = std::numeric_limits<float>::infinity();
  const auto size = static_cast<std::size_t>(rows) * kColumns;
  std::vector<Span> own(size, {kFar, -kFar});
  const auto widen = [](Span& span, const Span& other) {
    span.nearest_m = std::min(span.nearest_m, other.nearest_m);
    span.farthest_m = std::max(span.farthest_m, other.farthest_m);
  };
  const auto place = [](int row, int column) {
    return static_cast<std::size_t>(row * kColumns + column);
  };
  for (const Bearing& bearing : bearings) {
    widen(own[place(bearing.row - first_row_, bearing.column)], {bearing.range_m, bearing.range_m});
  }
  std::vector<Span> wide = own;  // of three columns
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      widen(wide[place(row, column)], own[place(row, (column + 1) % kColumns)]);
      widen(wide[place(row, column)], own[place(row, (column + kColumns - 1) % kColumns)]);
    }
  }
  pixels_ = wide;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      if (row > 0) widen(pixels_[place(row, column)], wide[place(row - 1, column)]);
      if (row + 1 < rows) widen(pixels_[place(row, column)], wide[place(row + 1, column)]);
    }
  }
}

const SensorImage::Span* SensorImage::around(const Bearing& bearing) const {
  const std::ptrdiff_t row = bearing.row - first_row_;
  const auto place = row * kColumns + bearing.column;
  if (row < 0 || place >= static_cast<std::ptrdiff_t>(pixels_.size())) return nullptr;
  return &pixels_[static_cast<std::size_t>(place)];
}

Sight SensorImage::at(const Eigen::Vector3f& position_m) const {
  const Bearing bearing = bearing_of(position_m);
  const Span* span = around(bearing);
  if (span == nullptr || span->nearest_m > span->farthest_m) return Sight::kHidden;
  const float r = bearing.range_m;
  if (span->nearest_m > r + kThrough_m + kThroughShare * r) return Sight::kThrough;
  const float near = kHit_m + kHitShare * r;
  return span->nearest_m <= r + near && span->farthest_m >= r - near ? Sight::kHit : Sight::kHidden;
}

bool SensorImage::repeats(const Eigen::Vector3f& position_m) const {
  const Bearing bearing = bearing_of(position_m);
  const Span* span = around(bearing);
  return span != nullptr && span->nearest_m <= bearing.range_m + kRepeats_m &&
         span->farthest_m >= bearing.range_m - kRepeats_m;
}

SightImage::SightImage(std::span<const Point> points, double min_range_m,
                       const RayOrigins& origins) {
  if (origins.empty()) views_.push_back({Eigen::Vector3f::Zero(), {points, min_range_m}});
  std::vector<Point> own;
  const std::vector<Eigen::Vector3d>& places = origins.positions_m;
  for (auto place = places.begin(); place != places.end(); ++place) {
    if (std::find(places.begin(), place, *place) != place) continue;  // it has its view
    const Eigen::Vector3f at = place->cast<float>();
    own.clear();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Point& p = points[i];
      if (origins.at(i) != *place) continue;
      own.push_back({p.x - at.x(), p.y - at.y(), p.z - at.z(), p.intensity});
    }
    views_.push_back({at, {own, min_range_m}});
  }
}

Sight SightImage::at(const Eigen::Vector3f& position_m) const {
  Sight seen = Sight::kHidden;
  for (const View& view : views_) {
    seen = std::max(seen, view.image.at(position_m - view.sensor_m));
  }
  return seen;
}

bool SightImage::repeats(const Eigen::Vector3f& position_m) const {
  return std::ranges::any_of(
      views_, [&](const View& view) { return view.image.repeats(position_m - view.sensor_m); });
}

std::size_t SightImage::memory_bytes() const {
  std::size_t bytes = 0;
  for (const View& view : views_) bytes += view.image.memory_bytes();
  return bytes;
}

}  // namespace mosbench::tracks
