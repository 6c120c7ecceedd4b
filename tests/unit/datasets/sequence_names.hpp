#pragma once

#include <string>
#include <vector>

#include "datasets/layouts/dataset.hpp"

namespace mosbench {

inline std::vector<std::string> sequence_names(const Dataset& dataset) {
  std::vector<std::string> names;
  for (const auto& sequence : dataset.sequences) names.push_back(sequence->name());
  return names;
}

}  // namespace mosbench
