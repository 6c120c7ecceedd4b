#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/answer/render.hpp"
#include "eval/engine/study_plan.hpp"
#include "eval/engine/study_run.hpp"
#include "eval/job/method_choice.hpp"
#include "eval/job/study_file.hpp"
#include "eval/result/result_file.hpp"
#include "eval/result/version.hpp"
#include "eval/study/study_table.hpp"
#include "eval/tables/leaderboard.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;
using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* kSmallStudy = R"(name: small
protocol: semantickitti-mos
data:
  - name: room
    simulate: {layout: semantickitti, scene: room, scans: 6, seed: [1, 2]}
methods:
  - hmm-mos
  - {name: near, method: underwood, set: {max_range_m: 15}}
disturb:
  - {kind: pose_noise_m, strengths: [0, 0.05, 0.1]}
  - {kind: mount_tilt_deg, strengths: [1]}
seeds: [1, 2, 3]
)";

std::string replaced_in(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

std::string without_disturbances() {
  const std::string text = kSmallStudy;
  return text.substr(0, text.find("disturb:"));
}

std::string study_error(const std::string& text) {
  return message_of<UsageError>([&] { parse_study(text, "s.yaml"); });
}

std::set<std::string> keys_of(const StudyPlan& plan) {
  std::set<std::string> keys;
  for (const PlannedCell& planned : plan.cells) keys.insert(planned.cell.key);
  return keys;
}

TEST(StudyFile, IsReadAsItIsWritten) {
  const Study study = parse_study(kSmallStudy, "s.yaml");
  ASSERT_EQ(study.data.size(), 2u);
  EXPECT_EQ(study.data[1].name, "room-2");
  EXPECT_EQ(study.data[1].data.simulation->seed, 2u);
  const SettingChange near{"max_range_m", 15.0};
  EXPECT_EQ(study.methods[1].segment.changes, std::vector<SettingChange>{near});
  EXPECT_EQ(study.axes[0].values, (std::vector<std::string>{"0", "0.05", "0.1"}));
  EXPECT_EQ(study.seeds, (std::vector<std::uint64_t>{1, 2, 3}));
}

TEST(StudyFile, IsRefusedWithTheLineOfTheFault) {
  const auto error = [](const std::string& what, const std::string& by) {
    return study_error(replaced_in(kSmallStudy, what, by));
  };
  EXPECT_THAT(error("seeds:", "seed:"), AllOf(StartsWith("s.yaml:12: key \"seed\" is not known"),
                                              HasSubstr("nearest: seeds")));
  EXPECT_THAT(error("scans: 6", "scan: 6"), StartsWith("s.yaml:5: key \"scan\" is not known"));
  EXPECT_THAT(error(", scans: 6", ""), StartsWith("s.yaml:5: key \"scans\" is missing"));
  EXPECT_THAT(error("scans: 6", "scans: many"), StartsWith("s.yaml:5: \"many\" is no number"));
  EXPECT_THAT(error("scene: room", "scene: attic"), StartsWith("s.yaml:5: "));
  EXPECT_THAT(error("hmm-mos", "hmm-moss"),
              AllOf(StartsWith("s.yaml:7: "), HasSubstr("nearest: hmm-mos")));
  EXPECT_THAT(error("max_range_m", "max_range"),
              AllOf(StartsWith("s.yaml:8: "), HasSubstr("nearest: max_range_m")));
  EXPECT_THAT(error("0.05", "-1"), StartsWith("s.yaml:10: perturb: pose_noise_m"));
  EXPECT_THAT(error("pose_noise_m", "pose_noise"), HasSubstr("nearest: pose_noise_m"));
  EXPECT_THAT(error("semantickitti-mos", "kitti"), StartsWith("s.yaml:2: "));
  EXPECT_THAT(error("name: near", "name: hmm-mos"), HasSubstr("given twice"));
  EXPECT_THAT(error("name: near", "name: ../near"), HasSubstr("is no name"));
  EXPECT_THAT(error("seeds: [1, 2, 3]", "seeds: []"), StartsWith("s.yaml:12: is an empty list"));
  EXPECT_THAT(error("seeds: [1, 2, 3]", "name: again"), HasSubstr("\"name\" is given twice"));
  EXPECT_THAT(error("{max_range_m: 15}", "{max_range_m: 15, max_range_m: 9}"),
              AllOf(StartsWith("s.yaml:8: "), HasSubstr("\"max_range_m\" is given twice")));
  EXPECT_THAT(error("strengths: [1]", "strengths: [1], with: {beams_of: 32}"),
              AllOf(StartsWith("s.yaml:11: "), HasSubstr("beams_of is given, but nothing")));
  EXPECT_THAT(error("seeds: [1, 2, 3]", "sample: {points: 8, settings: {}}"),
              AllOf(StartsWith("s.yaml:12: "), HasSubstr("is an empty map")));
  EXPECT_THAT(error("name: near", "name: ' '"), HasSubstr("is no name"));
  EXPECT_THAT(study_error("name: [1"), StartsWith("s.yaml:"));
  EXPECT_THAT(study_error(""), HasSubstr("is no map"));
  EXPECT_THAT(study_error("- 1"), HasSubstr("is no map"));
}

TEST(StudyFile, DisturbsByOneKindAtATime) {
  const auto error = [](const std::string& what, const std::string& by) {
    return study_error(replaced_in(kSmallStudy, what, by));
  };
  EXPECT_THAT(error("kind: pose_noise_m", "kind: seed"),
              AllOf(StartsWith("s.yaml:10: "), HasSubstr("\"seed\" is not known")));
  EXPECT_THAT(error("kind: pose_noise_m", "kind: \"pose_noise_m=1,rain_mm_per_h\""),
              HasSubstr("is not known"));
  EXPECT_THAT(error("0.05", "\"0.05,rain_mm_per_h=3\""),
              StartsWith("s.yaml:10: \"0.05,rain_mm_per_h=3\" is more than one value"));
  EXPECT_THAT(error("strengths: [1]", "strengths: [1], with: {beams_of: \"64,beams=32\"}"),
              StartsWith("s.yaml:11: \"64,beams=32\" is more than one value"));
}

TEST(StudyFile, MayNameAllMethods) {
  const std::string text = kSmallStudy;
  const Study study = parse_study(
      text.substr(0, text.find("methods:")) + "methods: [all, {name: near, method: yoon}]\n",
      "s.yaml");
  const auto all = chosen_methods("all").names;
  ASSERT_EQ(study.methods.size(), all.size() + 1);
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(study.methods[i].name, all[i]);
  EXPECT_EQ(study.methods.back().name, "near");
}

TEST(StudyFile, ReadsDataWithEveryFlagOfARun) {
  const std::string from = "seed: [1, 2]}";
  const std::string plain =
      replaced_in(kSmallStudy, from, from + "\n    reading: {hdl64_correction: true}");
  EXPECT_TRUE(parse_study(plain, "s.yaml").data.front().data.reading.hdl64_correction);
  EXPECT_THAT(
      study_error(replaced_in(plain, "true", "maybe")),
      StartsWith("s.yaml:6: hdl64_correction: 'maybe' is not understood, expected on or off"));
}

TEST(StudyFile, IsOneDocument) {
  EXPECT_THAT(study_error(std::string(kSmallStudy) + "---\nname: second\n"),
              HasSubstr("has 2 YAML documents"));
}

TEST(StudyPlan, RefusesSequencesThatASimulationDoesNotWrite) {
  const Study study = parse_study(
      replaced_in(kSmallStudy, "name: room", "name: room\n    sequences: [09]"), "s.yaml");
  EXPECT_THAT(message_of<UsageError>([&] { plan_study(study, "/nowhere"); }),
              HasSubstr("simulates no sequence \"09\", expected 08"));
}

TEST(StudyPlan, RefusesOneRunUnderTwoNames) {
  const auto error = [](const std::string& what, const std::string& by) {
    const Study study = parse_study(replaced_in(kSmallStudy, what, by), "s.yaml");
    return message_of<UsageError>([&] { plan_study(study, "/nowhere"); });
  };
  EXPECT_THAT(error("- hmm-mos", "- hmm-mos\n  - {name: twin, method: hmm-mos}"),
              HasSubstr("\"room-1 08, hmm-mos\" and \"room-1 08, twin\" are the same run"));
  EXPECT_THAT(error("methods:",
                    "  - name: twin\n    simulate: {layout: semantickitti, scene: room, scans: 6, "
                    "seed: 2}\nmethods:"),
              HasSubstr("\"room-2 08, hmm-mos\" and \"twin 08, hmm-mos\" are the same run"));
}

TEST(StudyPlan, HoldsEveryCombinationOnce) {
  const Study study = parse_study(kSmallStudy, "s.yaml");
  const StudyPlan plan = plan_study(study, "/nowhere");
  // Each of two sequences and two methods: plain, three strengths by three seeds, one tilt.
  EXPECT_EQ(plan.cells.size(), 2u * 2u * (1 + 3 * 3 + 1));
  EXPECT_EQ(keys_of(plan).size(), plan.cells.size());
  for (const PlannedCell& planned : plan.cells) EXPECT_EQ(planned.state, CellState::kMissing);
  EXPECT_EQ(plan.cells[2].cell.title(), "room-1 08, hmm-mos, pose_noise_m=0, seed 2");
}

TEST(StudyPlan, KeepsTheKeysOfWhatDidNotChange) {
  const auto keys = [](const std::string& text) {
    const Study study = parse_study(text, "s.yaml");
    return keys_of(plan_study(study, "/nowhere"));
  };
  const std::set<std::string> before = keys(kSmallStudy);
  const auto shared = [&](const std::string& what, const std::string& by) {
    std::size_t same = 0;
    for (const std::string& key : keys(replaced_in(kSmallStudy, what, by)))
      same += before.count(key);
    return same;
  };
  EXPECT_EQ(shared("name: small", "name: other"), 44u);
  EXPECT_EQ(shared("name: near", "name: far"), 44u);  // a name in tables decides no result
  EXPECT_EQ(shared("[0, 0.05, 0.1]", "[0, 0.05, 0.2]"), 44u - 12u);
  EXPECT_EQ(shared("max_range_m: 15", "max_range_m: 16"), 22u);
  EXPECT_EQ(shared("seed: [1, 2]", "seed: [1, 3]"), 22u);
  EXPECT_EQ(shared("semantickitti-mos", "sipailou"), 0u);
  EXPECT_EQ(shared("scans: 6", "scans: 7"), 0u);
}

TEST(StudyPlan, KnowsACellByItsValuesAndNotByTheirWords) {
  const auto keys = [](const std::string& method) {
    const Study study =
        parse_study(replaced_in(without_disturbances(), "- hmm-mos", method), "s.yaml");
    return keys_of(plan_study(study, "/nowhere"));
  };
  const auto whole = keys("- {name: far, method: hmm-mos, set: {max_range_m: 30}}");
  EXPECT_EQ(keys("- {name: far, method: hmm-mos, set: {max_range_m: 30.0}}"), whole);
  EXPECT_EQ(keys("- {name: far, method: hmm-mos, set: {max_range_m: 3e1}}"), whole);
  EXPECT_NE(keys("- {name: far, method: hmm-mos, set: {max_range_m: 31}}"), whole);
  const auto preset = keys("- {name: far, method: hmm-mos, preset: doals-20m}");
  EXPECT_NE(preset, whole);
  EXPECT_EQ(keys("- {name: far, method: hmm-mos, set: {voxel_size_m: 0.20, min_range_m: 0.5, "
                 "max_range_m: 20, delay_scans: 0}}"),
            preset)
      << "a preset and its values are one";
}

TEST(StudyPlan, ShowsOneResultAtEachValueThatMeansIt) {
  const Study study = parse_study(replaced_in(without_disturbances(), "seed: [1, 2]", "seed: 1") +
                                      "vary: {setting: max_range_m, values: [50, 9]}\n",
                                  "s.yaml");
  StudyPlan plan = plan_study(study, "/nowhere");
  EXPECT_EQ(plan.cells.size(), 2U * 3);
  EXPECT_EQ(keys_of(plan).size(), 5U) << "50 m is the usual range of hmm-mos";
  EXPECT_EQ(work_of(plan, {}).cells.size(), 5U);
}

TEST(StudyPlan, ComputesAgainWhatAChangedProgramLabelled) {
  const TempFolder folder;
  const std::string text = replaced_in(kSmallStudy, "- hmm-mos",
                                       fmt::format("- {{name: ours, method: \"exec:sh '{}' -x\"}}",
                                                   folder.write("our method.sh", "1").string()));
  const Study study = parse_study(text, "s.yaml");
  const std::set<std::string> before = keys_of(plan_study(study, "/nowhere"));
  EXPECT_EQ(keys_of(plan_study(study, "/nowhere")), before);
  folder.write("our method.sh", "2");
  std::size_t same = 0;
  for (const std::string& key : keys_of(plan_study(study, "/nowhere"))) same += before.count(key);
  EXPECT_EQ(same, before.size() / 2) << "of the other method";
}

TEST(StudyPlan, KnowsTheCostOfACellByWhatItIs) {
  const auto cost_key = [](const std::string& what, const std::string& by) {
    const Study study = parse_study(replaced_in(kSmallStudy, what, by), "s.yaml");
    return plan_study(study, "/nowhere").cells.back().cell.cost_key;
  };
  const std::string before = cost_key("name: small", "name: small");
  EXPECT_EQ(cost_key("strengths: [1]", "strengths: [2]"), before);
  EXPECT_EQ(cost_key("semantickitti-mos", "sipailou"), before);
  EXPECT_NE(cost_key("scans: 6", "scans: 600"), before);
  EXPECT_NE(cost_key("max_range_m: 15", "max_range_m: 50"), before);
  EXPECT_NE(cost_key("method: underwood, set: {max_range_m: 15}", "method: yoon"), before);
}

/// Says of a cell what it would if it had been computed.
void mark_done(PlannedCell& planned, double iou, double ms) {
  const auto moving = static_cast<std::uint64_t>(std::llround(1000 * iou));
  planned.state = CellState::kDone;
  planned.numbers = {.version = std::string(kMosbenchVersion),
                     .simulated = true,
                     .simulation = {},
                     .fingerprint = {},
                     .counts = {Confusion{.tp = moving, .fp = 1000 - moving}},
                     .gaps = {},
                     .metrics = {iou, 0.5, std::nullopt},
                     .ms_per_scan = ms,
                     .wall_s = 1.0,
                     .core_s = 36.0,
                     .worst = BadScan{"000003", iou / 2, 1}};
}

/// The result of a cell without scans.
Result result_of(const StudyPlan& plan, const StudyCell& cell, const std::string& version) {
  Result result;
  result.key = cell.key;
  result.sequence = SequenceName(cell.sequence, plan.out);
  result.dataset = "semantickitti";
  result.method = "HMM-MOS";
  result.kind = "hmm-mos";
  result.settings = RecordedSettings(default_method().defaults);
  result.protocol = &protocol_named("semantickitti-mos");
  result.range = result.protocol->default_range;
  result.from.version = version;
  return result;
}

/// Writes the result of a cell as if it had been computed.
void write_result(const StudyPlan& plan, const StudyCell& cell, const std::string& version) {
  Result result = result_of(plan, cell, version);
  ScanRow& row = result.scans.emplace_back();
  row.stem = "000000";
  row.points = 6;
  row.predicted_moving_points = 3;
  row.counts = Confusion{.tp = 2, .fp = 1, .fn = 1, .tn = 2};
  write_file_atomic(cell_folder(plan.out, cell.key) / "result.json", format_result(result));
}

/// The two methods on three scenes.
std::string three_scenes() {
  std::string scenes;
  for (const char* scene : {"room", "mall", "street"}) {
    scenes += fmt::format(
        "  - name: {0}\n    simulate: {{layout: semantickitti, scene: {0}, scans: 6, seed: 1}}\n",
        scene);
  }
  const std::string text = without_disturbances();
  return text.substr(0, text.find("  - name: room")) + scenes + text.substr(text.find("methods:"));
}

TEST(StudyTable, HasMeansRanksAndTheParetoFront) {
  const TempFolder folder;
  const Study study =
      parse_study(replaced_in(three_scenes(), "- hmm-mos", "- hmm-mos\n  - yoon"), "s.yaml");
  StudyPlan plan = plan_study(study, folder.path());
  ASSERT_EQ(plan.cells.size(), 9u);
  // hmm-mos, yoon, near on three sequences
  const double ious[] = {0.8, 0.6, 0.4, 0.6, 0.6, 0.2, 0.7, 0.6, 0.3};
  for (std::size_t i = 0; i < 9; ++i) mark_done(plan.cells[i], ious[i], i % 3 ? 40 : 20);
  const StudyTable table = gather(plan);
  ASSERT_EQ(table.rows.size(), 3u);
  const StudyMean& mean = table.rows[0].metrics[0];
  EXPECT_NEAR(*mean.value, 0.7, 1e-12);
  EXPECT_THAT(mean.no_interval, StartsWith("3 scans, expected at least")) << "of one seed";
  EXPECT_FALSE(table.rows[0].to_best) << "it is the best";
  EXPECT_NEAR(*table.rows[2].to_best->value, -0.4, 1e-12);
  EXPECT_NEAR(*table.rows[0].rank, (1 + 1.5 + 1) / 3, 1e-12);  // first, first beside the second
  EXPECT_NEAR(*table.rows[1].rank, (2 + 1.5 + 2) / 3, 1e-12);
  EXPECT_EQ(*table.rows[2].rank, 3);
  EXPECT_NEAR(*table.critical_difference, 2.343 * std::sqrt(3.0 * 4 / (6 * 3)), 1e-12);
  EXPECT_TRUE(table.rows[0].is_on_front);
  EXPECT_FALSE(table.rows[1].is_on_front);
  EXPECT_NEAR(*table.core_s, 9 * 36.0, 1e-12);
  EXPECT_TRUE(table.simulated);
  EXPECT_EQ(table.worst.front().iou, 0.3);
  const Answer answer = study_answer(plan, table);
  EXPECT_THAT(render(answer, Format::kText),
              AllOf(HasSubstr("SIMULATED data"), HasSubstr("70.0    ")));
  const std::string latex = render(answer, Format::kLatex);
  EXPECT_THAT(latex, HasSubstr("\\begin{tabular}{lrrrrrrr}"));
  EXPECT_THAT(latex, testing::Not(HasSubstr("\n\n\\hline"))) << "does not compile";
  EXPECT_THAT(render(answer, Format::kHtml), HasSubstr("\"name\":\"small\""));
}

TEST(StudyTable, TellsTheCommandOfAWorstScanWithAllThatTheStudySays) {
  const TempFolder folder;
  std::string text = replaced_in(kSmallStudy, "semantickitti-mos", "mapmos\nrange_m: [1, 20]");
  text = replaced_in(text, "name: room", "name: room\n    reading: {deskew: none}");
  const Study study = parse_study(text, "s.yaml");
  StudyPlan plan = plan_study(study, folder.path());
  mark_done(plan.cells.back(), 0.5, 1);
  const StudyTable table = gather(plan);
  ASSERT_EQ(table.worst.size(), 1u);
  EXPECT_THAT(
      table.worst.front().command,
      HasSubstr(" --dataset semantickitti --sequences 08 --deskew none --perturb "
                "mount_tilt_deg=1,seed=0 --method underwood --protocol mapmos --range 1,20 --set "
                "max_range_m=15 --out "));
}

/// Scans of which no two count alike.
Result many_scans(const StudyPlan& plan, const StudyCell& cell, std::uint64_t scans) {
  Result result = result_of(plan, cell, std::string(kMosbenchVersion));
  result.method = cell.label();
  result.sequence = SequenceName(cell.data->name, plan.out);
  for (std::uint64_t k = 0; k < scans; ++k) {
    ScanRow& row = result.scans.emplace_back();
    row.stem = fmt::format("{:06}", k);
    row.truth_hash.emplace();
    const std::uint64_t wrong = k * (scans + cell.label().size()) % 7;
    row.counts = Confusion{.tp = 40 + k % 11 + wrong, .fp = wrong, .fn = k % 3, .tn = 2};
  }
  return result;
}

TEST(StudyTable, SaysOfOneSeedWhatRankSays) {
  const TempFolder folder;
  const Study study = parse_study(three_scenes(), "s.yaml");
  StudyPlan plan = plan_study(study, folder.path());
  std::vector<ResultSet> runs(2);
  for (std::size_t i = 0; i < plan.cells.size(); ++i) {
    const Result result = many_scans(plan, plan.cells[i].cell, 120 + 100 * (i / 2));
    plan.cells[i].state = CellState::kDone;
    plan.cells[i].numbers = numbers_of(result);
    runs[i % 2].sequences.push_back(result);
  }
  for (ResultSet& run : runs) std::ranges::sort(run.sequences, {}, &Result::sequence);
  const StudyTable table = gather(plan);
  const Leaderboard board = leaderboard_of(runs, RowOrder::kGiven);
  ASSERT_EQ(table.rows.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(table.rows[i].label, runs[i].front().method);
    for (std::size_t m = 0; m < kBriefMetrics.size(); ++m) {
      const Estimate& ranked = (*board.rows[i].all)[kBriefMetrics[m]];
      EXPECT_EQ(table.rows[i].metrics[m].value.value(), ranked.value.value());
      EXPECT_EQ(table.rows[i].metrics[m].interval.value(), ranked.interval.value());
    }
  }
  const Estimate& to_first = *board.rows[1].to_first;
  ASSERT_NE(to_first.value.value(), 0.0);
  const StudyRow& worse = table.rows[*to_first.value < 0 ? 1 : 0];
  EXPECT_DOUBLE_EQ(worse.to_best->value.value(), -std::abs(*to_first.value));
}

TEST(StudyTable, SaysTheMeanAndTheSpreadOfSeeds) {
  const TempFolder folder;
  const Study study = parse_study(
      replaced_in(
          kSmallStudy,
          "methods:\n  - hmm-mos\n  - {name: near, method: underwood, set: {max_range_m: 15}}\n",
          "  - name: mall\n    simulate: {layout: semantickitti, scene: mall, scans: 6, seed: 1}\n"
          "methods: hmm-mos\n"),
      "s.yaml");
  StudyPlan plan = plan_study(study, folder.path());
  const std::map<std::string, double> ious = {{"room-1", 0.2}, {"room-2", 0.4}, {"mall", 0.7}};
  for (PlannedCell& planned : plan.cells) {
    const double seed = static_cast<double>(planned.cell.seed);
    mark_done(planned, ious.at(planned.cell.data->name) + 0.01 * seed, 1);
  }
  const StudyTable table = gather(plan);
  const StudyMean& mean = table.curves[0].metrics[0][2][0];
  EXPECT_EQ(mean.seeds, 6u) << "of the room; the three of the mall stand for it twice";
  EXPECT_NEAR(*mean.value, 0.52, 1e-12);
  // t of five degrees of freedom at 97.5 % is 2.5706; seeds are 0.46, 0.47, 0.48, 0.56, 0.57, 0.58.
  EXPECT_NEAR(mean.interval->high - *mean.value, 2.5706 * std::sqrt(0.0154 / 5 / 6), 1e-6);
  EXPECT_THAT(render(study_answer(plan, table), Format::kText), HasSubstr("52.0 +- 5.8"));
  EXPECT_EQ(table.curves[0].values, (std::vector<std::string>{"none", "0", "0.05", "0.1"}));
}

TEST(StudyTable, SaysWhosePresetASettingThatIsNotVariedIsOf) {
  const TempFolder folder;
  const Study study = parse_study(
      without_disturbances() + "vary: {setting: voxel_size_m, values: [0.2]}\n", "s.yaml");
  EXPECT_EQ(gather(plan_study(study, folder.path())).curves[0].values,
            (std::vector<std::string>{"default of preset semantickitti", "0.2"}));
}

/// Two data whose own protocols differ, and a study that names none.
std::string study_of_two_protocols() {
  std::string text = replaced_in(without_disturbances(), "protocol: semantickitti-mos\n", "");
  return replaced_in(text, "methods:",
                     "  - name: boxes\n    simulate: {layout: nuscenes, scene: room, scans: 6, "
                     "seed: 1}\nmethods:");
}

std::string plan_error(const std::string& text) {
  const Study study = parse_study(text, "s.yaml");
  return message_of<UsageError>([&] { plan_study(study, "/nowhere"); });
}

TEST(StudyScoring, RefusesDataOfDifferentProtocols) {
  const std::string text = study_of_two_protocols();
  EXPECT_EQ(plan_error(text),
            "s.yaml: averages what different rules count: \"room-1\", \"room-2\" by "
            "semantickitti-mos; \"boxes\" by mapmos-nuscenes (from 3 m), expected the same "
            "for all: give the key \"protocol:\", as `protocol: semantickitti-mos`, or make a "
            "study of each");
  EXPECT_EQ(plan_error("protocol: mapmos\n" + text), "nothing thrown");
}

TEST(StudyScoring, RefusesMethodsWhosePresetsDiffer) {
  std::string text = replaced_in(without_disturbances(), "protocol: semantickitti-mos\n", "");
  EXPECT_EQ(plan_error(text), "nothing thrown");
  text = replaced_in(text, "name: near,", "name: near, preset: sipailou,");
  EXPECT_THAT(plan_error(text), AllOf(HasSubstr("\"room-1, hmm-mos\""), HasSubstr("by sipailou"),
                                      HasSubstr("\"room-2, near\"")));
}

TEST(StudyScoring, RefusesRangesThatAMethodsSettingsChoose) {
  const std::string text = replaced_in(without_disturbances(), "semantickitti-mos", "doals-hmm");
  EXPECT_THAT(plan_error(text), AllOf(HasSubstr("by doals-hmm (1.5 to 50 m)"),
                                      HasSubstr("by doals-hmm (1.5 to 15 m)"),
                                      HasSubstr("give the key \"range_m:\"")));
  EXPECT_EQ(plan_error(text + "range_m: [1, 10]\n"), "nothing thrown");
  EXPECT_THAT(plan_error(replaced_in(text, ", set: {max_range_m: 15}", "") +
                         "vary: {setting: max_range_m, values: [9]}\n"),
              HasSubstr("\"room-1, hmm-mos, max_range_m=9\""));
}

TEST(StudyScoring, IsNamedInEveryTable) {
  const TempFolder folder;
  const Study study = parse_study(
      replaced_in(without_disturbances(), "semantickitti-mos", "mapmos\nrange_m: [1, 20]"),
      "s.yaml");
  StudyPlan plan = plan_study(study, folder.path());
  mark_done(plan.cells[0], 0.5, 1);
  const StudyTable table = gather(plan);
  const Answer answer = study_answer(plan, table);
  EXPECT_THAT(render(answer, Format::kText),
              AllOf(HasSubstr("protocol mapmos: pooled; "), HasSubstr("(1 to 20 m)")));
  EXPECT_THAT(render(answer, Format::kLatex),
              HasSubstr("\\multicolumn{8}{l}{protocol mapmos (1 to 20 m); INCOMPLETE: 3 cells are "
                        "missing}"));
  EXPECT_THAT(render(answer, Format::kCsv),
              AllOf(HasSubstr("state,protocol,min_range_m,max_range_m,iou"),
                    HasSubstr(",done,mapmos,1,20,0.5,")));
  const ordered_json json = to_json(table);
  EXPECT_EQ(json.at("protocol"), "mapmos");
  EXPECT_EQ(json.at("min_range_m"), 1.0);
  EXPECT_EQ(json.at("max_range_m"), 20.0);
}

TEST(StudyTable, SaysADoubtOncePerKindAndAtItsRows) {
  const TempFolder folder;
  const Study study = parse_study(without_disturbances(), "s.yaml");
  StudyPlan plan = plan_study(study, folder.path());
  for (PlannedCell& planned : plan.cells) mark_done(planned, 0.5, 1);
  for (const std::size_t near : {1U, 3U}) {
    ASSERT_EQ(plan.cells[near].cell.label(), "near");
    plan.cells[near].numbers.doubts = {fmt::format("{} scans are odd", near)};
  }
  const StudyTable table = gather(plan);
  ASSERT_EQ(table.doubts.size(), 1U);
  EXPECT_THAT(table.doubts[0], testing::EndsWith(": ... scans are odd"));
  const Answer answer = study_answer(plan, table);
  const std::string latex = render(answer, Format::kLatex);
  EXPECT_THAT(latex, testing::ContainsRegex("\nhmm-mos & [^$]*\nnear & [^\n]*\\$\\^\\{a\\}\\$"));
  EXPECT_THAT(latex, HasSubstr("{$^{a}$ ... scans are odd}"));
  EXPECT_THAT(render(answer, Format::kCsv),
              testing::ContainsRegex("\n[^\n]*near[^\n]*published numbers; 3 scans are odd\n"));
}

TEST(StudyTable, SaysNumbersOfADoubtWhereTheyAreOfAllItsCells) {
  const TempFolder folder;
  const Study study = parse_study(without_disturbances(), "s.yaml");
  StudyPlan plan = plan_study(study, folder.path());
  mark_done(plan.cells[0], 0.5, 1);
  mark_done(plan.cells[1], 0.5, 1);
  plan.cells[0].numbers.doubts = {"disturbed by pose_noise_m=0.05,seed=1"};
  plan.cells[1].numbers.doubts = plan.cells[0].numbers.doubts;
  EXPECT_THAT(gather(plan).doubts,
              testing::ElementsAre(testing::EndsWith(": disturbed by pose_noise_m=0.05,seed=1")));
  plan.cells[1].numbers.doubts = {"disturbed by pose_noise_m=0.5,seed=1"};
  const Answer answer = study_answer(plan, gather(plan));
  EXPECT_THAT(render(answer, Format::kText),
              AllOf(HasSubstr(": disturbed by pose_noise_m=...,seed=..."),
                    testing::Not(HasSubstr("0.05"))));
}

TEST(StudyTable, SaysWhatIsOfNoRowAtEachRowOfCsvAndBelowEachTableOfLatex) {
  const TempFolder folder;
  const Study study = parse_study(without_disturbances(), "s.yaml");
  StudyPlan plan = plan_study(study, folder.path());
  mark_done(plan.cells[0], 0.5, 1);
  plan.cells[0].numbers.doubts = {"3 scans are odd"};
  StudyTable table = gather(plan);
  table.doubts.emplace_back("another seed of the scene is judged");
  const Answer answer = study_answer(plan, table);
  const std::string of_all = "another seed of the scene is judged; INCOMPLETE: 3 cells are missing";
  EXPECT_THAT(render(answer, Format::kCsv),
              AllOf(testing::ContainsRegex(",done,[^\n]*3 scans are odd; " + of_all + "\n"),
                    testing::ContainsRegex(",missing,[^\n]*," + of_all + "\n")));
  EXPECT_THAT(render(answer, Format::kLatex),
              AllOf(HasSubstr("{$^\\dagger$ another seed of the scene is judged}"),
                    HasSubstr("{$^\\dagger$ INCOMPLETE: 3 cells are missing}"),
                    testing::Not(HasSubstr("dagger$ room-1"))));
}

TEST(StudyTable, SaysWhyAMeanIsUndefined) {
  const TempFolder folder;
  const Study study = parse_study(without_disturbances(), "s.yaml");
  StudyPlan done = plan_study(study, folder.path());
  mark_done(done.cells[0], 0.5, 1);  // without recall
  done.cells[1].state = CellState::kDone;
  const StudyTable table = gather(done);
  EXPECT_THAT(
      render(study_answer(done, table), Format::kText),
      AllOf(HasSubstr("\nroom-1 08, near: undefined: no scan has truth that counts\n"),
            HasSubstr("\nroom-1 08, hmm-mos: undefined recall: no point that counts moves\n")));
  EXPECT_EQ(to_json(table).at("undefined").size(), 2u);
  EXPECT_THAT(render(study_answer(done, table), Format::kCsv),
              HasSubstr("undefined: no scan has truth that counts"));
}

TEST(StudyTable, SaysWhatIsMissingAndOfAnotherVersion) {
  const TempFolder folder;
  const Study study = parse_study(without_disturbances(), "s.yaml");
  const StudyPlan plan = plan_study(study, folder.path());
  write_result(plan, plan.cells[0].cell, "0.0.1");
  const std::string& key = plan.cells[1].cell.key;
  write_file_atomic(cell_folder(folder.path(), key) / "result.json",
                    fmt::format("{{\"key\": \"{}\", \"version\": 3}}", key));
  write_result(plan, plan.cells[2].cell, std::string(kMosbenchVersion));
  const StudyPlan again = plan_study(study, folder.path());
  EXPECT_EQ(again.cells[0].state, CellState::kOtherVersion);
  EXPECT_EQ(again.cells[1].state, CellState::kMissing);
  EXPECT_EQ(again.cells[2].state, CellState::kDone);
  EXPECT_EQ(again.cells[2].numbers.metrics[0], 0.5);
  EXPECT_THAT(render(study_answer(again, gather(again)), Format::kText),
              HasSubstr("INCOMPLETE: 3 cells are missing"));
  EXPECT_EQ(work_of(again, {}).cells.size(), 3u);
}

std::string sampled_study() {
  return without_disturbances() +
         "sample:\n  points: 12\n  settings: {max_range_m: [5, 20], local_window_scans: [1, 3]}\n";
}

TEST(StudyFile, DrawsSettingsEvenlyBetweenLegalValues) {
  const Study study = parse_study(sampled_study(), "s.yaml");
  ASSERT_EQ(study.axes.size(), 1u);
  const StudyAxis& axis = study.axes[0];
  ASSERT_EQ(axis.values.size(), 12u * 3);
  EXPECT_EQ(axis.values[4], "2 max_range_m");
  std::set<int> windows;
  double sum = 0;
  for (std::size_t i = 0; i < axis.values.size(); i += 3) {
    const auto& base = axis.changes[i];
    sum += std::get<double>(base[0].value) / 12;
    EXPECT_GE(std::get<double>(base[0].value), 5);
    EXPECT_LE(std::get<double>(base[0].value), 20);
    windows.insert(std::get<int>(base[1].value));
    EXPECT_NE(axis.changes[i + 1][0].value, base[0].value);
    EXPECT_EQ(axis.changes[i + 1][1].value, base[1].value);
    EXPECT_EQ(axis.changes[i + 2][0].value, base[0].value);
  }
  EXPECT_NEAR(sum, 12.5, 2.5);
  EXPECT_EQ(windows, (std::set<int>{1, 2, 3}));
  const auto error = [](const std::string& what, const std::string& by) {
    return study_error(replaced_in(sampled_study(), what, by));
  };
  EXPECT_THAT(error("[5, 20]", "[20, 5]"), HasSubstr("expected LOWEST below HIGHEST"));
  EXPECT_THAT(error("[5, 20]", "[5]"), StartsWith("s.yaml:11: max_range_m cannot be drawn"));
  EXPECT_THAT(error("[5, 20]", "[5, many]"), StartsWith("s.yaml:11: "));
  EXPECT_THAT(error("max_range_m: [5", "max_rang_m: [5"), HasSubstr("no method has a setting"));
  EXPECT_THAT(error("points: 12", "points: 2"), StartsWith("s.yaml:10: "));
}

TEST(StudyTable, TellsHowMuchEachSampledSettingDecides) {
  const TempFolder folder;
  const Study study = parse_study(sampled_study(), "s.yaml");
  StudyPlan plan = plan_study(study, folder.path());
  for (PlannedCell& planned : plan.cells) {
    if (planned.cell.axis == nullptr) continue;
    const SettingChange& range =
        planned.cell.job.segment.changes[planned.cell.method->segment.changes.size()];
    ASSERT_EQ(range.name, "max_range_m");
    mark_done(planned, std::get<double>(range.value) / 30, 1);
  }
  const StudyTable table = gather(plan);
  ASSERT_EQ(table.effects.size(), 2u);
  EXPECT_EQ(table.effects[0].points, 12u);
  EXPECT_EQ(table.effects[0].settings,
            (std::vector<std::string>{"max_range_m", "local_window_scans"}));
  EXPECT_EQ(table.effects[0].effects[1]->index, 0);
  EXPECT_LE(table.effects[0].effects[0]->interval.low, 1);
  EXPECT_GE(table.effects[0].effects[0]->interval.high, 1);
  EXPECT_EQ(table.effects[1].settings, std::vector<std::string>{"max_range_m"})
      << "underwood has no windows";
  const Answer answer = study_answer(plan, table);
  EXPECT_THAT(render(answer, Format::kText), HasSubstr("local_window_scans  0.00 (0.00 to 0.00)"));
  EXPECT_THAT(render(answer, Format::kLatex), HasSubstr("total effect & hmm-mos & near"));
  EXPECT_THAT(render(answer, Format::kHtml),
              HasSubstr("\"effects\":[{\"label\":\"hmm-mos\",\"points\":12,"));
}

// A study of a field: its plan and its tables must not keep anyone waiting.
TEST(StudyPlan, OfTenThousandCellsIsQuick) {
  const TempFolder folder;
  std::string seeds = "1";
  for (int seed = 2; seed <= 830; ++seed) seeds += ", " + std::to_string(seed);
  const Study study =
      parse_study(replaced_in(kSmallStudy, "[1, 2, 3]", "[" + seeds + "]"), "s.yaml");
  EXPECT_EQ(plan_study(study, folder.path()).cells.size(), 4u * (1 + 3 * 830 + 1));
}

}  // namespace
}  // namespace mosbench
