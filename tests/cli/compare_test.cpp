#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "datasets/formats/label_file.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
constexpr const char* kTooFew =
    "12 scans, expected at least 100 in a row, or 20 that are 10 s apart";
using testing::HasSubstr;
using testing::Not;

/// A run of a small sequence that is also the baseline.
class Compare : public testing::Test {
 protected:
  Compare() {
    cli::write_small_sequence(folder_ / "room", 12);
    run_again("out", {});
    const cli::Answer bless =
        cli::run({"bless", (folder_ / "out").string(), (folder_ / "baseline").string()});
    if (bless.exit_code != 0) throw std::runtime_error(bless.err);
  }
  void run_again(const std::string& out, const std::vector<std::string>& more) const {
    std::vector<std::string> words = {"run", (folder_ / "room").string(), "--out",
                                      (folder_ / out).string()};
    words.insert(words.end(), more.begin(), more.end());
    const cli::Answer run = cli::run(words);
    if (run.exit_code != 0) throw std::runtime_error(run.err);
  }
  cli::Answer compare(const std::string& newer, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {"compare", (folder_ / "baseline").string(),
                                      (folder_ / newer).string()};
    words.insert(words.end(), more.begin(), more.end());
    return cli::run(words);
  }
  /// Scores the truth after `change` said which of its moving points are lost.
  template <typename Change>
  void score_changed(const std::string& out, Change&& change) const {
    const fs::path labels = folder_ / out / "predictions";
    std::size_t moving = 0;
    for (std::size_t k = 0; k < 12; ++k) {
      const std::string file = cli::stem(k) + ".label";
      auto predicted = read_labels(folder_ / "room/labels" / file, cli::kPointsPerScan);
      for (std::uint32_t& label : predicted) {
        if (label == kMovingLabel && change(moving++)) label = kStaticLabel;
      }
      write_labels(labels / file, predicted);
    }
    ASSERT_GT(moving, 500U);
    const cli::Answer score =
        cli::run({"score", (folder_ / "room").string(), "--predictions", labels.string(), "--out",
                  (folder_ / out / "results").string(), "--method", "Mine", "--json"});
    ASSERT_EQ(score.exit_code, 0) << score.err;
  }

  TempFolder folder_;
};

TEST_F(Compare, PassesIdenticalResultsEveryTime) {
  for (int rerun = 0; rerun < 50; ++rerun) ASSERT_EQ(compare("out").exit_code, 0);
  EXPECT_EQ(compare("out", {"--max-drop", "0"}).exit_code, 0);
}

TEST_F(Compare, PassesARunWithAnotherNumberOfThreads) {
  run_again("threads", {"--threads", "3"});
  const cli::Answer answer = compare("threads", {"--max-drop", "0", "--json"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err << answer.out;
  EXPECT_EQ(nlohmann::json::parse(answer.out).at("checks").at(0).at("difference"), 0.0);
}

TEST_F(Compare, CatchesThreePercentOfTheMovingPointsFlipped) {
  score_changed("whole", [](std::size_t) { return false; });
  score_changed("flipped", [](std::size_t moving) { return moving % 33 == 0; });
  const auto compare_to_whole = [this](const std::string& newer, const std::string& max_drop) {
    return cli::run({"compare", (folder_ / "whole/results").string(),
                     (folder_ / newer / "results").string(), "--max-drop", max_drop, "--json"});
  };
  const cli::Answer answer = compare_to_whole("flipped", "0.5");
  ASSERT_EQ(answer.exit_code, 1) << answer.err << answer.out;
  const auto json = nlohmann::json::parse(answer.out);
  EXPECT_FALSE(json.at("passed").get<bool>());
  EXPECT_NEAR(json.at("checks").at(0).at("difference").get<double>(), -0.03, 0.002);
  EXPECT_EQ(compare_to_whole("flipped", "20").exit_code, 0);
  EXPECT_EQ(compare_to_whole("whole", "0").exit_code, 0);
}

TEST_F(Compare, LetsTheMaxDropAloneDecide) {
  score_changed("whole", [](std::size_t) { return false; });
  score_changed("early", [](std::size_t moving) { return moving < 60; });
  const auto compare_to_whole = [this](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"compare", (folder_ / "whole/results").string(),
                                      (folder_ / "early/results").string()};
    words.insert(words.end(), more.begin(), more.end());
    return cli::run(words);
  };
  const cli::Answer answer = compare_to_whole({"--json"});
  ASSERT_EQ(answer.exit_code, 1) << answer.err << answer.out;
  const auto check = nlohmann::json::parse(answer.out).at("checks").at(0);
  const double drop = -check.at("difference").get<double>();
  ASSERT_GT(drop, 0.005);
  EXPECT_EQ(check.at("low"), nullptr);
  EXPECT_EQ(check.at("no_interval"), kTooFew);
  EXPECT_DOUBLE_EQ(check.at("tolerance").get<double>(), 0.005);

  // Without an interval --statistical widens nothing.
  EXPECT_EQ(compare_to_whole({"--statistical"}).exit_code, 1);
  EXPECT_THAT(compare_to_whole({}).out, HasSubstr("it does not decide (--statistical)"));
  EXPECT_THAT(compare_to_whole({}).out,
              HasSubstr("no interval for room: 12 scans, expected at least 100"));
  EXPECT_EQ(compare_to_whole({"--max-drop", std::to_string(100.0 * drop + 0.01)}).exit_code, 0);
  EXPECT_EQ(compare_to_whole({"--max-drop", std::to_string(100.0 * drop - 0.01)}).exit_code, 1);
}

TEST_F(Compare, AnnotatesAPullRequest) {
  score_changed("whole", [](std::size_t) { return false; });
  score_changed("flipped", [](std::size_t moving) { return moving % 33 == 0; });
  const auto compare_to_whole = [this](const std::string& newer,
                                       const std::vector<std::string>& more) {
    std::vector<std::string> words = {"compare", (folder_ / "whole/results").string(),
                                      (folder_ / newer / "results").string()};
    words.insert(words.end(), more.begin(), more.end());
    return cli::run(words);
  };
  const fs::path summary = folder_ / "gate.md";
  const cli::Answer worse =
      compare_to_whole("flipped", {"--as", "github", "--out", summary.string()});
  EXPECT_EQ(worse.exit_code, 1) << worse.err;
  EXPECT_THAT(worse.out, HasSubstr("\nregression\n"));
  EXPECT_THAT(worse.out, HasSubstr("::error title=IoU of room dropped::100.0 %25 before, 97."));
  EXPECT_THAT(read_file(summary),
              AllOf(HasSubstr("### MOS gate: REGRESSION\n\n12 paired scans\n\n"),
                    HasSubstr("\n\n| sequence | baseline")));
  EXPECT_THAT(read_file(summary), HasSubstr("\n| room | 100.0 | 97."));

  const cli::Answer same = compare_to_whole("whole", {"--as", "github", "--out", summary.string()});
  EXPECT_EQ(same.exit_code, 0) << same.err;
  EXPECT_THAT(same.out, Not(HasSubstr("::error")));
  EXPECT_THAT(read_file(summary), HasSubstr("### MOS gate: pass\n"));

  EXPECT_EQ(compare_to_whole("whole", {"-q"}).out, "");
  EXPECT_THAT(compare_to_whole("flipped", {"-q"}).out, HasSubstr("REGRESSION"));
  const cli::Answer markdown = compare_to_whole("whole", {"--out", "-"});
  EXPECT_THAT(markdown.out, testing::StartsWith("### MOS gate"));
  EXPECT_THAT(markdown.err, HasSubstr("\npass\n"));
  EXPECT_EQ(compare_to_whole("whole", {"--json", "--as", "text"}).exit_code, 2);
}

/// The first failed step of a job must not hide what the table says.
TEST_F(Compare, WritesTestCasesAndAppendsToASummary) {
  score_changed("whole", [](std::size_t) { return false; });
  score_changed("flipped", [](std::size_t moving) { return moving % 33 == 0; });
  folder_.write("summary.md", "before\n");
  const auto compare_to_whole = [this](const std::string& newer) {
    return cli::run(
        {"compare", (folder_ / "whole/results").string(), (folder_ / newer / "results").string(),
         "--out", (folder_ / "gate.xml").string(), "--summary", (folder_ / "summary.md").string()});
  };
  EXPECT_EQ(compare_to_whole("flipped").exit_code, 1);
  EXPECT_THAT(
      read_file(folder_ / "gate.xml"),
      AllOf(HasSubstr("tests=\"2\" failures=\"1\""),
            HasSubstr("name=\"room\"><failure message=\"IoU of room dropped: 100.0 % before")));
  EXPECT_EQ(compare_to_whole("whole").exit_code, 0);
  EXPECT_THAT(read_file(folder_ / "gate.xml"), HasSubstr("tests=\"2\" failures=\"0\""));
  EXPECT_THAT(read_file(folder_ / "summary.md"),
              testing::ContainsRegex("^before\n### MOS gate: REGRESSION(.|\n)*### MOS gate: pass"));

  const cli::Answer printed = compare("out", {"--as", "junit"});
  EXPECT_EQ(printed.exit_code, 0);
  EXPECT_THAT(printed.out, testing::StartsWith("<?xml"));
  EXPECT_EQ(compare("out", {"--summary", (folder_ / "room").string()}).exit_code, 3);
}

/// CI servers must not take the answer of a run before for that of this one.
TEST_F(Compare, WritesThatItCouldNotJudge) {
  run_again("coarse", {"--set", "voxel_size_m=0.4"});
  const fs::path xml = folder_ / "gate.xml", summary = folder_ / "summary.md";
  ASSERT_EQ(compare("out", {"--out", xml.string()}).exit_code, 0);
  const cli::Answer refused =
      compare("coarse", {"--out", xml.string(), "--as", "github", "--summary", summary.string()});
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_THAT(refused.err, HasSubstr("voxel_size_m: 0.25 -> 0.4"));
  EXPECT_THAT(refused.out, HasSubstr("::error title=MOS gate%3A not judged::"));
  EXPECT_THAT(read_file(xml), AllOf(HasSubstr("tests=\"1\" failures=\"0\" errors=\"1\""),
                                    HasSubstr("<error message=\"MOS gate: not judged: ")));
  EXPECT_THAT(read_file(summary), testing::StartsWith("### MOS gate: not judged\n"));
  const auto json = nlohmann::json::parse(compare("coarse", {"--json"}).out);
  EXPECT_EQ(json.at("passed"), false);
  EXPECT_THAT(json.at("error").get<std::string>(), HasSubstr("is not like"));
  EXPECT_EQ(compare("coarse", {"-q"}).out, "");
  EXPECT_EQ(compare("out", {"--max-cost", "cpu=x", "--out", xml.string()}).exit_code, 2);
  EXPECT_THAT(read_file(xml), HasSubstr("errors=\"1\""));
  for (const std::vector<std::string>& wrong : {std::vector<std::string>{"--max-dorp", "1"},
                                                {"--max-drop", "x"},
                                                {"more"},
                                                {"--by", "scan"}}) {
    ASSERT_EQ(compare("out", {"-o", xml.string()}).exit_code, 0);
    fs::remove(summary);
    std::vector<std::string> words = wrong;
    words.insert(words.end(), {"-o", xml.string(), "--summary", summary.string()});
    const cli::Answer misused = compare("out", words);
    EXPECT_EQ(misused.exit_code, 2) << wrong.front();
    EXPECT_EQ(misused.out, "");
    EXPECT_THAT(read_file(xml), HasSubstr("<error message=\"MOS gate: not judged: "));
    EXPECT_THAT(read_file(summary), testing::StartsWith("### MOS gate: not judged\n"));
  }
}

TEST_F(Compare, RefusesLimitsThatAreNoNumbersBeforeItLooksAtRuns) {
  for (const auto& [flag, value] : {std::pair{"--max-drop", "nan"},
                                    {"--max-drop", "inf"},
                                    {"--max-drop", ""},
                                    {"--max-added-fp", "nan"},
                                    {"--max-added-fp", "-3"},
                                    {"--max-cost", ""},
                                    {"--max-cost", "cpu=10,"},
                                    {"--max-cost", "cpu=10,cpu=1000"},
                                    {"--max-cost", "cpu=nan"}}) {
    const cli::Answer answer = compare("nowhere", {flag, value});
    EXPECT_EQ(answer.exit_code, 2) << flag << " " << value;
    EXPECT_THAT(answer.err, AllOf(HasSubstr(flag), HasSubstr("expected"))) << value;
    EXPECT_LT(answer.err.size(), 200U) << answer.err;
  }
  EXPECT_EQ(compare("out", {"--by", "scan", "--top", ""}).exit_code, 2);
}

TEST_F(Compare, WarnsThatRunsAreUnlikeWhereOnlyFailuresAreRead) {
  run_again("coarse", {"--set", "voxel_size_m=0.4"});
  const std::vector<std::string> words = {"--even-if", "--max-drop", "100"};
  const auto shown = [&](const char* format) {
    std::vector<std::string> all = words;
    all.insert(all.end(), {"--as", format});
    return compare("coarse", all).out;
  };
  EXPECT_THAT(shown("github"),
              HasSubstr("::warning title=Runs are not alike::voxel_size_m: 0.25 -> 0.4"));
  EXPECT_THAT(shown("junit"), HasSubstr("name=\"alike\"><skipped message=\"Runs are not alike: "));
  EXPECT_THAT(compare("out", {"--as", "junit"}).out, HasSubstr("name=\"alike\"/>"));
}

TEST_F(Compare, SaysWhichSequencesThereAre) {
  EXPECT_THAT(compare("out", {"--sequences", "99"}).err,
              HasSubstr("baseline: has no sequence 99, expected room"));
}

TEST_F(Compare, WritesWhatDiffersWhereItIsAsked) {
  run_again("coarse", {"--set", "voxel_size_m=0.4"});
  const fs::path json = folder_ / "by.json", summary = folder_ / "summary.md";
  const cli::Answer by = compare(
      "coarse", {"--by", "sequence", "--out", json.string(), "--summary", summary.string()});
  EXPECT_EQ(by.exit_code, 0) << by.err;
  EXPECT_TRUE(nlohmann::json::parse(read_file(json)).contains("difference"));
  EXPECT_THAT(read_file(summary), HasSubstr("| iou |"));
  const cli::Answer xml = compare("coarse", {"--by", "scan", "--out", "x.xml"});
  EXPECT_EQ(xml.exit_code, 2);
  EXPECT_THAT(xml.err, HasSubstr("x.xml: test cases are of a gate"));
}

TEST_F(Compare, RefusesUnlikeResultsUnlessTold) {
  run_again("coarse", {"--set", "voxel_size_m=0.4"});
  const cli::Answer setting = compare("coarse");
  EXPECT_EQ(setting.exit_code, 3);
  EXPECT_THAT(setting.err, HasSubstr("voxel_size_m: 0.25 -> 0.4, occupancy_sigma_m: 0.25 -> 0.4"));
  EXPECT_THAT(setting.err, Not(HasSubstr("max_range_m"))) << "equal on both sides";
  EXPECT_NE(compare("coarse", {"--even-if", "--max-drop", "100"}).exit_code, 3);

  run_again("other-protocol", {"--protocol", "mapmos"});
  EXPECT_THAT(compare("other-protocol").err, HasSubstr("protocol is semantickitti-mos and mapmos"));

  run_again("later", {"--variant", "release-2025"});
  EXPECT_THAT(compare("later").err, HasSubstr("variant: \"paper-2024\" -> \"release-2025\""));
}

TEST_F(Compare, NamesOnlySettingsThatBothMethodsHave) {
  run_again("underwood", {"--method", "underwood", "--set", "max_range_m=20"});
  const cli::Answer answer = compare("underwood");
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.err, HasSubstr("method is HMM-MOS and Underwood et al.; max_range_m: "));
  EXPECT_THAT(answer.err, Not(HasSubstr("nothing"))) << "settings of one method only";
  const cli::Answer again = cli::run({"run", (folder_ / "room").string(), "--method", "underwood",
                                      "--out", (folder_ / "out").string()});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.err, HasSubstr("method/kind is \"hmm-mos\" there and \"underwood\" now"));
  EXPECT_THAT(again.err, Not(HasSubstr("settings/")));
}

TEST_F(Compare, StatsComparesRunsWithOtherPosesAndSaysSo) {
  std::string poses = read_file(folder_ / "room/poses.txt");
  const std::size_t row = poses.rfind('\n', poses.size() - 2) + 1;
  const std::size_t x = [&] {
    std::size_t at = row;
    for (int words = 0; words < 3; ++words) at = poses.find(' ', at) + 1;
    return at;
  }();
  poses.replace(x, poses.find(' ', x) - x, "0.25");
  write_file_atomic(folder_ / "other.txt", poses);
  run_again("moved", {"--poses", (folder_ / "other.txt").string()});
  const cli::Answer stats =
      cli::run({"stats", (folder_ / "out").string(), (folder_ / "moved").string()});
  EXPECT_EQ(stats.exit_code, 0) << stats.err;
  EXPECT_THAT(stats.out, HasSubstr("sequence room: the poses differ, the scans do not"));
  const cli::Answer gate = compare("moved");
  EXPECT_EQ(gate.exit_code, 3) << "a gate is about the code";
  EXPECT_THAT(gate.err, HasSubstr("the poses differ, the scans do not"));
}

TEST_F(Compare, RefusesOtherInputAndOtherScans) {
  fs::remove(folder_ / "room/labels/000003.label");
  run_again("unlabelled", {});
  const cli::Answer scans = compare("unlabelled");
  EXPECT_EQ(scans.exit_code, 3);
  EXPECT_THAT(scans.err, HasSubstr("sequence room: scan 000003 is only in the first run"));
  EXPECT_THAT(scans.err, HasSubstr("fingerprints of the scans differ"));
  const cli::Answer even_if = compare("unlabelled", {"--even-if"});
  EXPECT_EQ(even_if.exit_code, 0) << even_if.err;
  EXPECT_THAT(even_if.out, HasSubstr("11 paired scans"));
}

TEST_F(Compare, RefusesWhatIsNoResult) {
  EXPECT_EQ(compare("nowhere").exit_code, 3);
  EXPECT_EQ(compare("out", {"--max-drop", "much"}).exit_code, 2);
  fs::create_directories(folder_ / "empty");
  EXPECT_THAT(compare("empty").err, HasSubstr("holds no result.json"));
  folder_.write("broken/room/result.json", "{\"scans\": 3}");
  const cli::Answer broken = compare("broken");
  EXPECT_EQ(broken.exit_code, 3);
  EXPECT_THAT(broken.err, HasSubstr("broken/room/result.json"));
}

TEST_F(Compare, BlessReplacesTheBaselineAndChangesNothingWhenRepeated) {
  const fs::path accepted = folder_ / "baseline/room/result.json";
  const std::string before = read_file(accepted);
  EXPECT_EQ(before.find("timing"), std::string::npos);
  const cli::Answer again =
      cli::run({"bless", (folder_ / "out").string(), (folder_ / "baseline").string()});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("12 paired scans"));
  EXPECT_EQ(read_file(accepted), before);
}

TEST_F(Compare, BlessFillsAnEmptyFolder) {
  fs::create_directories(folder_ / "empty");
  const cli::Answer answer =
      cli::run({"bless", (folder_ / "out").string(), (folder_ / "empty").string()});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.out, HasSubstr("a new baseline"));
  EXPECT_TRUE(fs::exists(folder_ / "empty/room/result.json"));
}

TEST_F(Compare, BlessRefusesToReplaceABaselineOfAnotherKindUnlessTold) {
  const auto bless = [this](const std::string& newer, const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {"bless", (folder_ / newer).string(),
                                      (folder_ / "baseline").string()};
    words.insert(words.end(), more.begin(), more.end());
    return cli::run(words);
  };
  const fs::path accepted = folder_ / "baseline/room/result.json";
  const std::string before = read_file(accepted);
  run_again("coarse", {"--set", "voxel_size_m=0.4"});
  const cli::Answer setting = bless("coarse");
  EXPECT_EQ(setting.exit_code, 3);
  EXPECT_THAT(setting.err, HasSubstr("voxel_size_m: 0.25 -> 0.4"));
  EXPECT_THAT(setting.err, HasSubstr("--even-if"));
  cli::write_small_sequence(folder_ / "hall", 10);
  const cli::Answer run =
      cli::run({"run", (folder_ / "hall").string(), "--out", (folder_ / "other").string()});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const cli::Answer other = bless("other");
  EXPECT_EQ(other.exit_code, 3);
  EXPECT_THAT(other.err, HasSubstr("sequence room: is only in the first run"));
  EXPECT_THAT(other.err, HasSubstr("sequence hall: is only in the second run"));
  EXPECT_EQ(read_file(accepted), before);

  const cli::Answer told = bless("coarse", {"--even-if"});
  ASSERT_EQ(told.exit_code, 0) << told.err;
  EXPECT_EQ(compare("coarse").exit_code, 0);
  EXPECT_EQ(compare("out").exit_code, 3);
}

TEST_F(Compare, BlessTakesOtherNumbersOfTheSameKind) {
  const fs::path result = folder_ / "out/room/result.json";
  auto json = nlohmann::ordered_json::parse(read_file(result));
  const auto add = [](nlohmann::ordered_json& counts, const char* name, int points) {
    counts[name] = counts.at(name).get<int>() + points;
  };
  for (nlohmann::ordered_json* counts : {&json.at("scans").at(7), &json.at("summary")}) {
    add(*counts, "fp", 5);
    add(*counts, "tn", -5);
  }
  add(json.at("scans").at(7), "predicted_moving_points", 5);
  write_file_atomic(result, json.dump());
  const cli::Answer bless =
      cli::run({"bless", (folder_ / "out").string(), (folder_ / "baseline").string()});
  ASSERT_EQ(bless.exit_code, 0) << bless.err;
  EXPECT_EQ(compare("out", {"--max-drop", "0"}).exit_code, 0);
}

TEST_F(Compare, AndStatsRepeatThatPredictionsWereMissing) {
  const fs::path labels = folder_ / "out/room/labels";
  fs::remove(labels / "000004.label");
  const std::string results = (folder_ / "scored").string();
  const cli::Answer score = cli::run({"score", (folder_ / "room").string(), "--predictions",
                                      labels.string(), "--allow-missing", "--out", results});
  ASSERT_EQ(score.exit_code, 0) << score.err;
  const std::string mark = "INCOMPLETE: 1 scan without usable prediction is not counted";
  ASSERT_THAT(score.out, HasSubstr(mark));

  EXPECT_THAT(cli::run({"stats", results}).out, HasSubstr(mark));
  EXPECT_THAT(cli::run({"stats", results, results}).out, HasSubstr(mark));
  EXPECT_THAT(cli::run({"stats", results, "--csv"}).out, HasSubstr(mark));
  const auto stats = nlohmann::json::parse(cli::run({"stats", results, "--json"}).out);
  EXPECT_EQ(stats.at("missing_predictions"), 1);
  EXPECT_THAT(cli::run({"compare", results, results}).out, HasSubstr("new: " + mark));
  const auto gate = nlohmann::json::parse(cli::run({"compare", results, results, "--json"}).out);
  EXPECT_EQ(gate.at("missing_predictions").at("baseline"), 1);
  EXPECT_EQ(gate.at("missing_predictions").at("new"), 1);
  EXPECT_THAT(cli::run({"bless", results, (folder_ / "first").string()}).out, HasSubstr(mark));
  EXPECT_THAT(cli::run({"stats", (folder_ / "out").string()}).out, Not(HasSubstr("INCOMPLETE")));
}

TEST_F(Compare, StatsGiveMetricsAndAPairedDifference) {
  const cli::Answer one = cli::run({"stats", (folder_ / "out").string(), "--json", "--per-scan"});
  ASSERT_EQ(one.exit_code, 0) << one.err;
  const auto json = nlohmann::json::parse(one.out);
  const auto iou = json.at("all").at("iou");
  EXPECT_GT(iou.at("value"), 0.0);
  EXPECT_EQ(iou.at("low"), nullptr);
  EXPECT_EQ(iou.at("no_interval"), kTooFew);
  EXPECT_THAT(cli::run({"stats", (folder_ / "out").string()}).out,
              HasSubstr("no interval for all: 12 scans, expected at least 100"));
  ASSERT_EQ(json.at("scans").size(), 12U);
  EXPECT_EQ(json.at("scans").at(5).at("scan"), "000005");

  const cli::Answer csv = cli::run({"stats", (folder_ / "out").string(), "--csv"});
  EXPECT_EQ(std::ranges::count(csv.out, '\n'), 13);
  EXPECT_THAT(csv.out, HasSubstr("room,000005,8640,"));

  run_again("coarse", {"--set", "voxel_size_m=0.4"});
  const cli::Answer two =
      cli::run({"stats", (folder_ / "out").string(), (folder_ / "coarse").string(), "--json"});
  ASSERT_EQ(two.exit_code, 0) << two.err;
  EXPECT_EQ(nlohmann::json::parse(two.out).at("paired_scans"), 12);
  run_again("other-protocol", {"--protocol", "mapmos"});
  EXPECT_EQ(cli::run({"stats", (folder_ / "out").string(), (folder_ / "other-protocol").string()})
                .exit_code,
            3);
}

}  // namespace
}  // namespace mosbench
