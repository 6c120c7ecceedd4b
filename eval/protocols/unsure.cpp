#include "eval/protocols/unsure.hpp"

#include <fmt/format.h>

#include "eval/protocols/metrics.hpp"

namespace mosbench {

void UnsureBounds::add(const ScoreRule& rule, std::span<const std::uint32_t> truth,
                       std::span<const std::uint32_t> prediction, std::span<const Point> points) {
  const LabelTable predicted(rule.protocol->prediction);
  std::vector<std::uint32_t> against(truth.begin(), truth.end()), in_favour = against;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if ((truth[i] & 0xFFFFU) != 0) continue;
    const bool moves = predicted[prediction[i]] == TruthClass::kMoving;
    against[i] = moves ? kStaticLabel : kMovingLabel;
    in_favour[i] = moves ? kMovingLabel : kStaticLabel;
  }
  lowest += score_scan(*rule.protocol, against, prediction, points, rule.range);
  highest += score_scan(*rule.protocol, in_favour, prediction, points, rule.range);
}

UnsureBounds& UnsureBounds::operator+=(const UnsureBounds& other) {
  lowest += other.lowest;
  highest += other.highest;
  return *this;
}

std::string UnsureBounds::text(const ScoreRule& rule) const {
  if (lowest == highest) return "";
  return fmt::format("unsure points leave {:.1f} to {:.1f} % IoU open, by {}",
                     100 * moving_iou(lowest).value_or(0), 100 * moving_iou(highest).value_or(1),
                     rule_name(rule));
}

}  // namespace mosbench
