#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/result/result_json.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

void visit_points(auto& row, auto&& visit) {
  visit("points", row.points);
  visit("predicted_moving_points", row.predicted_moving_points);
  visit("nonfinite_points", row.nonfinite_points);
}

void visit_counts(auto& counts, auto&& visit) {
  visit("tp", counts.tp);
  visit("fp", counts.fp);
  visit("fn", counts.fn);
  visit("tn", counts.tn);
  visit("ignored", counts.ignored);
  visit("unknown_ids", counts.unknown_ids);
}

std::optional<LabelHash> hash_from(const ordered_json& json, const std::string& name,
                                   const std::filesystem::path& file) {
  const std::string text = json.value(name, "");
  if (text.empty()) return std::nullopt;
  LabelHash hash;
  if (text.size() != hash.size()) {
    throw DataError(file, '"' + name + "\" is " + mosbench::quoted(text) + ", no 16 digits",
                    "a result.json of mosbench run");
  }
  std::ranges::copy(text, hash.begin());
  return hash;
}

/// Conversions of JSON numbers would cut fractions off and let negative ones wrap around.
auto counting_in(const ordered_json& json, const std::filesystem::path& file) {
  return [&](const char* name, auto& count) {
    const ordered_json& number = json.at(name);
    if (number.is_number_unsigned()) return void(number.get_to(count));
    throw DataError(
        file,
        fmt::format("\"{}\" of scan {} is {}", name, json.at("stem").dump(),
                    number.dump(-1, ' ', false, ordered_json::error_handler_t::replace)),
        "a number of points");
  };
}

void check_sums(const ScanRow& row, const std::filesystem::path& file) {
  const Confusion counts = row.counts.value_or(Confusion{.ignored = row.points});
  // No sum can wrap to a match: every part is at most the points.
  const bool fits =
      std::max({counts.tp, counts.fp, counts.fn, counts.tn, counts.ignored,
                std::uint64_t{row.nonfinite_points}, std::uint64_t{row.predicted_moving_points}}) <=
          row.points &&
      counts.points() == row.points && counts.tp + counts.fp <= row.predicted_moving_points;
  if (fits) return;
  throw DataError(
      file, fmt::format("the counts of scan \"{}\" do not fit its {} points", row.stem, row.points),
      "tp + fp + fn + tn + ignored = points, and tp + fp <= predicted_moving_points <= "
      "points");
}

// One array per scan, its meaning in "scan_columns": a tenth of the size of named members.
constexpr std::array kColumns = {"read_ms", "push_ms", "resident_mib"};

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

}  // namespace

ordered_json row_json(const ScanRow& row) {
  const auto text_of = [](const LabelHash& hash) { return std::string(hash.begin(), hash.end()); };
  ordered_json json = {{"stem", row.stem}};
  const auto add = [&](const char* name, std::uint64_t count) { json[name] = count; };
  visit_points(row, add);
  json["threshold"] = json_or_null(row.threshold);
  if (row.label_hash) json["label_hash"] = text_of(*row.label_hash);
  if (!row.counts) return json;
  visit_counts(*row.counts, add);
  if (row.truth_hash) json["truth_hash"] = text_of(*row.truth_hash);
  return json;
}

ScanRow row_from_json(const ordered_json& json, const std::filesystem::path& file) {
  ScanRow row;
  row.stem = json.at("stem").get<std::string>();
  visit_points(row, counting_in(json, file));
  if (!json.at("threshold").is_null()) row.threshold = json.at("threshold").get<double>();
  row.label_hash = hash_from(json, "label_hash", file);
  if (json.contains("tp")) {
    visit_counts(row.counts.emplace(), counting_in(json, file));
    row.truth_hash = hash_from(json, "truth_hash", file);
  }
  check_sums(row, file);
  return row;
}

ordered_json timing_json(const Result& result) {
  const Timing& timing = *result.timing;
  ordered_json json = {{"threads", timing.threads},
                       {"wall_s", timing.wall_s},
                       {"core_s", json_or_null(timing.core_s)},
                       {"program_cpu_s", json_or_null(timing.program_cpu_s)},
                       {"calibration_ms", json_or_null(timing.calibration_ms)},
                       {"method_ms_per_scan", json_or_null(method_ms_per_scan(result))},
                       {"stage_ms_per_scan", mean_stages_ms(timing)},
                       {"scan_columns", kColumns},
                       {"scans", ordered_json::array()}};
  for (const std::string& stage : timing.stages) json["scan_columns"].push_back(stage + "_ms");
  for (const ScanCost& cost : timing.costs) {
    std::vector<double> row = {cost.read_ms, cost.push_ms, cost.resident_mib};
    row.insert(row.end(), cost.stages_ms.begin(), cost.stages_ms.end());
    row.resize(kColumns.size() + timing.stages.size());
    json["scans"].push_back(row);
  }
  return json;
}

Timing timing_from_json(const ordered_json& json) {
  Timing timing;
  timing.threads = json.value("threads", 0U);
  timing.wall_s = json.at("wall_s");
  const auto take = [&](const char* name, std::optional<double>& time) {
    const auto member = json.find(name);
    if (member != json.end() && !member->is_null()) time = member->get<double>();
  };
  take("core_s", timing.core_s);
  take("program_cpu_s", timing.program_cpu_s);
  take("calibration_ms", timing.calibration_ms);
  const ordered_json& columns = json.at("scan_columns");
  for (std::size_t i = kColumns.size(); i < columns.size(); ++i) {
    std::string stage = columns.at(i);
    if (stage.ends_with("_ms")) stage.resize(stage.size() - 3);
    timing.stages.push_back(std::move(stage));
  }
  for (const ordered_json& row : json.at("scans")) {
    ScanCost& cost = timing.costs.emplace_back(ScanCost{row.at(0), row.at(1), {}, row.at(2)});
    for (std::size_t s = 0; s < timing.stages.size(); ++s) {
      cost.stages_ms.push_back(row.at(kColumns.size() + s));
    }
  }
  return timing;
}

}  // namespace mosbench
