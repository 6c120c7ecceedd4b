#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <mosbench/method.hpp>

#include "datasets/formats/bin_file.hpp"
#include "eval/job/method_choice.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// Runs of several methods on a small room.
class RunMethods : public testing::Test {
 protected:
  RunMethods() { cli::write_small_sequence(folder_ / "room", 8); }

  cli::Answer run(const std::string& methods, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {"run",   folder_ / "room", "--method",
                                      methods, "--out",          folder_ / "out"};
    words.insert(words.end(), more.begin(), more.end());
    return cli::run(words);
  }

  TempFolder folder_;
};

TEST_F(RunMethods, GiveTheFilesOfEachMethodRunAlone) {
  const cli::Answer answer = run("hmm-mos,underwood", {"--set", "max_range_m=15"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  for (const char* method : {"hmm-mos", "underwood"}) {
    const fs::path alone = folder_ / "alone" / method;
    ASSERT_EQ(cli::run({"run", folder_ / "room", "--method", method, "--out", alone, "--set",
                        "max_range_m=15"})
                  .exit_code,
              0);
    EXPECT_EQ(cli::contents(folder_ / "out" / method), cli::contents(alone));
    EXPECT_THAT(answer.err, HasSubstr(std::string(method) + ", room: scan 8/8"));
  }
  EXPECT_THAT(answer.err, HasSubstr("method underwood (2 of 2)"));
  EXPECT_THAT(answer.out, HasSubstr("results in " + (folder_ / "out/underwood").string()));
}

TEST_F(RunMethods, SayInEachBlockThatTheDataAreSimulated) {
  const std::string data = folder_ / "sim";
  ASSERT_EQ(cli::run({"simulate", "--layout", "semantickitti", "--scene", "room", "--scans", "4",
                      "--seed", "1", "--out", data})
                .exit_code,
            0);
  for (const char* format : {"text", "markdown", "html"}) {
    const cli::Answer answer = cli::run(
        {"run", data, "--method", "yoon,underwood", "--out", folder_ / "both", "--as", format});
    ASSERT_EQ(answer.exit_code, 0) << answer.err;
    const std::size_t second = answer.out.find("Underwood et al., preset");
    ASSERT_NE(second, std::string::npos) << answer.out;
    EXPECT_NE(answer.out.find("SIMULATED data"), std::string::npos);
    EXPECT_NE(answer.out.find("SIMULATED data", second), std::string::npos) << format;
  }
}

TEST_F(RunMethods, ShareThePosesThatOdometryFinds) {
  const std::vector<std::string> odometry = {"--odometry", "kiss", "--odometry-set",
                                             "min_range_m=1"};
  const cli::Answer answer = run("hmm-mos,underwood", odometry);
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  const std::string finding = "KISS-ICP of room: scan 8/8";
  const std::size_t first = answer.err.find(finding);
  ASSERT_NE(first, std::string::npos) << answer.err;
  EXPECT_EQ(answer.err.find(finding, first + 1), std::string::npos) << answer.err;
  for (const char* method : {"hmm-mos", "underwood"}) {
    const std::string alone = folder_ / "alone" / method;
    std::vector<std::string> words = {"run", folder_ / "room", "--method", method, "--out", alone};
    words.insert(words.end(), odometry.begin(), odometry.end());
    ASSERT_EQ(cli::run(words).exit_code, 0);
    EXPECT_TRUE(fs::exists(folder_ / "out" / method / "room/poses.txt"));
    EXPECT_EQ(cli::contents(folder_ / "out" / method), cli::contents(alone));
  }
}

TEST_F(RunMethods, KeepTheSequencesBeforeAnInterruption) {
  cli::write_small_sequence(folder_ / "two/sequences/00", 4);
  cli::write_small_sequence(folder_ / "two/sequences/01", 4);
  const fs::path scan = folder_ / "two/sequences/01/velodyne/000002.bin";
  const std::vector<Point> points = read_bin(scan);
  std::vector<Point> broken = points;
  broken.front().x = 9e5F;  // metres
  write_bin(scan, broken);
  const auto run_both = [&] {
    return cli::run({"run", folder_ / "two", "--method", "hmm-mos,underwood", "--out",
                     folder_ / "out", "--json"});
  };
  EXPECT_EQ(run_both().exit_code, 3);
  EXPECT_TRUE(fs::exists(folder_ / "out/hmm-mos/00/result.json"));
  EXPECT_FALSE(fs::exists(folder_ / "out/hmm-mos/01"));
  write_bin(scan, points);
  fs::remove_all(folder_ / "out/underwood/01");  // of the broken scan
  const cli::Answer again = run_both();
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(again.err, HasSubstr("hmm-mos, 00: finished by an earlier run, kept"));
  const auto sequences = nlohmann::json::parse(again.out).at("methods").at(0).at("sequences");
  EXPECT_TRUE(sequences.at(0).at("reused").get<bool>());
  EXPECT_FALSE(sequences.at(1).at("reused").get<bool>());
}

TEST_F(RunMethods, AreNamedWhereACommandTakesOneOfThem) {
  ASSERT_EQ(run("hmm-mos,underwood", {"--scores"}).exit_code, 0);
  const std::string out = folder_ / "out";
  const std::string folders = out + "/hmm-mos, " + out + "/underwood";
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"stats", out},
           {"curve", out},
           {"render", out, "--scan", "worst", "-o", folder_ / "worst.png"},
           {"breakdown", folder_ / "room", "--predictions", out},
           {"score", folder_ / "room", "--predictions", out}}) {
    const cli::Answer answer = cli::run(words);
    EXPECT_NE(answer.exit_code, 0) << words[0];
    EXPECT_THAT(answer.err, HasSubstr(folders)) << words[0];
  }
  EXPECT_EQ(cli::run({"stats", out + "/hmm-mos"}).exit_code, 0);
}

TEST_F(RunMethods, TakeSettingsOfTheirOwn) {
  const cli::Answer answer =
      run("hmm-mos,underwood",
          {"--set", "max_range_m=15,underwood.max_range_m=9", "hmm-mos.voxel_size_m=0.3"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  const auto config = [this](const char* method) {
    return cli::timeless_result(folder_ / "out" / method / "room").at("settings");
  };
  EXPECT_EQ(config("hmm-mos").at("max_range_m"), 15.0);
  EXPECT_EQ(config("hmm-mos").at("voxel_size_m"), 0.3);
  EXPECT_EQ(config("underwood").at("max_range_m"), 9.0);
}

TEST_F(RunMethods, AreKeptWhereTheyAreFinished) {
  ASSERT_EQ(run("underwood").exit_code, 0) << "a single method goes to the folder itself";
  EXPECT_TRUE(fs::exists(folder_ / "out/room/result.json"));
  fs::remove_all(folder_ / "out");
  ASSERT_EQ(run("underwood,yoon").exit_code, 0);
  fs::remove_all(folder_ / "out/yoon/room");
  const cli::Answer again = run("underwood,yoon", {"--json"});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  const auto methods = nlohmann::json::parse(again.out).at("methods");
  ASSERT_EQ(methods.size(), 2U);
  EXPECT_EQ(methods.at(0).at("method"), "underwood");
  EXPECT_TRUE(methods.at(0).at("sequences").at(0).at("reused").get<bool>());
  EXPECT_FALSE(methods.at(1).at("sequences").at(0).at("reused").get<bool>());
}

TEST_F(RunMethods, LeaveTheOthersWhereOneFails) {
  const fs::path scan = folder_ / "room/velodyne/000003.bin";
  std::vector<Point> points = read_bin(scan);
  points.front().x = 9e5F;  // metres
  write_bin(scan, points);
  const cli::Answer answer = run("hmm-mos,underwood", {"--json"});
  EXPECT_EQ(answer.exit_code, 3);
  const auto methods = nlohmann::json::parse(answer.out).at("methods");
  EXPECT_THAT(methods.at(0).at("failure").get<std::string>(), HasSubstr("000003.bin"));
  EXPECT_THAT(answer.err, HasSubstr("mosbench: method hmm-mos failed: "));
  EXPECT_FALSE(methods.at(1).contains("failure")) << methods.at(1);
  EXPECT_FALSE(fs::exists(folder_ / "out/hmm-mos/room"));
  EXPECT_TRUE(fs::exists(folder_ / "out/underwood/room/result.json"));
}

TEST_F(RunMethods, AreRefusedBeforeTheFirstScan) {
  struct Mistake {
    const char *methods, *setting, *error;
  };
  for (const Mistake& mistake :
       {Mistake{"underwood,yooon", "max_range_m=9", "'yooon' is not known"},
        Mistake{"underwood,", "max_range_m=9", "'' is not known"},
        Mistake{"yoon,underwood,yoon", "max_range_m=9", "names yoon twice"},
        Mistake{"hmm-mos,underwood", "yoon.max_range_m=3",
                "--set yoon.max_range_m=3: method 'yoon' is not run, expected one of hmm-mos, "
                "underwood"},
        Mistake{"hmm-mos,underwood", "voxel_size_m=0.3",
                "method underwood: --set voxel_size_m=0.3: key 'voxel_size_m' is not known"}}) {
    const cli::Answer answer = run(mistake.methods, {"--set", mistake.setting});
    EXPECT_EQ(answer.exit_code, 2) << mistake.methods;
    EXPECT_THAT(answer.err, HasSubstr(mistake.error));
    EXPECT_FALSE(fs::exists(folder_ / "out")) << mistake.methods;
  }
}

TEST_F(RunMethods, AreRanked) {
  ASSERT_EQ(run("underwood,hmm-mos", {"--set", "underwood.reference_offset_scans=3"}).exit_code, 0);
  const cli::Answer json = cli::run({"rank", folder_ / "out", "--format", "json"});
  ASSERT_EQ(json.exit_code, 0) << json.err;
  const auto rows = nlohmann::json::parse(json.out).at("rows");
  ASSERT_EQ(rows.size(), 2U);
  for (const auto& row : rows) {
    EXPECT_GT(row.at("ms_per_scan").get<double>(), 0.0);
    EXPECT_GT(row.at("memory_mb").get<double>(), 0.0);
    EXPECT_GT(row.at("all").at("iou").at("value").get<double>(), 0.0) << row;
  }
  const cli::Answer text = cli::run({"rank", folder_ / "out"});
  EXPECT_THAT(text.out, HasSubstr("Underwood et al."));
  EXPECT_EQ(cli::run({"leaderboard", folder_ / "out"}).out, text.out);
  EXPECT_EQ(cli::run({"help", "leaderboard"}).out, cli::run({"rank", "--help"}).out);
  EXPECT_THAT(text.out, HasSubstr("no interval of the difference of 2: 8 scans"));
  ASSERT_EQ(cli::run({"run", folder_ / "room", "--protocol", "mapmos", "--out", folder_ / "other"})
                .exit_code,
            0);
  const cli::Answer refused = cli::run({"rank", folder_ / "out", folder_ / "other"});
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_THAT(refused.err, HasSubstr("protocol is semantickitti-mos and mapmos"));
}

TEST_F(RunMethods, WithOneSettingAreRankedByTheirFolders) {
  for (const char* name : {"first", "second"}) {
    ASSERT_EQ(cli::run({"run", folder_ / "room", "--method", "underwood", "--out",
                        folder_.path() / "runs" / name})
                  .exit_code,
              0);
  }
  const auto board =
      nlohmann::json::parse(cli::run({"rank", folder_ / "runs", "--format", "json"}).out);
  ASSERT_EQ(board.at("rows").size(), 2U);
  const cli::Answer text = cli::run({"rank", folder_ / "runs"});
  EXPECT_EQ(text.exit_code, 0);
  EXPECT_THAT(text.out, HasSubstr("folder"));
  for (const char* name : {"runs/first", "runs/second"}) EXPECT_THAT(text.out, HasSubstr(name));
  // What takes one run names them.
  const cli::Answer refused = cli::run({"stats", folder_ / "runs"});
  EXPECT_EQ(refused.exit_code, 3);
}

TEST(MethodChoice, OfAllIsEveryMethodOfThisBuildButTwins) {
  const MethodChoice all = chosen_methods("all");
  std::vector<std::string> expected;
  for (const MethodKind& kind : methods()) {
    const bool is_left_out = kind.is_twin || (!all.notes.empty() && kind.name == "octomap");
    if (!is_left_out) expected.emplace_back(kind.name);
  }
  EXPECT_EQ(all.names, expected);
  EXPECT_GE(expected.size(), 6U);
  EXPECT_TRUE(find_method("hmm-mos-reference")->is_twin);
}

}  // namespace
}  // namespace mosbench
