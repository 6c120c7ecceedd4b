#include "datasets/doctor/pose_evidence.hpp"

#include <cmath>

namespace mosbench {

double PoseEvidence::unlikeliness(const MeasuredMotion& pair, const Pose& claimed) const {
  return std::log1p(pair.misfit(claimed).both() / noise);
}

double PoseEvidence::off(const MeasuredMotion& pair) const {
  const Misfit misfit = pair.unsound(given_motion(pair));
  return std::max(misfit.translation, misfit.rotation);
}

}  // namespace mosbench
