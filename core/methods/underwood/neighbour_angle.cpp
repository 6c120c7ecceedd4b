#include "core/methods/underwood/neighbour_angle.hpp"

#include <algorithm>
#include <numbers>
#include <optional>
#include <sstream>

#include "core/base/beam_rows.hpp"

namespace mosbench::underwood {

void NeighbourAngle::measure(std::span<const Point> points, double min_range_m) {
  if (is_measured_ || least_rows_ == 0) return;
  const std::optional<RowSpacing> spacing = row_spacing(beam_directions(points, min_range_m));
  if (!spacing) return;
  is_measured_ = true;
  const double least_rad =
      std::min(least_rows_ * spacing->degrees / 180 * std::numbers::pi, kWidestAngle_rad);
  if (!spacing->is_regular || least_rad <= rad_) return;
  rad_ = least_rad;
  row_deg_ = spacing->degrees;
}

std::vector<std::string> NeighbourAngle::remarks() const {
  if (row_deg_ == 0) return {};
  std::ostringstream text;
  text << "The neighbour angle was widened to " << rad_ << " rad, as the sensor's rows are "
       << row_deg_ << " degrees apart.";
  return {text.str()};
}

}  // namespace mosbench::underwood
