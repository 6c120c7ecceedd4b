#include "eval/engine/label_shift.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>

#include "datasets/text/counted.hpp"
#include "eval/protocols/metrics.hpp"

namespace mosbench {
namespace {

constexpr int kLargestShift_scans = 10;
constexpr std::size_t kComparedScans = 12;
/// Labels of a sound method fit their own scan best; in a dozen scans by chance at most this less.
constexpr double kClearlyBetter = 0.05;

/// Returns whether the labels of scan k + shift can be compared with the truth of scan k.
bool fits(const Sequence& sequence, const Predictions& labels, std::size_t k, int shift) {
  const auto other = static_cast<std::ptrdiff_t>(k) + shift;
  if (other < 0 || other >= static_cast<std::ptrdiff_t>(sequence.size())) return false;
  const auto index = static_cast<std::size_t>(other);
  return labels.has(index) && sequence.point_count(index) == sequence.point_count(k);
}

/// Returns evenly spread scans around which labels of all shifts can be compared.
std::vector<std::size_t> comparable_scans(const Sequence& sequence,
                                          const std::vector<std::size_t>& scans,
                                          const Predictions& labels) {
  std::vector<std::size_t> comparable;
  for (const std::size_t k : scans) {
    bool all = true;
    for (int shift = -kLargestShift_scans; all && shift <= kLargestShift_scans; ++shift) {
      all = fits(sequence, labels, k, shift);
    }
    if (all) comparable.push_back(k);
  }
  std::vector<std::size_t> spread;
  const std::size_t count = std::min(kComparedScans, comparable.size());
  for (std::size_t i = 0; i < count; ++i) {
    spread.push_back(comparable[i * comparable.size() / count]);
  }
  return spread;
}

std::string shift_text(int shift, double iou, double unshifted_iou, std::size_t scans) {
  const char* direction = shift > 0 ? "late" : "early";
  const std::string by = counted(std::abs(shift), "scan");
  std::string text = fmt::format(
      "labels look {} {}: those of {} {} fit the truth better, IoU {:.1f} in place of "
      "{:.1f} % in {}",
      by, direction, by, shift > 0 ? "later" : "earlier", 100.0 * iou, 100.0 * unshifted_iou,
      counted(scans, "scan"));
  if (shift > 0) {
    text += fmt::format(
        "; a method with a delay of {} that names labels by its newest scan leaves them so", by);
  }
  return text;
}

}  // namespace

std::string shift_remark(const Sequence& sequence, const std::vector<std::size_t>& scans,
                         const Predictions& labels, const ScoreRule& rule) {
  const std::vector<std::size_t> compared = comparable_scans(sequence, scans, labels);
  std::map<int, Confusion> by_shift;
  for (const std::size_t k : compared) {
    const Frame frame = sequence.read(k);
    for (int shift = -kLargestShift_scans; shift <= kLargestShift_scans; ++shift) {
      const auto other = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(k) + shift);
      by_shift[shift] +=
          score_scan(*rule.protocol, *frame.truth, labels.read(other), frame.points, rule.range);
    }
  }
  if (compared.empty()) return "";
  const auto iou = [&](int shift) { return moving_iou(by_shift.at(shift)).value_or(0.0); };
  int best = 0;
  for (const auto& [shift, counts] : by_shift) {
    if (iou(shift) > iou(best)) best = shift;
  }
  if (iou(best) <= iou(0) + kClearlyBetter) return "";
  return shift_text(best, iou(best), iou(0), compared.size());
}

}  // namespace mosbench
