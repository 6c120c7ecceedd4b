#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "eval/result/result_scans.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

constexpr std::size_t kScansOfRun = 12;

class Run : public testing::Test {
 protected:
  Run() { cli::write_small_sequence(folder_ / "room", kScansOfRun); }

  std::vector<std::string> command(const std::string& out,
                                   const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {"run", (folder_ / "room").string(), "--out",
                                      (folder_ / out).string()};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  nlohmann::ordered_json result(const std::string& out) const {
    return nlohmann::ordered_json::parse(read_file(folder_ / out / "room/result.json"));
  }

  TempFolder folder_;
};

TEST_F(Run, SaysWhatWindowsInScansMeanHere) {
  std::string times;
  for (std::size_t k = 0; k < kScansOfRun; ++k)
    times += std::to_string(0.05 * static_cast<double>(k)) + '\n';
  folder_.write("room/times.txt", times);
  const cli::Answer answer = cli::run(command("out"));
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.out, HasSubstr("scans come every 0.05 s, not every 0.1 s: "
                                    "local_window_scans=3 lasts 0.15 s"));
  EXPECT_THAT(result("out").at("remarks").dump(), HasSubstr("not every 0.1 s"));
}

TEST_F(Run, WritesOneLabelPerPointNamedLikeTheScan) {
  const cli::Answer answer = cli::run(command("out"));
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  std::size_t moving = 0;
  for (std::size_t k = 0; k < kScansOfRun; ++k) {
    const auto labels =
        read_labels(folder_ / "out/room/labels" / (cli::stem(k) + ".label"), cli::kPointsPerScan);
    for (const std::uint32_t label : labels) {
      ASSERT_TRUE(label == kStaticLabel || label == kMovingLabel) << label;
      if (label == kMovingLabel) ++moving;
    }
  }
  EXPECT_GT(moving, 0U);
  const auto json = result("out");
  ASSERT_EQ(json.at("scans").size(), kScansOfRun);
  std::size_t recorded = 0;
  for (const auto& scan : json.at("scans")) {
    recorded += scan.at("predicted_moving_points").get<std::size_t>();
    EXPECT_EQ(scan.at("points"), cli::kPointsPerScan);
  }
  EXPECT_EQ(recorded, moving);
}

TEST_F(Run, WritesOneScorePerPointWhenAskedAndTheSameLabels) {
  ASSERT_EQ(cli::run(command("plain")).exit_code, 0);
  const cli::Answer answer = cli::run(command("out", {"--scores"}));
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_FALSE(fs::exists(folder_ / "plain/room/scores"));
  const auto json = result("out");
  std::size_t above = 0;
  for (std::size_t k = 0; k < kScansOfRun; ++k) {
    const std::string label_name = "room/labels/" + cli::stem(k) + ".label";
    EXPECT_EQ(read_file(folder_ / "out" / label_name), read_file(folder_ / "plain" / label_name));
    const fs::path file = dynamic_score_file(folder_ / "out/room", cli::stem(k));
    const auto scores =
        parse_dynamic_scores(read_file(file), cli::kPointsPerScan, ScoreNumbers::kFloat32, file);
    const auto& threshold = json.at("scans").at(k).at("threshold");
    if (threshold.is_null() || threshold.get<double>() <= 3.0) continue;
    const auto labels = read_labels(folder_ / "out" / label_name, cli::kPointsPerScan);
    for (std::size_t i = 0; i < scores.size(); ++i) {
      if (scores[i] <= threshold.get<double>()) continue;
      ASSERT_EQ(labels[i], kMovingLabel) << k << ' ' << i;
      ++above;
    }
  }
  EXPECT_GT(above, 0U);
}

TEST_F(Run, WritesAReasonPerPointBesideScoresWhereTheMethodGivesAny) {
  for (const char* method : {"hmm-mos-plus", "hmm-mos"}) {
    const cli::Answer answer = cli::run(command(method, {"--scores", "--method", method}));
    ASSERT_EQ(answer.exit_code, 0) << answer.err;
  }
  EXPECT_FALSE(fs::exists(folder_ / "hmm-mos/room/reasons"));
  std::size_t moving = 0;
  for (std::size_t k = 0; k < kScansOfRun; ++k) {
    const fs::path file = reason_file(folder_ / "hmm-mos-plus/room", cli::stem(k));
    const auto reasons = parse_reasons(read_file(file), cli::kPointsPerScan, file);
    const auto labels = read_labels(
        folder_ / "hmm-mos-plus/room/labels" / (cli::stem(k) + ".label"), cli::kPointsPerScan);
    for (std::size_t i = 0; i < reasons.size(); ++i) {
      ASSERT_EQ(reasons[i] != Reason::kNone, labels[i] == kMovingLabel) << k << ' ' << i;
      moving += labels[i] == kMovingLabel;
    }
  }
  EXPECT_GT(moving, 0U);
}

TEST_F(Run, PrintsTheScoresAndWhatItChose) {
  const cli::Answer answer = cli::run(command("out"));
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  for (const char* text : {"IoU", "precision", "recall", "ms/scan", "room", "semantickitti-mos",
                           "voxel 0.25 m", "labelled static without detection"}) {
    EXPECT_THAT(answer.out, HasSubstr(text));
  }
  EXPECT_THAT(answer.err, HasSubstr("preset semantickitti taken"));
  EXPECT_THAT(answer.err, HasSubstr("room: scan 12/12"));
  EXPECT_THAT(answer.out, Not(HasSubstr("simulated data")));
}

TEST_F(Run, SaysNothingOfUnjudgedScansWhereThereAreNone) {
  std::vector<std::string> words = command("out");
  words.insert(words.end(), {"--method", "dufomap", "--set", "when=final"});
  const cli::Answer answer = cli::run(words);
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.out + answer.err, Not(HasSubstr("without detection")));
}

TEST_F(Run, RecordsTheEffectiveConfigurationWithTheKeysOfTheParityCases) {
  const cli::Answer answer =
      cli::run(command("out", {"--set", "voxel_size_m=0.3", "delay_scans=2"}));
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  std::vector<std::string> keys;
  const auto json = result("out");
  for (const auto& [key, value] : json.at("settings").items()) keys.push_back(key);
  EXPECT_THAT(
      keys, testing::ElementsAre("variant", "voxel_size_m", "occupancy_sigma_m", "min_range_m",
                                 "max_range_m", "delay_scans", "track_window_s",
                                 "local_window_scans", "global_window_scans", "kernel_width_voxels",
                                 "min_state_probability", "min_otsu_score", "transition_epsilon",
                                 "dynamic_window_scans", "distance_field_scans"));
  EXPECT_EQ(json.at("settings").at("occupancy_sigma_m"), 0.3);
  EXPECT_EQ(json.at("settings").at("delay_scans"), 2);
  EXPECT_EQ(json.at("settings").at("variant"), "paper-2024");
  EXPECT_EQ(json.at("method").at("kind"), "hmm-mos");
  EXPECT_EQ(json.at("format"), 3);
  EXPECT_EQ(json.at("protocol").at("name"), "semantickitti-mos");
  EXPECT_THAT(json.at("remarks").dump(), HasSubstr("the last 2 scans have no 2 later ones"));
  EXPECT_EQ(json.at("scans_without_detection").back(), cli::stem(kScansOfRun - 2));
  EXPECT_EQ(json.at("provenance").at("fingerprint").get<std::string>().size(), 32U);
  for (const char* key : {"provenance", "places", "summary", "timing"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
}

TEST_F(Run, LayersTheCommandLineOverTheFileOverThePreset) {
  const fs::path config =
      folder_.write("near.json", R"({"max_range_m": 30.0, "voxel_size_m": 0.5})");
  const cli::Answer answer =
      cli::run(command("out", {"--config", config.string(), "--set", "voxel_size_m=0.4"}));
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  const auto effective = result("out").at("settings");
  EXPECT_EQ(effective.at("min_range_m"), 1.5);
  EXPECT_EQ(effective.at("max_range_m"), 30.0);
  EXPECT_EQ(effective.at("voxel_size_m"), 0.4);
}

TEST_F(Run, GivesTheSameBytesForAnyThreadCount) {
  for (const std::vector<std::string>& extra :
       {std::vector<std::string>{}, {"--set", "delay_scans=3"}}) {
    const std::string name = "out" + std::to_string(extra.size());
    std::vector<std::vector<std::pair<std::string, std::string>>> written;
    for (const char* threads : {"1", "2", "7"}) {
      std::vector<std::string> more = {"--threads", threads};
      more.insert(more.end(), extra.begin(), extra.end());
      const cli::Answer answer = cli::run(command(name + threads, more));
      ASSERT_EQ(answer.exit_code, 0) << answer.err;
      written.push_back(cli::contents(folder_ / (name + threads)));
    }
    ASSERT_EQ(written[0].size(), kScansOfRun + 3);
    EXPECT_EQ(written[0], written[1]);
    EXPECT_EQ(written[0], written[2]);
  }
}

TEST_F(Run, JsonAnswerIsOnePureObject) {
  const cli::Answer answer = cli::run(command("out", {"--json", "--protocol", "sipailou"}));
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  const auto json = nlohmann::ordered_json::parse(answer.out);
  EXPECT_EQ(json.at("protocol"), "sipailou");
  const auto summary = json.at("sequences").at(0).at("summary");
  EXPECT_EQ(summary, result("out").at("summary"));
  EXPECT_EQ(summary.at("labelled_scans"), kScansOfRun);
  const double tp = summary.at("tp");
  EXPECT_DOUBLE_EQ(summary.at("iou"),
                   tp / (tp + summary.at("fp").get<double>() + summary.at("fn").get<double>()));
}

TEST_F(Run, WithoutTruthWritesLabelsAndSaysSo) {
  fs::remove_all(folder_ / "room/labels");
  const cli::Answer answer = cli::run(command("out"));
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.out, HasSubstr("no scan has truth: nothing to score\n"));
  std::size_t moving = 0;
  const auto scans = result("out").at("scans");
  for (const auto& scan : scans) {
    moving += scan.at("predicted_moving_points").get<std::size_t>();
  }
  EXPECT_GT(moving, 0U);
  EXPECT_THAT(answer.out, testing::ContainsRegex("room +12 +" +
                                                 std::to_string(kScansOfRun * cli::kPointsPerScan) +
                                                 " +" + std::to_string(moving) + " "));
  const auto json = nlohmann::ordered_json::parse(cli::run(command("out", {"--json"})).out);
  EXPECT_EQ(json.at("sequences").at(0).at("predicted_moving_points"), moving);
  EXPECT_TRUE(result("out").at("summary").is_null());
  EXPECT_FALSE(result("out").at("scans").at(0).contains("tp"));
}

TEST_F(Run, SaysWhichScansWereNotJudgedAndWhy) {
  ASSERT_EQ(cli::run(command("out", {"--set", "delay_scans=4"})).exit_code, 0);
  const auto unjudged = result("out").at("scans_without_detection");
  ASSERT_FALSE(unjudged.empty());
  const std::string remarks = result("out").at("remarks").dump();
  EXPECT_THAT(remarks, HasSubstr(std::to_string(unjudged.size()) +
                                 " of 12 scans are labelled static without detection, because the "
                                 "method has seen too few scans before or after them: " +
                                 unjudged.at(0).get<std::string>()));
}

TEST_F(Run, SpeaksOfOneScanInTheSingular) {
  cli::write_small_sequence(folder_ / "one", 1);
  const cli::Answer run = cli::run({"run", (folder_ / "one").string(), "--dataset", "semantickitti",
                                    "--out", (folder_ / "out").string()});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("1 of 1 scan is labelled static without detection"));
}

TEST_F(Run, TakesARootOfSeveralSequencesAndASelection) {
  for (const char* name : {"00", "01"}) {
    cli::write_small_sequence(folder_ / "root/sequences" / name, 6);
  }
  const std::string root = (folder_ / "root").string();
  const std::string out = (folder_ / "out").string();
  ASSERT_EQ(cli::run({"run", root, "--out", out, "--sequences", "01"}).exit_code, 0);
  EXPECT_FALSE(fs::exists(folder_ / "out/00"));
  EXPECT_TRUE(fs::exists(folder_ / "out/01/result.json"));
  const cli::Answer both = cli::run({"run", root, "--out", out, "--sequences", "00,01"});
  ASSERT_EQ(both.exit_code, 0) << both.err;
  EXPECT_THAT(both.err, HasSubstr("01: finished by an earlier run, kept"));
  EXPECT_TRUE(fs::exists(folder_ / "out/00/result.json"));
}

TEST_F(Run, RefusesAWrongConfigurationWithExitCode2) {
  const std::string not_json = folder_.write("a.json", "{").string();
  const std::string array = folder_.write("b.json", "[1]").string();
  const std::string twice =
      folder_.write("c.json", R"({"delay_scans": 1, "delay_scans": 2})").string();
  const std::string wrong_type = folder_.write("d.json", R"({"delay_scans": "2"})").string();
  struct Case {
    std::vector<std::string> flags;
    const char* message;
  };
  for (const Case& wrong : std::vector<Case>{
           {{"--set", "voxel_size=0.2"}, "nearest: voxel_size_m"},
           {{"--set", "voxel_size_m"}, "expected key=value"},
           {{"--set", "voxel_size_m=big"}, "is not a number, expected 0.01 to 10"},
           {{"--set", "voxel_size_m=-1"}, "voxel_size_m: -1 is out of range, expected 0.01 to 10"},
           {{"--set", "delay_scans=1.5"}, "delay_scans: 1.5 is not a whole number"},
           {{"--set", "delay_scans=99999999999999999999"}, "expected 0 to 1000"},
           {{"--set", "kernel_width_voxels=4"}, "kernel_width_voxels: 4 is even"},
           {{"--set", "min_range_m=60"}, "min_range_m"},
           {{"--set", "delay_scans=2", "--variant", "release-2025"}, "delay_scans"},
           {{"--config", not_json}, "a.json"},
           {{"--config", array}, "b.json: holds a array"},
           {{"--config", twice}, "c.json: key \"delay_scans\" is there twice"},
           {{"--config", wrong_type}, "d.json: delay_scans: \"2\" is not a whole number"},
           {{"--config", (folder_ / "absent.json").string()}, "absent.json: cannot be opened"},
           {{"--preset", "doals-20"}, "nearest: doals-20m"},
           {{"--variant", "paper"}, "expected paper-2024 or release-2025"},
           {{"--dataset", "kitti"}, "expected auto, doals"},
           {{"--protocol", "semantickitti"}, "semantickitti-mos"},
           {{"--range", "1,20"}, "counts points at every range"},
           {{"--protocol", "doals-hmm", "--range", "20,1"}, "expected MIN,MAX"},
           {{"--sequences", "nowhere"}, "nowhere"}}) {
    const cli::Answer answer = cli::run(command("out", wrong.flags));
    EXPECT_EQ(answer.exit_code, 2) << wrong.message << "\n" << answer.err;
    EXPECT_THAT(answer.err, HasSubstr("mosbench: ")) << wrong.message;
    EXPECT_THAT(answer.err, HasSubstr(wrong.message));
    EXPECT_FALSE(fs::exists(folder_ / "out")) << wrong.message;
  }
}

TEST_F(Run, ScoresARangeLimitedProtocolOverTheRangeOfTheRun) {
  const cli::Answer answer =
      cli::run(command("out", {"--protocol", "doals-hmm", "--preset", "doals-120m", "--json"}));
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  const auto json = nlohmann::ordered_json::parse(answer.out);
  EXPECT_EQ(json.at("min_range_m"), 0.5);
  EXPECT_EQ(json.at("max_range_m"), 120.0);
}

}  // namespace
}  // namespace mosbench
