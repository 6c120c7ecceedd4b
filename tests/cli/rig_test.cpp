#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/cli/program.hpp"
#include "tests/rig_drive.hpp"

/// Several LiDARs of a bag, from the command line.
namespace mosbench {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class RigInABag : public testing::Test {
 protected:
  void SetUp() override { folder_.write("drive.bag", drive_.bag()); }
  std::string path(const char* name) const { return (folder_ / name).string(); }
  cli::Answer run(std::vector<std::string> words, const char* lidars = "/a,/b") const {
    words.insert(words.begin() + 1, path("drive.bag"));
    words.insert(words.end(), {"--read", std::string("lidars=") + lidars});
    return cli::run(words);
  }

  RigDrive drive_{.scans = 8};
  TempFolder folder_;
};

TEST_F(RigInABag, IsSegmentedAsOneAndSaysSo) {
  const cli::Answer answer = run({"run", "--out", path("out")});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  const auto json = nlohmann::json::parse(read_file(folder_ / "out/drive/result.json"));
  EXPECT_EQ(json.at("reading").at("lidars"),
            "/a, /b mounted at (-2.000, 0.000, 0.000) m, turned by 85.9 degrees")
      << json.dump(1);
  EXPECT_EQ(json.at("reading").at("deskew"), "poses");
  EXPECT_THAT(json.dump(), HasSubstr("rays start at each point's own"));
  const std::size_t points = drive_.scan(0, 3).labels.size() + drive_.scan(1, 3).labels.size();
  EXPECT_EQ(read_file(folder_ / "out/drive/labels/000003.label").size(), 4 * points);
  // The same command resumes, and another rig is not taken for this one.
  EXPECT_EQ(run({"run", "--out", path("out")}).exit_code, 0);
  EXPECT_NE(run({"run", "--out", path("out")}, "/b,/a").exit_code, 0);
  EXPECT_EQ(cli::run({"report", path("out"), "-o", path("out.html")}).exit_code, 0);
}

TEST_F(RigInABag, IsReadByEveryCommand) {
  EXPECT_LE(run({"doctor"}).exit_code, 1);
  EXPECT_LE(run({"odometry", "-o", path("poses.tum")}).exit_code, 1);
  EXPECT_EQ(run({"run", "--out", path("1"), "--perturb", "dropout_probability=0.5"}).exit_code, 0);
  EXPECT_EQ(run({"run", "--out", path("2"), "--refine-poses"}).exit_code, 0);
  EXPECT_EQ(run({"run", "--out", path("3"), "--odometry", "kiss"}).exit_code, 0);
  EXPECT_EQ(run({"profile"}).exit_code, 0);
}

TEST_F(RigInABag, NeedsLidarsToBeNamed) {
  const cli::Answer answer = cli::run({"run", path("drive.bag"), "--out", path("out")});
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.err,
              HasSubstr("holds several PointCloud2 topics: /a, /b, expected one of them, --topic "
                        "/a, or two to six of a rig, which are merged: --read lidars=/a,/b"));
  EXPECT_EQ(run({"run", "--out", path("out")}, "/b").exit_code, 0);
}

TEST_F(RigInABag, IsRefusedByMethodsThatLookFromOnePlace) {
  const cli::Answer answer = run({"run", "--out", path("out"), "--method", "yoon"});
  EXPECT_EQ(answer.exit_code, 2);
  EXPECT_THAT(answer.err,
              AllOf(HasSubstr("mosbench: yoon looks from one place, not from those of /a, /b "
                              "mounted at (-2.000, 0.000, 0.000) m, turned by 85.9 degrees, "
                              "expected one LiDAR, --read lidars=NAME, or one of "
                              "the methods hmm-mos, hmm-mos-plus, dufomap, octomap"),
                    Not(HasSubstr("scan 000"))));
}

TEST_F(RigInABag, LeavesOutMethodsThatLookFromOnePlaceOfSeveral) {
  const cli::Answer answer =
      run({"run", "--out", path("out"), "--method", "yoon,hmm-mos,underwood"});
  EXPECT_EQ(answer.exit_code, 0) << answer.err;
  const std::string left_out =
      "left out: yoon, underwood, which look from one place, not from several LiDARs";
  EXPECT_THAT(answer.out, AllOf(HasSubstr(left_out), HasSubstr("HMM-MOS, preset recording")));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out/yoon"));
  const auto json = nlohmann::json::parse(
      run({"run", "--out", path("out"), "--method", "yoon,hmm-mos,underwood", "--json"}).out);
  EXPECT_EQ(json.at("notes"), nlohmann::json::array({left_out}));
  EXPECT_EQ(json.at("methods").size(), 1U);
  // None is left to run.
  const cli::Answer none = run({"run", "--out", path("no"), "--method", "yoon,underwood"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("underwood looks from one place"));
}

TEST_F(RigInABag, IsDoubtedWhereItsLidarsDoNotFit) {
  drive_.write_folders(folder_, "rig");
  const auto call = [&](std::vector<std::string> words) {
    words.insert(words.begin() + 1, {path("rig"), "--read", "lidars=a,b"});
    return cli::run(words);
  };
  const std::string misfit = "b does not fit a: scan matching puts it ";
  EXPECT_THAT(call({"doctor"}).out, Not(HasSubstr(misfit)));
  folder_.write("rig/mounts.txt", "a 1 0 0 0 0 0 1\nb -1 0 0 0 0 0.731689 -0.681639\n");
  const cli::Answer doctor = call({"doctor"});
  EXPECT_EQ(doctor.exit_code, 1);
  EXPECT_THAT(doctor.out, HasSubstr("warning: rig: " + misfit));
  for (const char* odometry : {"", "kiss"}) {
    std::vector<std::string> words = {"run", "--out", path("out") + odometry};
    if (*odometry != '\0') words.insert(words.end(), {"--odometry", odometry});
    ASSERT_EQ(call(words).exit_code, 0);
    const auto result =
        nlohmann::json::parse(read_file(path("out") + odometry + "/rig/result.json"));
    EXPECT_THAT(result.at("doubts").dump(), HasSubstr(misfit)) << odometry;
  }
  EXPECT_THAT(call({"score", "--predictions", path("out")}).out, HasSubstr(misfit));
  const cli::Answer copy = call({"convert", "--layout", "semantickitti", "--out", path("copy")});
  EXPECT_THAT(copy.out + copy.err, HasSubstr(misfit));
}

TEST_F(RigInABag, IsDoubtedForAProgramThatLearnsNoOrigins) {
  const std::string program = std::string("exec:") + MOSBENCH_BINARY_DIR + "/examples/exec_client";
  const cli::Answer answer = run({"run", "--out", path("out"), "--method", program});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(read_file(folder_ / "out/drive/result.json"),
              HasSubstr("the program is not told at which LiDAR each ray starts"));
}

TEST_F(RigInABag, HasFoldersThatAreNamed) {
  drive_.write_folders(folder_, "rig");
  for (const char* command : {"doctor", "run"}) {
    const cli::Answer answer = cli::run({command, path("rig")});
    EXPECT_EQ(answer.exit_code, 3);
    EXPECT_THAT(answer.out + answer.err,
                HasSubstr("rig: holds scans in the folders a,b, expected one of them, --read "
                          "lidars=a, or LiDARs of one vehicle, which are merged: --read "
                          "lidars=a,b, with times.txt in each, beside mounts.txt with a row for "
                          "each: name tx ty tz qx qy qz qw of vehicle_from_lidar, metres"));
  }
}

TEST_F(RigInABag, LosesItsOriginsInACopyWhichSaysSo) {
  const cli::Answer answer = run({"convert", "--layout", "semantickitti", "--out", path("copy")});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.err, HasSubstr("8 scans were merged of several LiDARs: in the copy, rays of "
                                    "all points start at the first"));
  const cli::Answer copy = cli::run({"run", path("copy"), "--out", path("out")});
  ASSERT_EQ(copy.exit_code, 0) << copy.err;
  EXPECT_THAT(copy.out + copy.err,
              HasSubstr("rays of all points start at the first LiDAR, as the copy does not keep "
                        "which are whose: of /a, /b mounted at (-2.000, "));
}

TEST_F(RigInABag, NeedsMounts) {
  folder_.write("drive.bag", drive_.bag(1));
  const cli::Answer answer = run({"run", "--out", path("out")});
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.err,
              HasSubstr("no transform that never changes leads from lidar_b to lidar_a (base, "
                        "lidar_a), expected the mounts of both in /tf_static, or one LiDAR in "
                        "--read lidars"));
}

}  // namespace
}  // namespace mosbench
