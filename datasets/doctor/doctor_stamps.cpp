#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "datasets/doctor/doctor.hpp"
#include "datasets/doctor/registration.hpp"

namespace mosbench {
namespace {

/// Seconds between scans; less and more come from another unit.
constexpr double kShortestStepS = 0.01, kLongestStepS = 10.0;
/// A step in time so many times longer than usual is a gap, not a lost scan or two.
constexpr double kGapSteps = 10.0;
class StampCheck {
 public:
  StampCheck(const Sequence& sequence, SequenceCheckup& checkup)
      : sequence_(sequence), checkup_(checkup) {}

  std::vector<Symptom> run() {
    check_order();
    check_gaps();
    return std::move(symptoms_);
  }

 private:
  void warn(std::string what) {
    symptoms_.push_back({Severity::kWarning, sequence_.name(), std::move(what)});
  }

  void check_order() {
    std::size_t backward = 0;
    std::string first;
    for (std::size_t i = 1; i < sequence_.size(); ++i) {
      const auto before = sequence_.stamp_ns(i - 1);
      const auto after = sequence_.stamp_ns(i);
      if (!before || !after || *before < *after) continue;
      if (backward++ == 0) first = sequence_.stem(i);
    }
    if (backward == 0) return;
    warn(
        fmt::format("{} stamps are not later than the one before, first that of scan {}; expected "
                    "them in order",
                    backward, first));
  }

  void check_gaps() {
    std::vector<double> steps_s;
    std::vector<std::size_t> scans;
    for (std::size_t i = 1; i < sequence_.size(); ++i) {
      const auto before = sequence_.stamp_ns(i - 1);
      const auto after = sequence_.stamp_ns(i);
      if (!before || !after || *after <= *before) continue;
      steps_s.push_back(1e-9 * static_cast<double>(*after - *before));
      scans.push_back(i);
    }
    if (steps_s.empty()) return;
    const double usual_s = checkup_.measures["step_s"] = median(steps_s);
    if (usual_s < kShortestStepS || usual_s > kLongestStepS) {
      warn(
          fmt::format("stamps are {:g} s apart (median); expected seconds, about 0.1 from scan to "
                      "scan",
                      usual_s));
      return;
    }
    const auto longest = std::ranges::max_element(steps_s);
    const double steps = checkup_.measures["gap_steps"] = *longest / usual_s;
    if (steps <= kGapSteps) return;
    warn(
        fmt::format("scan {} comes {:.2f} s after the one before it, others {:.2f} s; expected no "
                    "gap in time",
                    sequence_.stem(scans[static_cast<std::size_t>(longest - steps_s.begin())]),
                    *longest, usual_s));
  }

  const Sequence& sequence_;
  SequenceCheckup& checkup_;
  std::vector<Symptom> symptoms_;
};

}  // namespace

std::vector<Symptom> check_stamps(const Sequence& sequence, SequenceCheckup& checkup) {
  return StampCheck(sequence, checkup).run();
}

}  // namespace mosbench
