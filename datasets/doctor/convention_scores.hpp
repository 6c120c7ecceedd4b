#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "datasets/doctor/pose_evidence.hpp"

namespace mosbench {

/// Poses with a larger mean square deviation are faulty: noise of 5 cm gives 1, of 10 cm 4.
inline constexpr double kUnsound = 2.0;
/// An explanation has to make the measured motions more likely by this (log) than the next. Wrong
/// ones next to sound poses lost 5 and more, or differed nowhere; right ones gained 15 (one row
/// later, highway, Aeva) and more.
inline constexpr double kLeastGain = 12.0;

/// How a convention fits the measured motions, on those where it differs from the given poses.
struct ConventionScore {
  std::size_t pairs = 0;  ///< none when the two differ nowhere
  double off_m = 0.0;     ///< median difference to the measured motions
  double given_off_m = 0.0;
  /// By how much more likely (log) the measured motions are under the convention.
  double gain = 0.0;
  double unsound = 0.0;        ///< see PoseDiagnosis, of the convention
  double given_unsound = 0.0;  ///< of the given poses on the same motions
  double median_misfit = 0.0;  ///< of the convention, in units of sound noise
  bool is_better = false;      ///< than the given poses
  bool explains = false;       ///< is better, and fits as well as sound poses would
};

/// Returns PoseEvidence::noise.
double noise_of_poses(const PoseEvidence& evidence, const std::vector<PoseConvention>& conventions);

ConventionScore score_of(const PoseEvidence& evidence, const PoseConvention& convention);

/// Returns the measures of the best convention, by name.
std::map<std::string, double> convention_measures(const std::vector<ConventionScore>& scores);

/// Returns the largest gain of a convention that is better; 0 when there is none.
double best_gain(const std::vector<ConventionScore>& scores);

/// Names the convention that fits best, or those that cannot be told apart; nothing when the best
/// one does not explain the measured motions.
std::optional<std::string> better_convention(const std::vector<PoseConvention>& conventions,
                                             const std::vector<ConventionScore>& scores);

/// Returns the flags that read the poses in one of the conventions that `better_convention` names;
/// empty where none or several of these take no more than flags.
std::string flags_for(const std::vector<PoseConvention>& conventions,
                      const std::vector<ConventionScore>& scores);

/// Returns the best conventions, from which to register scans again, when the best one does not
/// explain the measured motions: registration that starts from wrong poses may have missed them.
std::vector<PoseConvention> worth_another_try(const std::vector<PoseConvention>& conventions,
                                              const std::vector<ConventionScore>& scores);

}  // namespace mosbench
