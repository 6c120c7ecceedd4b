#include "eval/protocols/summary_json.hpp"

#include <cmath>

namespace mosbench {
namespace {

nlohmann::ordered_json number(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? nlohmann::ordered_json(*value) : nullptr;
}

}  // namespace

nlohmann::ordered_json to_json(const Summary& summary) {
  const Confusion& pooled = summary.pooled;
  return {{"iou", number(summary.iou)},
          {"precision", number(summary.precision)},
          {"recall", number(summary.recall)},
          {"f1", number(summary.f1)},
          {"iou_deviation", number(summary.iou_deviation)},
          {"published_iou", number(summary.published_iou)},
          {"published_text", summary.published_text},
          {"tp", pooled.tp},
          {"fp", pooled.fp},
          {"fn", pooled.fn},
          {"tn", pooled.tn},
          {"ignored", pooled.ignored},
          {"unknown_ids", pooled.unknown_ids},
          {"labelled_scans", summary.scans},
          {"undefined_scans", summary.undefined_scans}};
}

}  // namespace mosbench
