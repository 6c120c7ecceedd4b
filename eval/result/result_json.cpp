#include "eval/result/result_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "datasets/text/errors.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/protocols/counts_json.hpp"
#include "eval/protocols/metrics.hpp"
#include "eval/protocols/summary_json.hpp"
#include "eval/result/reading_json.hpp"
#include "eval/result/result_set.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

std::string_view text_of(const LabelHash& hash) { return {hash.data(), hash.size()}; }

ordered_json to_json(const ScanRow& row) {
  ordered_json json = {{"stem", row.stem},
                       {"points", row.points},
                       {"predicted_moving_points", row.predicted_moving_points},
                       {"nonfinite_points", row.nonfinite_points},
                       {"threshold", json_or_null(row.threshold)}};
  if (row.label_hash) json["label_hash"] = text_of(*row.label_hash);
  if (!row.counts) return json;
  json.update(counts_json(*row.counts));
  json["unknown_ids"] = row.counts->unknown_ids;
  if (row.truth_hash) json["truth_hash"] = text_of(*row.truth_hash);
  return json;
}

ordered_json method_json(const Result& result) {
  if (result.kind.empty()) return {{"name", result.method}, {"setting", result.setting}};
  return {{"name", result.method}, {"kind", result.kind}};
}

ordered_json protocol_json(const Result& result) {
  return {{"name", result.protocol->name},
          {"min_range_m", result.range.min_m},
          {"max_range_m", result.range.max_m}};
}

ordered_json to_json(const OdometryDone& odometry) {
  ordered_json json = {{"name", odometry.name}, {"settings", to_json(odometry.settings)}};
  if (!odometry.map.empty()) json["map"] = odometry.map;
  return json;
}

ordered_json to_json(const Provenance& from) {
  ordered_json json = {{"version", from.version}};
  if (!from.compiler.empty()) json["compiler"] = from.compiler;
  if (from.machine) json["machine"] = to_json(*from.machine);
  if (!from.fingerprint.empty()) json["fingerprint"] = from.fingerprint;
  if (!from.fingerprint_without_poses.empty()) {
    json["fingerprint_without_poses"] = from.fingerprint_without_poses;
  }
  if (from.simulated) json["simulated"] = to_json(*from.simulated);
  return json;
}

std::vector<std::string> scans_without_detection(const Result& result) {
  std::vector<std::string> stems;
  for (const ScanRow& row : result.scans) {
    if (!row.judged) stems.push_back(row.stem);
  }
  return stems;
}

ordered_json summary_json(const Result& result) {
  const SequenceCounts counts = counts_of(result);
  return counts.empty() ? ordered_json() : to_json(summarize(*result.protocol, counts));
}

ordered_json mean_stages_ms(const Timing& timing) {
  ordered_json means = ordered_json::object();
  if (timing.costs.empty()) return means;
  for (std::size_t s = 0; s < timing.stages.size(); ++s) {
    double sum_ms = 0.0;
    for (const ScanCost& cost : timing.costs) {
      if (s < cost.stages_ms.size()) sum_ms += cost.stages_ms[s];
    }
    means[timing.stages[s]] = sum_ms / static_cast<double>(timing.costs.size());
  }
  return means;
}

// One array per scan, its meaning in "scan_columns": a tenth of the size of named members.
constexpr std::size_t kCostColumns = 3;

ordered_json timing_json(const Result& result) {
  const Timing& timing = *result.timing;
  ordered_json json = {{"threads", timing.threads},
                       {"wall_s", timing.wall_s},
                       {"core_s", json_or_null(timing.core_s)},
                       {"method_ms_per_scan", json_or_null(method_ms_per_scan(result))},
                       {"stage_ms_per_scan", mean_stages_ms(timing)},
                       {"scan_columns", {"read_ms", "push_ms", "resident_mib"}},
                       {"scans", ordered_json::array()}};
  for (const std::string& stage : timing.stages) json["scan_columns"].push_back(stage + "_ms");
  for (const ScanCost& cost : timing.costs) {
    ordered_json row = {cost.read_ms, cost.push_ms, cost.resident_mib};
    for (std::size_t s = 0; s < timing.stages.size(); ++s) {
      row.push_back(s < cost.stages_ms.size() ? cost.stages_ms[s] : 0.0);
    }
    json["scans"].push_back(std::move(row));
  }
  return json;
}

ordered_json to_json(const PredictionSource& source) {
  const PredictionOptions& options = source.options;
  ordered_json json = {{"path", source.path.string()}, {"level", to_string(options.level)}};
  if (options.format) json["format"] = describe(*options.format).name;
  if (options.mask) json["mask_m"] = {options.mask->min_m, options.mask->max_m};
  if (options.id_map) json["id_map"] = id_map_text(*options.id_map);
  return json;
}

ordered_json to_json(const Places& places) {
  ordered_json json = ordered_json::object();
  if (places.dataset_root) json["dataset_root"] = places.dataset_root->string();
  json["reading"] = told_json(places.reading);
  if (places.predictions) json["predictions"] = to_json(*places.predictions);
  if (!places.file_stamp.empty()) json["file_stamp"] = places.file_stamp;
  if (!places.sequences_of_run.empty()) json["sequences_of_run"] = places.sequences_of_run;
  return json;
}

}  // namespace

ordered_json to_json(const SimulatedOrigin& origin) {
  ordered_json members = {{"scene", origin.scene},
                          {"seed", origin.seed},
                          {"scene_fingerprint", origin.scene_fingerprint},
                          {"notice", simulated_notice(origin)}};
  if (origin.perturb) members["perturb"] = *origin.perturb;
  return members;
}

ordered_json to_json(const ScoredPredictions& predictions) {
  return {{"format", predictions.format},
          {"guessed", predictions.guessed},
          {"path", predictions.path},
          {"missing", predictions.missing},
          {"remarks", predictions.remarks}};
}

ordered_json identity_json(const Result& result) {
  ordered_json json = {{"sequence", result.sequence.text()},
                       {"dataset", result.dataset},
                       {"reading", to_json(result.from.reading)},
                       {"method", method_json(result)},
                       {"protocol", protocol_json(result)}};
  if (result.settings) json["settings"] = to_json(*result.settings);
  json["code"] = {{"version", result.from.version}, {"compiler", result.from.compiler}};
  return json;
}

ordered_json header_json(const Result& result) {
  ordered_json json = {{"format", kResultFormat}};
  if (!result.key.empty()) json["key"] = result.key;
  json.update(identity_json(result));
  json.erase("code");
  if (!result.preset.empty()) json["preset"] = result.preset;
  if (!result.from.program.empty()) json["program"] = result.from.program;
  if (result.from.odometry) json["odometry"] = to_json(*result.from.odometry);
  json["provenance"] = to_json(result.from);
  if (result.predictions) json["predictions"] = to_json(*result.predictions);
  json["remarks"] = result.remarks;
  json["scans_without_detection"] = scans_without_detection(result);
  if (!result.scans_left_out.empty()) json["scans_left_out"] = result.scans_left_out;
  if (result.doubtful_poses) {
    json["doubtful_poses"] = ordered_json::array();
    for (const DoubtfulPose& pose : *result.doubtful_poses) {
      json["doubtful_poses"].push_back({{"stem", pose.stem}, {"doubt", pose.doubt}});
    }
  }
  if (!result.splits.empty()) json["splits"] = result.splits;
  json["summary_split"] = json_or_null(result.summary_split);
  json["summary"] = summary_json(result);
  return json;
}

ordered_json to_json(const Result& result) {
  ordered_json json = header_json(result);
  json["scans"] = ordered_json::array();
  for (const ScanRow& row : result.scans) json["scans"].push_back(to_json(row));
  if (result.timing) json["timing"] = timing_json(result);
  if (result.places) json["places"] = to_json(*result.places);
  return json;
}

}  // namespace mosbench
