#include "core/underwood/method.hpp"

#include "core/base/method_row.hpp"
#include "core/underwood/config.hpp"
#include "core/underwood/pipeline.hpp"

namespace mosbench::underwood {

MethodKind method_kind() {
  return {"underwood",
          "Underwood et al.",
          "Underwood, Gillsjo, Bailey, Vlaskine: Explicit 3D Change Detection using Ray-Tracing in "
          "Spherical Coordinates, ICRA 2013",
          "points in space that a scan one second before saw past",
          settings_of(Config{}),
          check_settings<Config>,
          make_method<Pipeline, Config>,
          false,
          "margin, m",
          "range tolerance, m"};
}

}  // namespace mosbench::underwood
