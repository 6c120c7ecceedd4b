#include "eval/protocols/summary_json.hpp"

#include <cmath>

#include "eval/protocols/counts_json.hpp"

namespace mosbench {
namespace {

nlohmann::ordered_json number(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? nlohmann::ordered_json(*value) : nullptr;
}

}  // namespace

nlohmann::ordered_json to_json(const Summary& summary) {
  nlohmann::ordered_json json = {{"iou", number(summary.iou)},
                                 {"precision", number(summary.precision)},
                                 {"recall", number(summary.recall)},
                                 {"f1", number(summary.f1)},
                                 {"iou_deviation", number(summary.iou_deviation)},
                                 {"published_iou", number(summary.published_iou)},
                                 {"published_text", summary.published_text}};
  json.update(counts_json(summary.pooled));
  json["unknown_ids"] = summary.pooled.unknown_ids;
  json["labelled_scans"] = summary.scans;
  json["undefined_scans"] = summary.undefined_scans;
  return json;
}

}  // namespace mosbench
