#include "datasets/sequence/hdl64_correction.hpp"

#include <cmath>
#include <utility>

#include "datasets/sequence/portable_math.hpp"

namespace mosbench {

Point raised_by_hdl64_correction(const Point& point) {
  constexpr double kRadPerDeg = 3.14159265358979323846 / 180.0;
  static const SinCos raise = sin_cos(0.205 * kRadPerDeg);
  const double x = point.x, y = point.y, z = point.z;
  const double across_m = std::sqrt(x * x + y * y);
  if (across_m == 0.0) return point;
  const double scale = (across_m * raise.cos - z * raise.sin) / across_m;
  return {static_cast<float>(x * scale), static_cast<float>(y * scale),
          static_cast<float>(z * raise.cos + across_m * raise.sin), point.intensity};
}

Hdl64Corrected::Hdl64Corrected(std::unique_ptr<Sequence> inner) : SequenceAround(std::move(inner)) {
  mutable_recording().reading.hdl64_correction = true;
}

void Hdl64Corrected::read(std::size_t scan_index, Frame& frame) const {
  inner().read(scan_index, frame);
  for (Point& point : frame.points) point = raised_by_hdl64_correction(point);
}

}  // namespace mosbench
