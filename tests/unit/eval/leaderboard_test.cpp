#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/text/errors.hpp"
#include "eval/answer/render.hpp"
#include "eval/tables/table_print.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// `scans` scans of 1000 moving points, of which `found` plus or minus a few are; 200 scans apart.
Result scored(const std::string& name, std::size_t scans, std::uint64_t found) {
  Result result;
  result.sequence = SequenceName(name, name);
  result.file = name + "/result.json";
  result.dataset = "semantickitti";
  result.protocol = &protocol_named("semantickitti-mos");
  result.from.fingerprint = "of " + name;
  for (std::size_t k = 0; k < scans; ++k) {
    Confusion counts;
    counts.tp = found + 7 * (k % 3) - 7;
    counts.fn = 1000 - counts.tp;
    ScanRow& row = result.scans.emplace_back();
    row.stem = std::to_string(k * 200);
    row.counts = counts;
    row.truth_hash = LabelHash{};
  }
  return result;
}

ResultSet run_of(const std::string& method, std::uint64_t found, std::optional<double> ms,
                 std::size_t scans = 40) {
  ResultSet run{"runs/" + method, {scored("00", scans, found), scored("01", scans, found - 100)}};
  for (Result& sequence : run.sequences) {
    sequence.method = method;
    if (!ms) continue;
    Timing& timing = sequence.timing.emplace();
    timing.threads = 1;
    timing.costs.push_back({.push_ms = *ms, .stages_ms = {}, .resident_mib = 100.0});
  }
  return run;
}

TEST(Leaderboard, RanksByIouAndMarksTheFrontOfIouAgainstTime) {
  const std::vector<ResultSet> runs = {run_of("fast", 600, 5.0), run_of("beaten", 590, 20.0),
                                       run_of("best", 900, 50.0), run_of("twin", 600, 5.0),
                                       run_of("untimed", 700, std::nullopt)};
  const Leaderboard board = leaderboard_of(runs);
  std::vector<std::string> order, front;
  for (const LeaderboardRow& row : board.rows) {
    order.push_back(row.run->front().method);
    if (row.is_on_front) front.push_back(order.back());
  }
  EXPECT_THAT(order, ElementsAre("best", "untimed", "fast", "twin", "beaten"));
  EXPECT_THAT(front, ElementsAre("best", "fast", "twin"));
  EXPECT_THAT(board.sequences, ElementsAre("00", "01"));
  EXPECT_THAT(board.remarks, IsEmpty());
  const LeaderboardRow& best = board.rows.front();
  EXPECT_NEAR((*best.all)[Metric::kIou].value.value(), 0.85, 1e-3);
  EXPECT_NEAR((*best.sequences[1])[Metric::kIou].value.value(), 0.80, 1e-3);
  EXPECT_EQ(best.ms_per_scan, 50.0);
  EXPECT_NEAR(best.memory_mb.value(), 104.8576, 1e-9);
  EXPECT_FALSE(board.rows[1].memory_mb);
}

TEST(Leaderboard, GivesThePairedDifferenceToTheBestWithItsInterval) {
  const std::vector<ResultSet> runs = {run_of("a", 900, 1.0), run_of("b", 850, 2.0)};
  const Leaderboard board = leaderboard_of(runs);
  EXPECT_FALSE(board.rows[0].to_first);
  const Difference& difference = board.rows[1].to_first.value();
  EXPECT_NEAR(difference.value.value(), -0.05, 1e-9);
  ASSERT_TRUE(difference.interval) << difference.no_interval;
  EXPECT_LE(difference.interval->low, -0.05 + 1e-9);
  EXPECT_GE(difference.interval->high, -0.05 - 1e-9);
  EXPECT_THAT(render(leaderboard_answer(board), Format::kText), HasSubstr("-5.00  ["));
}

TEST(Leaderboard, SaysWhyThereIsNoIntervalOfADifference) {
  const std::vector<ResultSet> runs = {run_of("a", 900, 1.0, 3), run_of("b", 850, 2.0, 3)};
  const std::string text = render(leaderboard_answer(leaderboard_of(runs)), Format::kText);
  EXPECT_THAT(text, HasSubstr("-5.00  none"));
  EXPECT_THAT(text, HasSubstr("no interval of the difference of 2: 6 scans"));
}

TEST(Leaderboard, RanksNoRunThatLacksASequence) {
  std::vector<ResultSet> runs = {run_of("whole", 500, 1.0), run_of("half", 900, 2.0)};
  runs[1].sequences.pop_back();
  const Leaderboard board = leaderboard_of(runs);
  EXPECT_EQ(board.rows[1].run->front().method, "half");
  EXPECT_FALSE(board.rows[1].all);
  EXPECT_FALSE(board.rows[1].is_on_front);
  EXPECT_FALSE(board.rows[1].to_first);
  EXPECT_TRUE(board.rows[1].sequences[0]);
  EXPECT_FALSE(board.rows[1].sequences[1]);
  EXPECT_THAT(board.remarks, ElementsAre("half is not compared with whole: sequence 01: is only "
                                         "in the first run"));
}

TEST(Leaderboard, RanksNoRunThatLacksPredictions) {
  std::vector<ResultSet> runs = {run_of("whole", 500, 1.0), run_of("gaps", 900, 2.0)};
  runs[1].sequences[0].scans.pop_back();
  runs[1].sequences[0].predictions.emplace().missing = {"9"};
  const Leaderboard board = leaderboard_of(runs);
  EXPECT_EQ(board.rows[1].run->front().method, "gaps");
  EXPECT_FALSE(board.rows[1].all);
  EXPECT_THAT(board.doubts, testing::Contains(HasSubstr("gaps: INCOMPLETE: 1 scan without")));
}

TEST(Leaderboard, StandsForEachGroupOfRunsThatCanBeCompared) {
  std::vector<ResultSet> runs = {run_of("a", 900, 1.0), run_of("mapmos", 850, 2.0),
                                 run_of("b", 800, 1.0), run_of("elsewhere", 800, 1.0),
                                 run_of("untold", 800, 1.0)};
  for (Result& sequence : runs[1].sequences) sequence.protocol = &protocol_named("mapmos");
  for (Result& sequence : runs[3].sequences) {
    sequence.sequence = SequenceName("9" + sequence.sequence.text(), "9");
  }
  runs[4].sequences[1].scans.clear();
  std::vector<std::vector<std::string>> names;
  for (const std::vector<ResultSet>& group : comparable_runs(runs)) {
    std::vector<std::string>& of_group = names.emplace_back();
    for (const ResultSet& run : group) of_group.push_back(run.front().method);
  }
  EXPECT_THAT(names,
              ElementsAre(ElementsAre("a", "b"), ElementsAre("mapmos"), ElementsAre("elsewhere")));
}

TEST(ResultSet, LiesInTheFolderAboveThoseNamedLikeItsSequence) {
  const auto folder = [](const char* result, const char* sequence) {
    return folder_of_run(result, SequenceName(sequence, "here")).string();
  };
  EXPECT_EQ(folder("runs/mine/00", "00"), "runs/mine");
  EXPECT_EQ(folder("runs/mine/station/sequence_1", "station/sequence_1"), "runs/mine");
  EXPECT_EQ(folder("runs/mine/other", "00"), "runs/mine/other");
  EXPECT_EQ(folder("00", "00"), "00");
}

TEST(Leaderboard, RefusesRunsOfAnotherKind) {
  const auto refusal = [](auto&& change) {
    std::vector<ResultSet> runs = {run_of("a", 900, 1.0), run_of("b", 850, 2.0)};
    for (Result& sequence : runs[1].sequences) change(sequence);
    return message_of<DataError>([&] { leaderboard_of(runs); });
  };
  EXPECT_THAT(refusal([](auto& run) { run.protocol = &protocol_named("mapmos"); }),
              HasSubstr("protocol is semantickitti-mos and mapmos"));
  EXPECT_THAT(refusal([](auto& run) { run.range.max_m = 50; }), HasSubstr("counted range"));
  EXPECT_THAT(refusal([](auto& run) { run.from.fingerprint = "other"; }),
              HasSubstr("fingerprints"));
  EXPECT_THAT(refusal([](auto& run) { run.scans[0].truth_hash->fill('1'); }),
              HasSubstr("the truth of scan 0 differs"));
  EXPECT_THAT(refusal([](auto& run) { run.scans.clear(); }), HasSubstr("no scan with truth"));
  EXPECT_THAT(
      refusal([](auto& run) { run.sequence = SequenceName("9" + run.sequence.text(), "9"); }),
      HasSubstr("they have no scan in common, expected runs with the same"));
}

TEST(Leaderboard, RemarksOnTimesOfOtherThreadsAndProcessors) {
  std::vector<ResultSet> runs = {run_of("a", 900, 1.0), run_of("b", 850, 2.0)};
  for (Result& sequence : runs[1].sequences) {
    sequence.timing->threads = 2;
    sequence.from.machine.emplace().processor = "other";
  }
  EXPECT_THAT(leaderboard_of(runs).remarks,
              ElementsAre("ms per scan are of different numbers of threads: 1, 2",
                          "ms per scan are of different processors: other, unknown"));
}

SettingValue is(const std::string& word) { return word; }

/// A run of one method with settings of its own.
ResultSet run_with(const std::string& name, std::uint64_t found, nlohmann::ordered_json config) {
  ResultSet run = run_of("HMM-MOS", found, 5.0);
  run.path = "runs/" + name;
  for (Result& sequence : run.sequences) sequence.settings = recorded_settings(config);
  return run;
}

TEST(Leaderboard, ShowsByWhatRunsWereDisturbed) {
  std::vector<ResultSet> runs = {run_with("as_recorded", 900, {{"voxel_size_m", 0.2}}),
                                 run_with("shaken", 600, {{"voxel_size_m", 0.2}})};
  runs[1].sequences[0].from.reading = {{"perturb", "pose_noise_m=0.05,seed=3"}};
  const Leaderboard board = leaderboard_of(runs);
  ASSERT_EQ(board.differing.size(), 1U);
  EXPECT_EQ(board.differing[0].name, "perturb");
  EXPECT_THAT(board.differing[0].values, ElementsAre(is("none"), is("pose_noise_m=0.05,seed=3")));
}

TEST(Leaderboard, TellsPosesThatWereRefinedOrStandStill) {
  std::vector<ResultSet> runs = {run_of("a", 900, std::nullopt), run_of("b", 800, std::nullopt),
                                 run_of("c", 700, std::nullopt)};
  runs[0].sequences[0].from.reading = {{"poses", "poses.txt"}};
  runs[1].sequences[0].from.reading = {{"poses", "poses.txt"}, {"pose_refinement", "registered"}};
  runs[2].sequences[0].from.reading = {{"poses", "static"}};
  const Leaderboard board = leaderboard_of(runs);
  ASSERT_EQ(board.differing.size(), 1U);
  EXPECT_THAT(board.differing[0].values,
              ElementsAre(is("as given"), is("as given, refined"), is("static")));
}

TEST(Leaderboard, ShowsTheSettingsInWhichRunsOfOneMethodDiffer) {
  std::vector<ResultSet> runs = {
      run_with("online", 600, {{"delay_scans", 0}, {"voxel_size_m", 0.2}}),
      run_with("delayed", 900, {{"delay_scans", 10}, {"voxel_size_m", 0.2}}),
      run_of("Net", 700, std::nullopt)};
  runs[2].sequences[0].setting = "large";
  runs[1].sequences[0].from.reading = {{"poses", "poses.txt"}};
  runs[0].sequences[0].from.odometry = {"found by KISS-ICP", recorded_settings({{"a", 1}}), ""};
  const Leaderboard board = leaderboard_of(runs);
  ASSERT_EQ(board.differing.size(), 2U);
  EXPECT_EQ(board.differing[0].name, "delay_scans");
  EXPECT_THAT(board.differing[0].values,
              ElementsAre(SettingValue(10), std::nullopt, SettingValue(0)))
      << "in the order of the rows";
  EXPECT_EQ(board.differing[1].name, "poses");
  EXPECT_THAT(board.differing[1].values,
              ElementsAre(is("as given"), std::nullopt, is("found by KISS-ICP")));
  EXPECT_THAT(render(leaderboard_answer(board), Format::kText), HasSubstr("delay_scans"));
  EXPECT_EQ(to_json(board).at("rows").at(2).at("differing_settings").at("delay_scans"), 0);
  const std::string csv = render(leaderboard_answer(board), Format::kCsv);
  EXPECT_THAT(csv.substr(0, csv.find('\n')),
              testing::EndsWith(",no_interval,delay_scans,poses,standing"));
}

TEST(Leaderboard, ShowsSettingsThatAllRunsHaveWhateverTheirMethod) {
  std::vector<ResultSet> runs = {run_with("near", 600, {{"max_range_m", 20.0}, {"only_here", 1}}),
                                 run_with("far", 900, {{"max_range_m", 50.0}})};
  for (Result& sequence : runs[1].sequences) sequence.method = "Dynablox";
  const Leaderboard board = leaderboard_of(runs);
  ASSERT_EQ(board.differing.size(), 1U);
  EXPECT_EQ(board.differing[0].name, "max_range_m");
}

TEST(Leaderboard, KeepsTheGivenOrderAndComparesWithItsFirst) {
  const std::vector<ResultSet> runs = {run_of("baseline", 850, 1.0), run_of("better", 900, 2.0)};
  const Leaderboard board = leaderboard_of(runs, RowOrder::kGiven);
  EXPECT_EQ(board.rows[0].run->front().method, "baseline");
  EXPECT_FALSE(board.rows[0].to_first);
  EXPECT_NEAR(board.rows[1].to_first.value().value.value(), 0.05, 1e-9);
}

TEST(Leaderboard, NamesTheRowWhereSeveralAreOfOneMethod) {
  std::vector<ResultSet> runs = {run_with("a", 900, {{"x", 1}}), run_with("b", 800, {{"x", 2}})};
  runs[1].sequences.pop_back();
  EXPECT_THAT(leaderboard_of(runs).remarks,
              ElementsAre(HasSubstr("HMM-MOS (row 2) is not compared with HMM-MOS (row 1)")));
}

TEST(Leaderboard, TellsOfEachRowWhatIsDoubtfulAboutIt) {
  std::vector<ResultSet> runs = {run_of("a", 900, 1.0), run_of("b", 850, 2.0)};
  for (ResultSet& run : runs) {
    for (Result& sequence : run.sequences) sequence.scans.front().counts->tn = 1;  // no doubt
  }
  runs[1].sequences[0].doubts = {"7 scans are odd"};
  runs[1].sequences[1].doubts = {"9 scans are odd"};
  const Answer answer = leaderboard_answer(leaderboard_of(runs));
  const std::string csv = render(answer, Format::kCsv), latex = render(answer, Format::kLatex);
  EXPECT_THAT(csv, testing::ContainsRegex("\na,,00/result.json,all,[^\n]*,\n"));
  EXPECT_THAT(csv, testing::ContainsRegex(
                       "\nb,[^\n]*,all,[^\n]*,00: 7 scans are odd; 01: 9 scans are odd\n"));
  EXPECT_THAT(csv, testing::ContainsRegex("\nb,[^\n]*,00,[^\n]*,00: 7 scans are odd\n"));
  EXPECT_THAT(latex, testing::ContainsRegex("\n1 & a & [^\n$]*\n2 & b & [^\n]*\\$\\^\\{a\\}\\$"));
  EXPECT_THAT(latex, HasSubstr("{$^{a}$ ...: ... scans are odd}")) << "one line of a kind";
}

TEST(Leaderboard, IsPrintedInEveryFormat) {
  const std::vector<ResultSet> runs = {run_of("a_b", 900, 1.0), run_of("c", 850, 2.0)};
  const Leaderboard board = leaderboard_of(runs);
  const auto json = to_json(board);
  EXPECT_EQ(json.at("rows").at(0).at("method"), "a_b");
  EXPECT_NEAR(json.at("rows").at(1).at("to_first").at("value").get<double>(), -0.05, 1e-9);
  EXPECT_TRUE(json.at("rows").at(0).at("on_front").get<bool>());
  const Answer answer = leaderboard_answer(board);
  EXPECT_THAT(render(answer, Format::kLatex),
              testing::AllOf(HasSubstr("1 & a\\_b & 85.0"),
                             testing::ContainsRegex("multicolumn[^\n]*, protocol ")));
  EXPECT_THAT(render(answer, Format::kText), HasSubstr("\n1: a_b (00/result.json)\n"));
  const std::string markdown = render(answer, Format::kMarkdown);
  EXPECT_THAT(markdown, HasSubstr("\n|  | method | IoU % | 95 % | 00 % | 01 % |"));
  EXPECT_THAT(markdown, HasSubstr("|--:|---|--:|--:|"));
  EXPECT_THAT(markdown, HasSubstr("\n| 1 | a_b | 85.0 |"));
  const std::string csv = render(answer, Format::kCsv);
  EXPECT_EQ(std::ranges::count(csv, '\n'), 7);
  EXPECT_THAT(csv, HasSubstr("\na_b,,00/result.json,all,84.9825,"));
}

}  // namespace
}  // namespace mosbench
