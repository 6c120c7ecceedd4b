#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "datasets/formats/times_file.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;

/// Data in a folder whose name a shell would take apart, with poses and without.
class Suggestions : public testing::Test {
 protected:
  void SetUp() override {
    cli::write_small_sequence(path("set/sequences/00"), 6);
    cli::write_small_sequence(path("bare"), 6);
    cli::write_small_sequence(path("set/sequences/01"), 6);
    std::filesystem::remove(path("bare/poses.txt"));
    std::filesystem::copy(path("bare/labels"), path("predicted"));
  }

  std::string path(const std::string& name) const {
    return folder_ / ("it's my \"$data\"/" + name);
  }

  /// Commands in the text of an answer: lines of their own after two blanks.
  static std::vector<std::string> commands_in(const std::string& text) {
    std::vector<std::string> commands;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("  mosbench ")) commands.push_back(line.substr(2));
    }
    return commands;
  }

  /// Runs a line as a user does who copies it into a shell.
  void run_as_printed(const std::string& line) const {
    folder_.write("line.sh", line + '\n');
    const std::filesystem::path program = MOSBENCH_PROGRAM;
    const int status =
        std::system(fmt::format("cd {} && PATH={}:$PATH sh ./line.sh > log 2>&1",
                                folder_.path().string(), program.parent_path().string())
                        .c_str());
    // 1 is a finding, such as a doubtful pose.
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) <= 1) << line << '\n'
                                                               << read_file(folder_ / "log");
  }

  /// Asks the program, runs what it suggests, and returns that.
  std::string suggested_by(const std::vector<std::string>& arguments, std::size_t count) const {
    const cli::Answer answer = cli::run(arguments);
    const std::vector<std::string> commands = commands_in(answer.out + answer.err);
    EXPECT_EQ(commands.size(), count) << answer.out << answer.err;
    std::string all;
    for (const std::string& command : commands) {
      run_as_printed(command);
      all += command + '\n';
    }
    std::filesystem::remove_all(folder_ / "results");
    std::filesystem::remove_all(folder_ / "found-poses");
    return all;
  }

  TempFolder folder_;
};

TEST_F(Suggestions, OfTheDoctorRun) {
  EXPECT_THAT(suggested_by({"doctor", path("set"), "--sequences", "01"}, 1),
              HasSubstr(" --sequences 01"));
  EXPECT_THAT(
      suggested_by({"doctor", path("bare"), "--dataset", "semantickitti", "--deskew", "none"}, 1),
      testing::AllOf(HasSubstr("mosbench run "), HasSubstr(" --dataset semantickitti"),
                     HasSubstr(" --deskew none --odometry simple")));
}

TEST_F(Suggestions, OfTheDoctorReadPosesByTheClockOfTheScans) {
  std::string poses;
  std::vector<std::int64_t> stamps_ns;
  for (int k = 0; k < 6; ++k) {
    stamps_ns.push_back(k * 100'000'000);
    poses += fmt::format("{:.2f} 0 0 0 0 0 0 1\n", 0.1 * k + 0.08);
  }
  write_times(path("bare/times.txt"), stamps_ns);
  folder_.write("late.tum", poses);
  const std::vector<std::string> doctor = {"doctor", path("bare"), "--poses", folder_ / "late.tum"};
  EXPECT_EQ(cli::run(doctor).exit_code, 1);
  EXPECT_THAT(suggested_by(doctor, 1), HasSubstr(" --read pose_offset_s=-0.08\n"));
  std::vector<std::string> mended = doctor;
  mended.insert(mended.end(), {"--read", "pose_offset_s=-0.08"});
  const cli::Answer sound = cli::run(mended);
  EXPECT_EQ(sound.exit_code, 0) << sound.out;
  EXPECT_THAT(sound.out, testing::AllOf(HasSubstr("by stamp, 0 of 6 interpolated"),
                                        HasSubstr("  pose_offset_s   -0.08")));
  // Poses without stamps have no clock.
  mended[3] = path("set/sequences/00/poses.txt");
  const cli::Answer rows = cli::run(mended);
  EXPECT_EQ(rows.exit_code, 2);
  EXPECT_THAT(rows.err, HasSubstr("--read pose_offset_s: the poses of bare are not looked up by "
                                  "stamps, expected those of a TUM file or a bag"));
}

TEST_F(Suggestions, ForScansWithoutPosesCarryTheFlagsAndRun) {
  EXPECT_THAT(suggested_by({"run", path("bare"), "--preset", "best", "--set", "voxel_size_m=0.4",
                            "--out", path("my runs")},
                           1),
              testing::AllOf(HasSubstr(" --preset best --set voxel_size_m=0.4 --out "),
                             HasSubstr(" --odometry simple")));
  EXPECT_TRUE(is_there(path("my runs/bare/result.json")));
  suggested_by({"convert", path("bare"), "--layout", "sipailou", "--out", path("converted")}, 1);
  EXPECT_THAT(suggested_by({"score", path("bare"), "--predictions", path("predicted"), "--deskew",
                            "none", "--dataset=semantickitti"},
                           2),
              HasSubstr(" --dataset semantickitti --deskew none -o found-poses\n"));
  suggested_by({"profile", path("bare"), "--scans", "2"}, 2);
}

TEST_F(Suggestions, OfOdometryRunOnTheSameSequences) {
  EXPECT_THAT(suggested_by({"odometry", path("bare"), "-o", path("found poses.txt")}, 1),
              HasSubstr("found poses.txt"));
  EXPECT_THAT(suggested_by({"odometry", path("set"), "--sequences", "00", "--dataset",
                            "semantickitti", "-o", path("of 00.txt")},
                           1),
              HasSubstr(" --dataset semantickitti --sequences 00 --poses "));
}

TEST_F(Suggestions, NameAFormatForPosesOfScansWithoutStamps) {
  const cli::Answer tum = cli::run({"odometry", path("bare"), "-o", path("p.tum")});
  EXPECT_EQ(tum.exit_code, 2);
  EXPECT_THAT(tum.err, HasSubstr("expected kitti:FILE or a file called *.txt"));
}

TEST_F(Suggestions, OfTrajectoryKeepTheFlags) {
  const std::string poses = path("set/sequences/00/poses.txt");
  const std::string truth = path("set/sequences/01/poses.txt");
  EXPECT_THAT(suggested_by({"trajectory", poses, truth, "--align", "origin"}, 1),
              HasSubstr(" --align origin"));
}

TEST_F(Suggestions, OfAStudyRun) {
  write_file_atomic(path("s.yaml"), R"(name: s
protocol: sipailou
data: {name: small, path: set, dataset: semantickitti, sequences: ["00"]}
methods: [underwood]
)");
  const std::vector<std::string> study = {path("s.yaml"), "--out", path("out")};
  const auto ask = [&](std::vector<std::string> words) {
    words.insert(words.end(), study.begin(), study.end());
    return cli::run(words);
  };
  const auto plan = nlohmann::json::parse(ask({"run", "--dry-run", "--json"}).out);
  const std::string key = plan.at("cells").at(0).at("key");
  ASSERT_EQ(cli::run({"run", path("s.yaml"), "--only", key, "--out", path("out")}).exit_code, 0);
  const auto table = nlohmann::json::parse(ask({"rank", "--as", "json"}).out);
  ASSERT_FALSE(table.at("worst").empty());
  run_as_printed(table.at("worst").at(0).at("command"));
  EXPECT_TRUE(is_there(folder_ / "worst.html"));
}

}  // namespace
}  // namespace mosbench
