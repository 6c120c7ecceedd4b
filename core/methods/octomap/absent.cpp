#include <stdexcept>
#include <string>

#include "core/methods/octomap/pipeline.hpp"

/// Stands in for pipeline.cpp in builds without OctoMap.
namespace mosbench::octomap {

std::unique_ptr<Method> make_pipeline(const Config&, const RunContext&) {
  throw std::invalid_argument("octomap: " + std::string(how_to_build()));
}

std::string_view how_to_build() {
  return "this build has no OctoMap, expected one with it (install liboctomap-dev, configure with "
         "-DMOSBENCH_WITH_OCTOMAP=ON)";
}

}  // namespace mosbench::octomap
