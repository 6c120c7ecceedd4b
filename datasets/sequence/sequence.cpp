#include "datasets/sequence/sequence.hpp"

namespace mosbench {

std::vector<std::size_t> scans_with_truth(const Sequence& sequence) {
  std::vector<std::size_t> scans;
  for (std::size_t k = 0; k < sequence.size(); ++k) {
    if (sequence.has_truth(k)) scans.push_back(k);
  }
  return scans;
}

}  // namespace mosbench
