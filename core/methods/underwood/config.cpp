#include "core/methods/underwood/config.hpp"

#include <stdexcept>
#include <string>

#include "core/base/range_limits.hpp"

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

}  // namespace mosbench::underwood
