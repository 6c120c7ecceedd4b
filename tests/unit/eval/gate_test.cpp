#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "datasets/text/errors.hpp"
#include "eval/answer/render.hpp"
#include "eval/statistics/statistics_report.hpp"

namespace mosbench {
namespace {

/// 400 scans of 1,000 moving points, of which the second run loses 300 in every twentieth.
struct DropInFewScans : testing::Test {
  DropInFewScans() {
    for (std::size_t k = 0; k < 400; ++k) {
      names_.push_back({"street", std::to_string(k), nullptr, nullptr});
      Confusion counts;
      counts.tp = 800 + k * 7 % 31;
      counts.fn = 1000 - counts.tp;
      first_.push_back(counts);
      if (k % 20 == 0) counts.tp -= 300;
      counts.fn = 1000 - counts.tp;
      second_.push_back(counts);
    }
  }
  GateResult judged(GateRule rule) const {
    return judge({names_, {first_}, {second_}, {}}, protocol_named("sipailou"), {0.005, rule});
  }
  std::vector<PairedRuns::Scan> names_;
  SequenceCounts first_, second_;
};

TEST_F(DropInFewScans, FailsByTheMaxDropAlone) {
  const GateResult result = judged(GateRule::kMaxDrop);
  ASSERT_EQ(result.checks.size(), 1U);
  EXPECT_NEAR(result.checks[0].difference.value.value(), -0.015, 1e-9);
  ASSERT_TRUE(result.checks[0].difference.interval);
  EXPECT_EQ(result.checks[0].tolerance, 0.005);
  EXPECT_FALSE(result.passed());
}

TEST_F(DropInFewScans, IsComparedWithTheIntervalByTheStatisticalRule) {
  const GateCheck check = judged(GateRule::kStatistical).checks.at(0);
  const Interval interval = check.difference.interval.value();
  EXPECT_NEAR(check.tolerance, std::max(0.005, 0.5 * (interval.high - interval.low)), 1e-12);
  EXPECT_EQ(check.passed(), check.difference.p_value.value() >= 0.05);
}

TEST(Gate, FailsWhereAnIouBecomesUndefinedAndPassesWhereItWas) {
  const Confusion false_alarm{.fp = 1}, nothing{.tn = 1};
  const auto passes = [](const Confusion& first, const Confusion& second) {
    const PairedRuns paired{{{"street", "0", nullptr, nullptr}}, {{first}}, {{second}}, {}};
    return judge(paired, protocol_named("sipailou"), {0.005, GateRule::kMaxDrop}).passed();
  };
  EXPECT_FALSE(passes(false_alarm, nothing));
  EXPECT_TRUE(passes(nothing, false_alarm));
  EXPECT_TRUE(passes(nothing, nothing));
}

TEST(Gate, FailsWhereNothingMovesAndManyPointsAreCalledMoving) {
  const auto judged = [](std::uint64_t before, std::uint64_t after, std::uint64_t moving,
                         std::optional<double> limit) {
    const SequenceCounts first(2, {.tp = moving, .fp = before, .tn = 100'000});
    const SequenceCounts second(2, {.tp = moving, .fp = after, .tn = 100'000});
    const PairedRuns paired{
        {{"room", "0", nullptr, nullptr}, {"room", "1", nullptr, nullptr}}, {first}, {second}, {}};
    return judge(paired, protocol_named("sipailou"), {1.0, GateRule::kMaxDrop, limit});
  };
  const GateResult alarm = judged(0, 15'036, 0, {});
  EXPECT_FALSE(alarm.passed());
  EXPECT_THAT(render({.sheets = {gate_sheet(alarm)}}, Format::kText),
              testing::HasSubstr("room: 15036.0 false positives per scan were added, at most 10"));
  EXPECT_THAT(gate_checks(alarm).at(0).title, testing::Eq("False positives of room"));
  EXPECT_EQ(to_json(alarm).at("checks").at(0).at("new_false_positives_per_scan"), 15'036.0);
  EXPECT_TRUE(judged(0, 10, 0, {}).passed());
  EXPECT_FALSE(judged(0, 11, 0, {}).passed());
  EXPECT_TRUE(judged(20'000, 15'036, 0, {}).passed());
  // Where points move the IoU tells, unless a limit is asked for.
  EXPECT_TRUE(judged(0, 15'036, 1000, {}).passed());
  EXPECT_FALSE(judged(0, 15'036, 1000, 15'035).passed());
  EXPECT_TRUE(judged(0, 15'036, 1000, 15'036).passed());
  EXPECT_TRUE(judged(0, 15'036, 0, 15'036).passed());
}

ResultSet run_that_cost(const RunCost& cost) {
  Result result;
  result.sequence = SequenceName("street", "street");
  result.kind = "hmm-mos";
  result.scans.resize(4);
  result.cost = cost;
  return {"run", {result}};
}

TEST(Gate, ComparesCpuByTheSpeedOfBothMachines) {
  const ResultSet slow = run_that_cost({4000.0, 10.0, 100.0, 1000});
  const ResultSet fast = run_that_cost({2200.0, 5.0, 130.0, 1000});
  const auto checks = check_costs(slow, fast, cost_limits("--max-cost", "cpu=9"));
  ASSERT_EQ(checks.size(), 3U);
  EXPECT_NEAR(checks[0].growth(), 0.1, 1e-12) << "4400 ms on the slower machine";
  EXPECT_FALSE(checks[0].passed());
  EXPECT_FALSE(checks[1].is_within());
  EXPECT_TRUE(checks[1].passed()) << "a warning";
  EXPECT_TRUE(checks[2].is_within());
  EXPECT_TRUE(check_costs(slow, fast, cost_limits("--max-cost", "cpu=10"))[0].passed());
  const GateResult result{GateRule::kMaxDrop, {}, checks};
  EXPECT_FALSE(result.passed());
  EXPECT_THAT(render({.sheets = {cost_sheet(result)}}, Format::kText),
              testing::AllOf(
                  testing::ContainsRegex("CPU ms per scan +4000.0 +4400.0 +10.0 +9.0  REGRESSION"),
                  testing::ContainsRegex("most memory, MiB .* warning"),
                  testing::HasSubstr("new CPU ms per scan as on the baseline's machine, by the "
                                     "calibrations: times 2.00")));
  const auto told = gate_checks(result);
  ASSERT_EQ(told.size(), 3U);
  EXPECT_EQ(told[0].title, "CPU ms per scan grew");
  EXPECT_EQ(told[0].severity, CheckResult::Severity::kFailure);
  EXPECT_EQ(told[1].title, "most memory, MiB grew");
  EXPECT_EQ(told[1].severity, CheckResult::Severity::kWarning);
  EXPECT_TRUE(told[2].passed());
}

TEST(Gate, ComparesCpuOfOneMachineAsItWasMeasured) {
  RunCost before{4000.0, 10.0, 100.0, 1000, Machine{"a", 8, 1024.0, "Linux"}}, after = before;
  after.calibration_ms = 5.0;
  const auto growth = [&] {
    return check_costs(run_that_cost(before), run_that_cost(after), {})[0].growth();
  };
  EXPECT_EQ(growth(), 0.0) << "calibrations of one machine differ by its load";
  after.machine->processor = "b";
  EXPECT_EQ(growth(), 1.0);
}

TEST(Gate, JudgesNoCpuOfShortRunsAndNoBytesOfOtherFiles) {
  RunCost before{400.0, 10.0, 100.0, 1000, {}, {"labels"}}, after = before;
  after.core_ms_per_scan = 499.0;  // of 4 scans
  after.bytes_written = 2000;
  after.what_written.emplace_back("scores");
  const CostLimits limits = cost_limits("--max-cost", "cpu=1,bytes=1");
  const auto checks = check_costs(run_that_cost(before), run_that_cost(after), limits);
  ASSERT_EQ(checks.size(), 3U);
  EXPECT_EQ(checks[0].unjudged, "too short to judge: 2.0 s of CPU, expected at least 2 s");
  EXPECT_EQ(checks[2].unjudged, "not compared: labels before, labels, scores now");
  const GateResult result{GateRule::kMaxDrop, {}, checks};
  EXPECT_TRUE(result.passed());
  const Answer answer{.standing = Standing{.simulated = true, .doubts = {"one", "two"}},
                      .sheets = {cost_sheet(result)},
                      .checks = gate_checks(result)};
  EXPECT_THAT(render(answer, Format::kText),
              testing::ContainsRegex("CPU ms per scan +400.0 +499.0 .* not judged"));
  EXPECT_THAT(render(answer, Format::kGithub),
              testing::HasSubstr("::warning title=CPU ms per scan not judged::too short to judge: "
                                 "2.0 s of CPU, expected at least 2 s [SIMULATED data: not "
                                 "comparable with published numbers; one; and 1 more]\n"));
  EXPECT_THAT(
      render(answer, Format::kJunit),
      testing::AllOf(testing::HasSubstr("tests=\"3\" failures=\"0\" errors=\"0\" skipped=\"2\""),
                     testing::HasSubstr("<skipped message=\"CPU ms per scan not judged: ")));
  after.core_ms_per_scan = 501.0;
  EXPECT_FALSE(check_costs(run_that_cost(before), run_that_cost(after), limits)[0].passed());
}

TEST(Gate, JudgesNoCpuOfAProgramThatAnOlderMosbenchMeasured) {
  const Machine machine{"a", 8, 1024.0, "Linux"};
  ResultSet before = run_that_cost({4000.0, 10.0, 100.0, 1000});
  ResultSet after = run_that_cost({8000.0, 10.0, 100.0, 2000, machine});
  for (ResultSet* run : {&before, &after}) run->sequences[0].kind = "exec";
  const GateResult result{GateRule::kMaxDrop, {}, check_costs(before, after, {})};
  ASSERT_EQ(result.costs.size(), 3U);
  EXPECT_EQ(result.costs[0].unjudged, "measured by an older mosbench");
  EXPECT_FALSE(result.costs[2].is_within());
  const auto json = to_json(result).at("costs");
  EXPECT_EQ(json.at(0).at("passed"), nullptr);
  EXPECT_EQ(json.at(2).at("passed"), false);
  EXPECT_THAT(render({.sheets = {cost_sheet(result)}}, Format::kText),
              testing::ContainsRegex("CPU ms per scan .* not judged"));
  EXPECT_EQ(gate_checks(result).size(), 2U) << "nobody asked for the CPU";
  after.sequences[0].cost->core_ms_per_scan.reset();  // of a run that did not take it
  before.sequences[0].cost->machine = machine;
  EXPECT_EQ(check_costs(before, after, {}).at(0).unjudged, "measured by an older mosbench");
  EXPECT_EQ(check_costs(before, after, {}).at(1).unjudged, "");
}

TEST(Gate, ComparesCpuPerScanAloneWhereScansDiffer) {
  const ResultSet all = run_that_cost({40.0, 10.0, 100.0, 1000});
  ResultSet part = run_that_cost({40.0, 10.0, 50.0, 500});
  part.sequences[0].scans.resize(2);
  for (const auto& checks : {check_costs(all, part, {}), check_costs(part, all, {})}) {
    ASSERT_EQ(checks.size(), 1U);
    EXPECT_EQ(checks[0].kind->key, "cpu");
    EXPECT_NEAR(checks[0].growth(), 0.0, 1e-12);
  }
}

TEST(Gate, ComparesNoCpuWithoutACalibrationAndNoCostThatIsNotKnown) {
  const ResultSet known = run_that_cost({40.0, 10.0, 100.0, 1000});
  const ResultSet old = run_that_cost({40.0, std::nullopt, 100.0, 1000});
  ASSERT_EQ(check_costs(old, known, {}).size(), 2U);
  EXPECT_EQ(check_costs(old, known, {})[0].kind->key, "memory");
  ResultSet untimed = known;
  untimed.sequences[0].cost.reset();
  EXPECT_TRUE(check_costs(untimed, known, {}).empty());
  for (const char* wrong :
       {"", "cpu=1,", "cpu", "cpu=", "cpu=x", "cpu=nan", "cpu=-1", "gpu=3", "cpu=10,cpu=1000"}) {
    EXPECT_THROW(cost_limits("--max-cost", wrong), UsageError) << wrong;
  }
}

TEST(Gate, SaysWhyThereIsNoInterval) {
  const Confusion counts{.tp = 1};
  const PairedRuns paired{{{"street", "0", nullptr, nullptr}}, {{counts}}, {{counts}}, {}};
  const GateResult result =
      judge(paired, protocol_named("sipailou"), {0.005, GateRule::kStatistical});
  EXPECT_TRUE(result.passed());
  EXPECT_THAT(render({.sheets = {gate_sheet(result)}}, Format::kText),
              testing::HasSubstr("no interval for street: 1 scans, expected at least 100"));
  EXPECT_EQ(to_json(result).at("checks").at(0).at("low"), nullptr);
}

TEST(Gate, EscapesNamesInAnnotationsAndMarkdown) {
  const Confusion right{.tp = 1}, wrong{.fp = 1, .fn = 1}, nothing{.tn = 1};
  const std::string name = "day|50%: a,\nb";
  const auto judged = [&](const Confusion& first, const Confusion& second) {
    const PairedRuns paired{{{name, "0", nullptr, nullptr}}, {{first}}, {{second}}, {}};
    return judge(paired, protocol_named("sipailou"), {0.005});
  };
  const auto shown = [](const GateResult& result, Format format) {
    return render({.sheets = {gate_sheet(result)}, .checks = gate_checks(result)}, format);
  };
  EXPECT_THAT(shown(judged(right, wrong), Format::kGithub),
              testing::EndsWith("\n::error title=IoU of day|50%25%3A a%2C%0Ab dropped::100.0 %25 "
                                "before, 0.0 %25 now: -100.00 points, tolerance 0.50\n"));
  EXPECT_THAT(shown(judged(wrong, nothing), Format::kGithub),
              testing::EndsWith("\n::error title=IoU of day|50%25%3A a%2C%0Ab dropped::0.0 %25 "
                                "before, undefined now\n"));
  EXPECT_TRUE(gate_checks(judged(right, right)).at(0).passed());
  EXPECT_THAT(shown(judged(right, wrong), Format::kMarkdown),
              testing::HasSubstr("\n| day\\|50%: a,\\\\x0ab | 100.0 | 0.0 | -100.00 |"));
}

}  // namespace
}  // namespace mosbench
