#include "eval/statistics/statistics_report.hpp"

#include <fmt/format.h>

#include "eval/answer/answer_text.hpp"
#include "eval/answer/render.hpp"
#include "eval/protocols/metrics.hpp"
#include "eval/result/result_json.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

ordered_json spread_json(const Estimate& estimate) {
  ordered_json json = {{"value", json_or_null(estimate.value)},
                       {"standard_error", json_or_null(estimate.standard_error)}};
  json.update(interval_json(spread_of(estimate)));
  return json;
}

std::vector<Cell> estimate_cells(const std::string& name, std::uint64_t scans,
                                 const Estimates& estimates) {
  std::vector<Cell> cells = {name, scans};
  for (const Estimate& metric : estimates.metrics) cells.emplace_back(spread_of(metric));
  return cells;
}

}  // namespace

std::string headline(const ResultSet& set) {
  const Result& first = set.front();
  return fmt::format("{}; data set {}, protocol {}", method_words(first), first.dataset,
                     first.protocol->name);
}

namespace {

/// A row per counted scan.
Sheet scan_sheet(const ResultSet& set) {
  Sheet sheet{.columns = {{"sequence", Unit::kText},
                          {"scan", Unit::kText},
                          {"points"},
                          {"tp"},
                          {"fp"},
                          {"fn"},
                          {"tn"},
                          {"ignored"}}};
  for (const MetricRow& metric : kMetrics) sheet.columns.push_back({std::string(metric.key)});
  for (const Result& sequence : set.sequences) {
    for (const ScanRow* row : counted_scans(sequence)) {
      const Confusion& counts = *row->counts;
      std::vector<Cell>& cells = sheet.rows.emplace_back();
      cells = {sequence.sequence.text(),
               row->stem,
               std::uint64_t{row->points},
               counts.tp,
               counts.fp,
               counts.fn,
               counts.tn,
               counts.ignored};
      for (const double value : metrics_of(counts)) cells.emplace_back(value);
    }
  }
  return sheet;
}

}  // namespace

Spread spread_of(const Estimate& estimate) {
  if (!estimate.interval) return {estimate.value, {}, {}, estimate.no_interval};
  return {estimate.value, estimate.interval->low, estimate.interval->high};
}

ordered_json to_json(const Estimates& estimates) {
  ordered_json json;
  for (std::size_t m = 0; m < kMetrics.size(); ++m) {
    json[std::string(kMetrics[m].key)] = spread_json(estimates.metrics[m]);
  }
  return json;
}

ordered_json to_json(const Difference& difference) {
  ordered_json json = spread_json(difference);
  json["p_value"] = json_or_null(difference.p_value);
  json["smallest_detectable"] = json_or_null(difference.smallest_detectable);
  return json;
}

ordered_json to_json(const Differences& differences) {
  ordered_json json;
  for (std::size_t m = 0; m < kMetrics.size(); ++m) {
    json[std::string(kMetrics[m].key)] = to_json(differences.metrics[m]);
  }
  return json;
}

ordered_json provenance_json(const ResultSet& set) {
  const Result& first = set.front();
  ordered_json json = {{"path", set.path.string()},
                       {"method", first.method},
                       {"setting", first.setting},
                       {"dataset", first.dataset}};
  json.update(rule_json({first.protocol, first.range}));
  if (!first.preset.empty()) json["preset"] = first.preset;
  if (first.settings) json["config"] = to_json(*first.settings);
  json["code"]["version"] = first.from.version;
  if (!first.from.compiler.empty()) json["code"]["compiler"] = first.from.compiler;
  if (first.predictions) json["predictions"] = to_json(*first.predictions);
  if (first.from.simulated) json["simulated"] = to_json(*first.from.simulated);
  json["missing_predictions"] = missing_predictions(set.sequences);
  if (const auto split = only_split(first)) json["only_split"] = *split;
  return json;
}

namespace {

ordered_json statistics_json(const ResultSet& set, bool per_scan) {
  ordered_json json = provenance_json(set);
  json["confidence"] = kConfidence;
  json["sequences"] = ordered_json::array();
  for (const Result& sequence : set.sequences) {
    json["sequences"].push_back({{"name", sequence.sequence.text()},
                                 {"scans", counted_scans(sequence).size()},
                                 {"fingerprint", sequence.from.fingerprint},
                                 {"metrics", to_json(estimate({&sequence, 1}))}});
  }
  json["all"] = to_json(estimate(set.sequences));
  if (per_scan) json["scans"] = records_json(scan_sheet(set));
  return json;
}

}  // namespace

Answer statistics_answer(const ResultSet& set, bool per_scan) {
  Sheet sheet{.lead = {headline(set)},
              .columns = {{"sequence", Unit::kText}, {"scans"}},
              .notes = {"95 %: where the value of many more scans like these would be"}};
  for (const MetricRow& metric : kMetrics) {
    sheet.columns.push_back({std::string(metric.title), Unit::kPercent});
  }
  std::uint64_t scans = 0;
  const auto add = [&](const std::string& name, std::uint64_t counted, const Estimates& estimates) {
    sheet.rows.push_back(estimate_cells(name, counted, estimates));
    const std::string& why = estimates[Metric::kIou].no_interval;
    if (!why.empty()) sheet.notes.push_back(fmt::format("no interval for {}: {}", name, why));
  };
  for (const Result& sequence : set.sequences) {
    const std::uint64_t counted = counted_scans(sequence).size();
    scans += counted;
    add(sequence.sequence.text(), counted, estimate({&sequence, 1}));
  }
  sheet.rows.emplace_back();
  add("all", scans, estimate(set.sequences));
  return {.standing = standing_of(set),
          .sheets = {std::move(sheet)},
          .records = scan_sheet(set),
          .json = json_text(statistics_json(set, per_scan))};
}

Answer difference_answer(const ResultSet& first, const ResultSet& second,
                         const PairedRuns& paired) {
  const Differences differences =
      paired_difference(*first.front().protocol, paired.first, paired.second, paired.spacing);
  const std::string unlike = unlike_text(paired.unlike);
  Sheet sheet{
      .lead = {"first:  " + headline(first), "second: " + headline(second),
               fmt::format("{} paired scans{}{}", paired.scans.size(), unlike.empty() ? "" : "; ",
                           unlike)},
      .columns = {{"second - first", Unit::kText},
                  {"difference", Unit::kPoints},
                  {"p", Unit::kNumber, 4},
                  {"detectable", Unit::kPercent, 2}},
      .notes = {"in percentage points; detectable: the true difference that as many scans like "
                "these show",
                "at 5 % significance with 80 % probability; n times as many scans divide it by "
                "sqrt(n)"}};
  for (std::size_t m = 0; m < kMetrics.size(); ++m) {
    const Difference& metric = differences.metrics[m];
    sheet.rows.push_back({std::string(kMetrics[m].key), spread_of(metric),
                          or_missing(metric.p_value), or_undefined(metric.smallest_detectable)});
  }
  if (const std::string& why = differences[Metric::kIou].no_interval; !why.empty()) {
    sheet.notes.push_back("no interval for the difference: " + why);
  }
  const ordered_json json = {{"first", provenance_json(first)},
                             {"second", provenance_json(second)},
                             {"confidence", kConfidence},
                             {"paired_scans", paired.scans.size()},
                             {"unlike", unlike},
                             {"difference", to_json(differences)}};
  return {.standing = standing_of(first, "first", second, "second"),
          .sheets = {std::move(sheet)},
          .json = json_text(json)};
}

namespace {

/// "room: 1503.6 false positives per scan were added, at most 10 may be".
std::string added_text(const GateCheck& check) {
  return fmt::format("{}: {:.1f} false positives per scan were added, at most {:g} may be",
                     check.name, check.new_false_positives - check.baseline_false_positives,
                     *check.most_added_false_positives);
}

}  // namespace

Sheet gate_sheet(const GateResult& result) {
  Sheet sheet{
      .title = result.passed() ? "MOS gate: pass" : "MOS gate: REGRESSION",
      .columns = {{"sequence", Unit::kText},
                  {"baseline IoU", Unit::kPercent},
                  {"new IoU", Unit::kPercent},
                  {"difference", Unit::kPoints},
                  {"tolerance", Unit::kPercent, 2},
                  {"p", Unit::kNumber, 4},
                  {"baseline FP/scan", Unit::kNumber, 1},
                  {"new FP/scan", Unit::kNumber, 1},
                  {"verdict", Unit::kText}},
      .notes = {result.rule == GateRule::kStatistical
                    ? "95 %: interval of the difference; a drop within its half-width passes"
                    : "95 %: what other scans like these would show; it does not decide "
                      "(--statistical)"}};
  for (const GateCheck& check : result.checks) {
    sheet.rows.push_back({check.name, or_undefined(check.baseline), or_undefined(check.newer),
                          spread_of(check.difference), check.tolerance,
                          or_missing(check.difference.p_value), check.baseline_false_positives,
                          check.new_false_positives, check.passed() ? "pass" : "REGRESSION"});
    if (!check.passed() && check.iou_passed) sheet.notes.push_back(added_text(check));
    const std::string& why = check.difference.no_interval;
    if (!why.empty()) sheet.notes.push_back(fmt::format("no interval for {}: {}", check.name, why));
  }
  sheet.notes.emplace_back(result.passed() ? "pass" : "regression");
  return sheet;
}

Sheet cost_sheet(const GateResult& result) {
  Sheet sheet{.columns = {{"cost", Unit::kText},
                          {"baseline", Unit::kNumber, 1},
                          {"new", Unit::kNumber, 1},
                          {"change", Unit::kPercent},
                          {"tolerance", Unit::kPercent},
                          {"verdict", Unit::kText}},
              .notes = {"a cost fails only by --max-cost"}};
  for (const CostCheck& cost : result.costs) {
    const char* verdict = !cost.unjudged.empty() ? "not judged"
                          : cost.is_within()     ? "pass"
                          : cost.limit           ? "REGRESSION"
                                                 : "warning";
    sheet.rows.push_back({std::string(cost.kind->title), cost.baseline, cost.newer, cost.growth(),
                          cost.tolerance(), verdict});
    if (!cost.unjudged.empty()) {
      sheet.notes.push_back(fmt::format("{}: {}", cost.kind->title, cost.unjudged));
    }
    if (cost.factor != 1.0) {
      sheet.notes.push_back(
          fmt::format("new {} as on the baseline's machine, by the calibrations: "
                      "times {:.2f}",
                      cost.kind->title, cost.factor));
    }
  }
  return sheet;
}

std::vector<CheckResult> gate_checks(const GateResult& result) {
  std::vector<CheckResult> checks;
  for (const GateCheck& check : result.checks) {
    CheckResult& told = checks.emplace_back(CheckResult{check.name, "", ""});
    if (check.passed()) continue;
    if (check.iou_passed) {
      told.title = fmt::format("False positives of {}", check.name);
      told.message = added_text(check);
      continue;
    }
    const std::string now =
        check.newer ? fmt::format("{} % now: {} points, tolerance {}", percent_text(check.newer),
                                  percent_text(check.difference.value, "{:+.2f}"),
                                  percent_text(check.tolerance, "{:.2f}"))
                    : "undefined now";
    told.title = fmt::format("IoU of {} dropped", check.name);
    told.message = percent_text(check.baseline) + " % before, " + now;
  }
  for (const CostCheck& cost : result.costs) {
    const bool is_judged = cost.unjudged.empty();
    if (!is_judged && !cost.limit) continue;
    CheckResult& told = checks.emplace_back(CheckResult{std::string(cost.kind->title), "", ""});
    if (cost.warns()) told.severity = CheckResult::Severity::kWarning;
    if (cost.passed() && !cost.warns()) continue;
    told.title = fmt::format("{} {}", cost.kind->title, is_judged ? "grew" : "not judged");
    told.message =
        fmt::format("{:.1f} before, {:.1f} now: {} %, tolerance {} %", cost.baseline, cost.newer,
                    percent_text(cost.growth(), "{:+.1f}"), percent_text(cost.tolerance()));
    if (!is_judged) told.message = cost.unjudged;
  }
  return checks;
}

ordered_json to_json(const GateResult& result) {
  ordered_json json = {{"passed", result.passed()},
                       {"rule", result.rule == GateRule::kStatistical ? "statistical" : "max-drop"},
                       {"checks", ordered_json::array()}};
  for (const GateCheck& check : result.checks) {
    ordered_json& one = json["checks"].emplace_back();
    one = {{"name", check.name},
           {"baseline_iou", json_or_null(check.baseline)},
           {"new_iou", json_or_null(check.newer)},
           {"difference", json_or_null(check.difference.value)}};
    one.update(interval_json(spread_of(check.difference)));
    one["p_value"] = json_or_null(check.difference.p_value);
    one["tolerance"] = check.tolerance;
    one["baseline_false_positives_per_scan"] = check.baseline_false_positives;
    one["new_false_positives_per_scan"] = check.new_false_positives;
    one["most_added_false_positives_per_scan"] = json_or_null(check.most_added_false_positives);
    one["passed"] = check.passed();
  }
  json["costs"] = ordered_json::array();
  for (const CostCheck& cost : result.costs) {
    const bool is_judged = cost.unjudged.empty();
    json["costs"].push_back(
        {{"name", std::string(cost.kind->key)},
         {"baseline", cost.baseline},
         {"new", cost.newer},
         {"change", cost.growth()},
         {"tolerance", cost.tolerance()},
         {"factor", cost.factor},
         {"decides", cost.limit.has_value()},
         {"unjudged", cost.unjudged},
         {"passed", is_judged ? ordered_json(cost.is_within()) : ordered_json()}});
  }
  return json;
}

}  // namespace mosbench
