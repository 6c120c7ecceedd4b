#include "core/methods/underwood/method.hpp"

#include "core/base/method_row.hpp"
#include "core/methods/underwood/config.hpp"
#include "core/methods/underwood/pipeline.hpp"

namespace mosbench::underwood {

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
