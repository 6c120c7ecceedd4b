#include "eval/statistics/pareto_front.hpp"

#include <algorithm>

namespace mosbench {
namespace {

bool is_whole(const IouAndTime& run) { return run.iou && run.ms_per_scan; }

/// Whether `other` is at least as good and as fast, and better in one.
bool beats(const IouAndTime& other, const IouAndTime& run) {
  if (!is_whole(other)) return false;
  const bool as_good = *other.iou >= *run.iou && *other.ms_per_scan <= *run.ms_per_scan;
  return as_good && (*other.iou > *run.iou || *other.ms_per_scan < *run.ms_per_scan);
}

}  // namespace

std::vector<bool> pareto_front(std::span<const IouAndTime> runs) {
  std::vector<bool> front;
  for (const IouAndTime& run : runs) {
    front.push_back(is_whole(run) && std::ranges::none_of(runs, [&](const IouAndTime& other) {
                      return beats(other, run);
                    }));
  }
  return front;
}

}  // namespace mosbench
