#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "datasets/files/pose_file.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;
using testing::HasSubstr;

class OdometryCommand : public testing::Test {
 protected:
  /// A simulated street, as given and without its poses.
  void SetUp() override {
    const cli::Answer answer =
        cli::run({"simulate", "--layout", "semantickitti", "--scene", "street", "--scans", "8",
                  "--seed", "3", "--out", (folder_ / "sim").string()});
    ASSERT_EQ(answer.exit_code, 0) << answer.err;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / "sim")) {
      if (entry.path().filename() == "poses.txt") truth_ = entry.path();
      if (entry.path().filename() == "calib.txt") calib_ = entry.path();
    }
    ASSERT_FALSE(truth_.empty());
    std::filesystem::rename(truth_, folder_ / "truth.txt");
    truth_ = folder_ / "truth.txt";
  }
  cli::Answer run(std::vector<std::string> arguments) const { return cli::run(arguments); }
  std::string path(const char* name) const { return (folder_ / name).string(); }

  TempFolder folder_;
  std::filesystem::path truth_, calib_;
};

TEST_F(OdometryCommand, FindsPosesThatTheTrajectoryCommandFindsGood) {
  for (const char* kind : {"simple", "kiss"}) {
    const cli::Answer found = run({"odometry", path("sim"), "-o", path("poses.txt"), "--odometry",
                                   kind, "--set", "min_range_m=3"});
    EXPECT_THAT(found.out, HasSubstr("8 poses"));
    // Doubtful poses make the exit code 1.
    const bool all_sure = found.out.find(" 0 doubtful") != std::string::npos;
    ASSERT_EQ(found.exit_code, all_sure ? 0 : 1) << found.out << found.err;
    // The layout keeps the poses of the camera, odometry finds those of the lidar.
    const cli::Answer score =
        run({"trajectory", path("poses.txt"), "--truth", truth_.string(), "--align", "origin",
             "--camera", "truth", "--calib", calib_.string(), "--json"});
    ASSERT_EQ(score.exit_code, 0) << score.err;
    const ordered_json json = ordered_json::parse(score.out);
    EXPECT_EQ(json.at("alignment"), "origin");
    EXPECT_GT(json.at("sequences")[0].at("path_m"), 3.0);
    // Point to point finds little to hold on to on the simulated road.
    const double most_m = std::string_view(kind) == "simple" ? 0.3 : 0.6;
    EXPECT_LT(json.at("sequences")[0].at("absolute").at("translation_m").at("max"), most_m);
    const cli::Answer table = run({"trajectory", path("poses.txt"), "--truth", truth_.string()});
    EXPECT_THAT(table.out, HasSubstr("alignment none"));
    const cli::Answer rows =
        run({"trajectory", path("poses.txt"), "--truth", truth_.string(), "--csv"});
    EXPECT_THAT(rows.out, HasSubstr("poses,7,"));
  }
}

TEST_F(OdometryCommand, PrintsCovarianceAndWritesTum) {
  const cli::Answer found = run({"odometry", path("sim"), "-o", path("poses.tum"), "--json"});
  ASSERT_EQ(found.exit_code, 0) << found.out << found.err;
  const ordered_json json = ordered_json::parse(found.out);
  EXPECT_EQ(json.at("odometry"), "simple");
  EXPECT_EQ(json.at("settings").at("gradient"), "analytic");
  const ordered_json& scan = json.at("sequences")[0].at("scans")[5];
  EXPECT_EQ(scan.at("covariance").size(), 6u);
  EXPECT_GT(scan.at("covariance")[3][3], 0.0);
  EXPECT_TRUE(scan.at("doubt").is_null());
  const cli::Answer score =
      run({"trajectory", path("poses.tum"), "--truth", path("poses.tum"), "--json"});
  ASSERT_EQ(score.exit_code, 0) << score.err;
  EXPECT_EQ(ordered_json::parse(score.out).at("sequences")[0].at("poses"), 8);
}

TEST_F(OdometryCommand, EndsWithOneWhenPosesAreDoubtful) {
  const cli::Answer found = run({"odometry", path("sim"), "-o", path("poses.txt"), "--set",
                                 "min_range_m=900", "max_range_m=901"});
  EXPECT_EQ(found.exit_code, 1);
  EXPECT_THAT(found.out, HasSubstr("8 doubtful"));
  EXPECT_THAT(found.out, HasSubstr("only 0 points between min_range_m and max_range_m"));
  for (const Pose& pose : read_poses(path("poses.txt")))
    EXPECT_TRUE(pose.isApprox(Pose::Identity()));
}

TEST_F(OdometryCommand, RefusesWhatIsWrong) {
  EXPECT_EQ(run({"odometry", path("sim"), "-o", path("p.txt"), "--odometry", "icp"}).exit_code, 2);
  EXPECT_EQ(run({"odometry", path("sim"), "-o", path("p.txt"), "--preset", "kitti"}).exit_code, 2);
  EXPECT_EQ(run({"odometry", path("sim"), "-o", path("p.txt"), "--set", "sigma_m=-1"}).exit_code,
            2);
  EXPECT_EQ(run({"odometry", path("nothing"), "-o", path("p.txt")}).exit_code, 3);
  EXPECT_EQ(run({"trajectory", path("none.txt"), "--truth", truth_.string()}).exit_code, 3);
  EXPECT_FALSE(std::filesystem::exists(path("p.txt")));
}

TEST_F(OdometryCommand, IsOfferedWherePosesAreMissing) {
  const cli::Answer answer = run({"run", path("sim"), "--out", path("runs")});
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.err, HasSubstr("--odometry simple"));
}

TEST_F(OdometryCommand, GivesARunItsPosesAndItsIdentity) {
  const std::vector<std::string> with_odometry = {"run",    path("sim"),      "--odometry",
                                                  "simple", "--odometry-set", "min_range_m=3",
                                                  "--out",  path("runs")};
  const cli::Answer first = run(with_odometry);
  ASSERT_EQ(first.exit_code, 0) << first.err;
  std::filesystem::path result;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / "runs")) {
    if (entry.path().filename() == "result.json") result = entry.path().parent_path();
  }
  const ordered_json json = cli::timeless_result(result);
  EXPECT_EQ(json.at("reading").at("poses"), "odometry simple");
  EXPECT_THAT(std::string(json.at("reading").at("pose_odometry")), HasSubstr("min_range_m=3"));
  const std::vector<Pose> poses = read_poses(result / "poses.txt");
  ASSERT_EQ(poses.size(), 8u);
  EXPECT_GT(poses.back().translation().norm(), 1.0);

  // Labels are those of a run that reads the same poses.
  const cli::Answer read = run({"run", path("sim"), "--poses", (result / "poses.txt").string(),
                                "--pose-frame", "lidar", "--out", path("read")});
  ASSERT_EQ(read.exit_code, 0) << read.err;
  const std::filesystem::path again =
      folder_ / "read" / std::filesystem::relative(result, folder_ / "runs");
  EXPECT_EQ(cli::contents(again / "labels"), cli::contents(result / "labels"));

  EXPECT_THAT(run(with_odometry).err, HasSubstr("finished by an earlier run, kept"));
  const cli::Answer report =
      run({"report", path("runs"), "-o", path("report.html"), "--scans", "2"});
  EXPECT_EQ(report.exit_code, 0) << report.err;

  std::vector<std::string> other = with_odometry;
  other[3] = "kiss";
  EXPECT_EQ(run(other).exit_code, 2);
}

TEST_F(OdometryCommand, IsRefusedNextToAPoseFileAndWithoutAName) {
  EXPECT_EQ(run({"run", path("sim"), "--odometry", "simple", "--poses", truth_.string(), "--out",
                 path("runs")})
                .exit_code,
            2);
  EXPECT_EQ(
      run({"run", path("sim"), "--odometry-set", "sigma_m=1", "--out", path("runs")}).exit_code, 2);
}

}  // namespace
}  // namespace mosbench
