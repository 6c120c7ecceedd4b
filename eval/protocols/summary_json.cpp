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
  nlohmann::ordered_json json;
  for (std::size_t m = 0; m < kMetrics.size(); ++m) {
    json[std::string(kMetrics[m].key)] = number(summary.metrics[m]);
  }
  json["iou_deviation"] = number(summary.iou_deviation);
  json["published_iou"] = number(summary.published_iou);
  json["published_text"] = summary.published_text;
  json.update(counts_json(summary.pooled));
  json["unknown_ids"] = summary.pooled.unknown_ids;
  json["labelled_scans"] = summary.scans;
  json["undefined_scans"] = summary.undefined_scans;
  return json;
}

}  // namespace mosbench
