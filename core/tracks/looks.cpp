#include "core/tracks/looks.hpp"

namespace mosbench::tracks {

Evidence evidence_of(const Eigen::Vector3f& point_m, std::span<const Look> looks) {
  Evidence evidence;
  for (const Look& look : looks) {
    const Sight sight = look.at(point_m);
    if (sight == Sight::kThrough)
      ++(look.before ? evidence.through_before : evidence.through_after);
    if (sight == Sight::kHit) ++(look.before ? evidence.hit_before : evidence.hit_after);
  }
  return evidence;
}

bool is_carrier(const Eigen::Vector3f& point_m, std::span<const Look> looks) {
  constexpr float kCarrier_m = 3, kMoved_m = 1;
  if (point_m.norm() > kCarrier_m) return false;
  int moved = 0, repeated = 0;
  for (const Look& look : looks) {
    if (look.there_from_here.translation().norm() < kMoved_m) continue;
    ++moved;
    repeated += look.image->repeats(point_m) ? 1 : 0;
  }
  return 2 * repeated > moved;
}

}  // namespace mosbench::tracks
