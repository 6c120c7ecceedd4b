#include <stdexcept>
#include <string>

#include "core/base/method_row.hpp"
#include "core/base/range_limits.hpp"
#include "core/methods/underwood/config.hpp"
#include "core/methods/underwood/pipeline.hpp"

namespace mosbench::underwood {

void check(const Config& config) {
  check_ranges(config);
  check_range_limits(config.min_range_m, config.max_range_m);
  const int references = config.references + (config.delay_scans > 0 ? 1 : 0);
  if (config.min_votes > references) {
    throw std::invalid_argument("min_votes: " + std::to_string(config.min_votes) +
                                " is more than the references, expected at most " +
                                std::to_string(references));
  }
}

/// "underwood": explicit change detection between two scans.
MethodKind method_kind() {
  return {
      .name = "underwood",
      .title = "Underwood et al.",
      .source =
          "Underwood, Gillsjo, Bailey, Vlaskine: Explicit 3D Change Detection using Ray-Tracing in "
          "Spherical Coordinates, ICRA 2013",
      .summary = "points in space that a scan one second before saw past",
      .defaults = settings_of(Config{}),
      .check = check_settings<Config>,
      .make = make_method<Pipeline, Config>,
      .score_name = "margin, m",
      .threshold_name = "range tolerance, m"};
}

}  // namespace mosbench::underwood
