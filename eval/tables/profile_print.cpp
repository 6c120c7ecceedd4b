#include "eval/tables/profile_print.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "datasets/text/errors.hpp"
#include "datasets/text/numbers.hpp"
#include "datasets/text/text.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/result/machine.hpp"
#include "eval/result/result.hpp"
#include "eval/result/result_json.hpp"
#include "eval/result/settings_json.hpp"
#include "eval/result/tell.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

/// One line of the table: costs of every scan, wall and CPU side by side.
struct CostRow {
  std::string name;
  std::vector<double> wall_ms, cpu_ms;

  void add(const Cost& cost) {
    wall_ms.push_back(cost.wall_ms);
    cpu_ms.push_back(cost.cpu_ms);
  }
};

double ranked(const std::vector<double>& values, double q) {
  return quantile(values, q, QuantileRule::kNearestRank);
}

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

double mean(const std::vector<double>& values) {
  return sum(values) / static_cast<double>(values.size());
}

/// Read, the stages in order, what lies between them, and the whole.
std::vector<CostRow> cost_rows(const SequenceProfile& profile) {
  std::vector<CostRow> rows;
  for (const std::string_view name : profile.stages) rows.push_back({std::string(name), {}, {}});
  CostRow read{"read", {}, {}}, between{"between stages", {}, {}}, whole{"method", {}, {}};
  for (const ScanProfile& scan : profile.scans) {
    std::vector<Cost> stages(profile.stages.size());
    Cost rest = scan.method;
    for (const StageTime& event : scan.stages) {
      const auto place = std::ranges::find(profile.stages, event.name) - profile.stages.begin();
      Cost& cost = stages[static_cast<std::size_t>(place)];
      cost.wall_ms += event.wall_ms;
      cost.cpu_ms += event.cpu_ms;
      rest.wall_ms -= event.wall_ms;
      rest.cpu_ms -= event.cpu_ms;
    }
    for (std::size_t stage = 0; stage < stages.size(); ++stage) rows[stage].add(stages[stage]);
    read.add(scan.read);
    between.add({std::max(0.0, rest.wall_ms), std::max(0.0, rest.cpu_ms)});
    whole.add(scan.method);
  }
  rows.insert(rows.begin(), std::move(read));
  rows.push_back(std::move(between));
  rows.push_back(std::move(whole));
  return rows;
}

Sheet stage_sheet(const SequenceProfile& profile) {
  Sheet sheet{.columns = {{"stage", Unit::kText},
                          {"min", Unit::kNumber, 3},
                          {"median", Unit::kNumber, 3},
                          {"p95", Unit::kNumber, 3},
                          {"max", Unit::kNumber, 3},
                          {"share", Unit::kPercent},
                          {"CPU median", Unit::kNumber, 3},
                          {"CPU mean", Unit::kNumber, 3}}};
  const std::vector<CostRow> rows = cost_rows(profile);
  const double whole_ms = sum(rows.back().wall_ms);
  for (const CostRow& row : rows) {
    if (&row == &rows.back()) sheet.rows.emplace_back();
    sheet.rows.push_back({row.name, ranked(row.wall_ms, 0), ranked(row.wall_ms, 0.5),
                          ranked(row.wall_ms, 0.95), ranked(row.wall_ms, 1),
                          row.name == "read" ? Cell("") : Cell(sum(row.wall_ms) / whole_ms),
                          ranked(row.cpu_ms, 0.5), mean(row.cpu_ms)});
  }
  return sheet;
}

/// First, last and eight scans between.
Sheet memory_sheet(const SequenceProfile& profile) {
  Sheet sheet{.columns = {{"scan"},
                          {"resident MiB", Unit::kNumber, 1},
                          {"method MiB", Unit::kNumber, 1},
                          {"map blocks"}}};
  const std::size_t last = profile.scans.size() - 1;
  const std::size_t steps = std::min<std::size_t>(last, 9);
  for (std::size_t i = 0; i <= steps; ++i) {
    const std::size_t k = steps == 0 ? 0 : last * i / steps;
    const ScanProfile& scan = profile.scans[k];
    const auto& memory = scan.memory;
    sheet.rows.push_back(
        {std::uint64_t{k}, scan.resident_mib,
         memory ? Cell(static_cast<double>(memory->bytes) / 1048576.0) : Cell("n/a"),
         memory ? Cell(std::uint64_t{memory->map_blocks}) : Cell("n/a")});
  }
  return sheet;
}

double scan_ms(const SequenceProfile& profile) {
  double total_ms = 0;
  for (const ScanProfile& scan : profile.scans) total_ms += scan.read.wall_ms + scan.method.wall_ms;
  return total_ms / static_cast<double>(profile.scans.size());
}

double points_per_s(const SequenceProfile& profile) {
  double points = 0, wall_ms = 0;
  for (const ScanProfile& scan : profile.scans) {
    points += static_cast<double>(scan.points);
    wall_ms += scan.method.wall_ms;
  }
  return points / (wall_ms * 1e-3);
}

// Where a sequence has no stamps.
constexpr double kUsualPeriod_ms = 100;

double real_time_factor(const SequenceProfile& profile) {
  return profile.period_ms.value_or(kUsualPeriod_ms) / scan_ms(profile);
}

std::string speed_line(const SequenceProfile& profile) {
  return fmt::format(
      "{:.2f} ms per scan with reading, {:.2f} million points/s, {:.1f} times real time at {:g} ms "
      "per scan{}",
      scan_ms(profile), points_per_s(profile) * 1e-6, real_time_factor(profile),
      profile.period_ms.value_or(kUsualPeriod_ms),
      profile.period_ms ? "" : " (assumed: the sequence has no stamps)");
}

ordered_json sequence_json(const SequenceProfile& profile) {
  ordered_json stages = ordered_json::object();
  for (const CostRow& row : cost_rows(profile)) {
    const auto spread = [](const std::vector<double>& values) {
      return ordered_json{{"min", ranked(values, 0)},
                          {"median", ranked(values, 0.5)},
                          {"p95", ranked(values, 0.95)},
                          {"max", ranked(values, 1)},
                          {"mean", mean(values)}};
    };
    stages[row.name] = {{"wall_ms", spread(row.wall_ms)}, {"cpu_ms", spread(row.cpu_ms)}};
  }
  ordered_json scans = ordered_json::array();
  for (const ScanProfile& scan : profile.scans) {
    scans.push_back(
        {{"stem", scan.stem},
         {"points", scan.points},
         {"read_ms", scan.read.wall_ms},
         {"method_wall_ms", scan.method.wall_ms},
         {"method_cpu_ms", scan.method.cpu_ms},
         {"resident_mib", scan.resident_mib},
         {"method_bytes", scan.memory ? ordered_json(scan.memory->bytes) : ordered_json()},
         {"map_blocks", scan.memory ? ordered_json(scan.memory->map_blocks) : ordered_json()}});
  }
  return {{"sequence", profile.name},
          {"threads", profile.threads},
          {"program_cpu_s", profile.program_cpu_s},
          {"period_ms", json_or_null(profile.period_ms)},
          {"ms_per_scan", scan_ms(profile)},
          {"points_per_s", points_per_s(profile)},
          {"real_time_factor", real_time_factor(profile)},
          {"stages", std::move(stages)},
          {"scans", std::move(scans)}};
}

}  // namespace

ordered_json profile_json(const RunPlan& plan, const std::vector<SequenceProfile>& profiles) {
  ordered_json json = {{"dataset", std::string(to_string(plan.dataset.kind))},
                       {"method", std::string(plan.settings.method->name)},
                       {"preset", plan.preset},
                       {"config", to_json(plan.settings.method_settings)},
                       {"code", code_json()},
                       {"machine", to_json(this_machine())}};
  if (const auto origin = simulated_origin_json(plan.dataset)) json["simulated"] = *origin;
  json["sequences"] = ordered_json::array();
  for (const SequenceProfile& profile : profiles) {
    json["sequences"].push_back(sequence_json(profile));
  }
  return json;
}

Answer profile_answer(const RunPlan& plan, const std::vector<SequenceProfile>& profiles) {
  Answer answer{.standing = standing_of(plan.dataset)};
  for (const SequenceProfile& profile : profiles) {
    answer.sheets.push_back(stage_sheet(profile));
    answer.sheets.back().lead = {fmt::format("{}: {}, {}; milliseconds per scan", profile.name,
                                             counted(profile.scans.size(), "scan"),
                                             counted(profile.threads, "thread"))};
    if (profile.program_mib > 0) {
      answer.sheets.back().notes.push_back(
          fmt::format("CPU is without the program, which took {:.1f} s, its start included, and "
                      "held {:.1f} MiB",
                      profile.program_cpu_s, profile.program_mib));
    }
    answer.sheets.push_back(memory_sheet(profile));
    answer.sheets.back().notes = {speed_line(profile)};
  }
  answer.json = json_text(profile_json(plan, profiles));
  return answer;
}

ordered_json profile_trace(const std::vector<SequenceProfile>& profiles) {
  ordered_json events = ordered_json::array();
  const auto origin = profiles.front().scans.front().start;
  const auto at_us = [&](std::chrono::steady_clock::time_point time) {
    return std::chrono::duration<double, std::micro>(time - origin).count();
  };
  for (std::size_t process = 0; process < profiles.size(); ++process) {
    const auto add_event = [&](const std::string& name, const char* phase, ordered_json members) {
      events.push_back({{"name", name}, {"ph", phase}, {"pid", process}});
      events.back().update(members);
    };
    const auto add_slice = [&](const std::string& name, double start_us, double wall_ms,
                               ordered_json arguments) {
      add_event(name, "X",
                {{"tid", 1}, {"ts", start_us}, {"dur", wall_ms * 1e3}, {"args", arguments}});
    };
    add_event("process_name", "M", {{"args", {{"name", profiles[process].name}}}});
    for (const ScanProfile& scan : profiles[process].scans) {
      const double start_us = at_us(scan.start);
      add_slice("scan " + scan.stem, start_us, (at_us(scan.end) - start_us) * 1e-3,
                {{"points", scan.points}});
      add_slice("read", start_us, scan.read.wall_ms, {{"cpu_ms", scan.read.cpu_ms}});
      for (const StageTime& event : scan.stages) {
        add_slice(std::string(event.name), at_us(event.start), event.wall_ms,
                  {{"cpu_ms", event.cpu_ms}});
      }
      add_event("memory", "C", {{"ts", start_us}, {"args", {{"resident MiB", scan.resident_mib}}}});
      if (!scan.memory) continue;
      add_event("map", "C", {{"ts", start_us}, {"args", {{"blocks", scan.memory->map_blocks}}}});
    }
  }
  return {{"displayTimeUnit", "ms"}, {"traceEvents", std::move(events)}};
}

}  // namespace mosbench
