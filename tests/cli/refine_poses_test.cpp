#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "datasets/formats/pose_file.hpp"
#include "tests/cli/program.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

/// A simulated street, its poses, and poses that drift by 3 cm a scan.
class RefinedPosesCommand : public testing::Test {
 protected:
  static constexpr std::size_t kScans = 14;

  void SetUp() override {
    const cli::Answer made =
        run({"simulate", "--layout", "semantickitti", "--scene", "street", "--scans",
             std::to_string(kScans), "--seed", "3", "--out", path("sim")});
    ASSERT_EQ(made.exit_code, 0) << made.err;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / "sim")) {
      if (entry.path().filename() == "poses.txt") own_ = entry.path();
    }
    std::vector<Pose> poses = read_poses(own_);
    ASSERT_EQ(poses.size(), kScans);
    for (std::size_t k = 0; k < kScans; ++k) {
      poses[k].translation() += 0.03 * static_cast<double>(k) * poses[0].linear().col(0);
    }
    write_poses(folder_ / "drifting.txt", poses);
  }

  static cli::Answer run(const std::vector<std::string>& arguments) { return cli::run(arguments); }
  std::string path(const char* name) const { return (folder_ / name).string(); }
  ordered_json result(const char* out) const { return cli::timeless_result(folder_ / out / "08"); }

  TempFolder folder_;
  std::filesystem::path own_;
};

TEST_F(RefinedPosesCommand, SaysHowFarPosesMovedAndKeepsItInTheResult) {
  const std::vector<std::string> drifting = {"run",   path("sim"), "--poses", path("drifting.txt"),
                                             "--out", path("runs")};
  std::vector<std::string> refining = drifting;
  refining.emplace_back("--refine-poses");
  const cli::Answer answer = run(refining);
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.out, AllOf(HasSubstr("poses refined: moved by "), HasSubstr("at most "),
                                HasSubstr("neighbouring scans fit within ")));
  EXPECT_EQ(result("runs").at("reading").at("pose_refinement"), "registration to the scans before");
  // Poses as given are another run.
  const cli::Answer mixed = run(drifting);
  EXPECT_EQ(mixed.exit_code, 2);
  EXPECT_THAT(mixed.err, HasSubstr("pose_refinement"));
  const cli::Answer report =
      run({"report", path("runs"), "-o", path("report.html"), "--scans", "2"});
  EXPECT_EQ(report.exit_code, 0) << report.err;
  EXPECT_THAT(read_file(folder_ / "report.html"), HasSubstr("poses refined: moved by "));
}

TEST_F(RefinedPosesCommand, KeepsPosesThatFit) {
  const cli::Answer answer = run({"run", path("sim"), "--refine-poses", "--out", path("runs")});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.out,
              HasSubstr("poses kept as given: registration of the scans is hardly better"));
  ASSERT_EQ(run({"run", path("sim"), "--out", path("given")}).exit_code, 0);
  EXPECT_EQ(cli::contents(folder_ / "runs/08/labels"), cli::contents(folder_ / "given/08/labels"));
}

TEST_F(RefinedPosesCommand, AreWrittenByOdometryAndConvert) {
  std::filesystem::copy(folder_ / "drifting.txt", own_,
                        std::filesystem::copy_options::overwrite_existing);
  const cli::Answer found =
      run({"odometry", path("sim"), "--refine-poses", "-o", path("refined.txt")});
  ASSERT_EQ(found.exit_code, 0) << found.err;
  EXPECT_THAT(found.out, AllOf(HasSubstr("14 poses by refining those given"),
                               HasSubstr(" --poses " + path("refined.txt")),
                               Not(HasSubstr("--refine-poses"))));
  EXPECT_EQ(read_poses(folder_ / "refined.txt").size(), kScans);
  ASSERT_EQ(run({"convert", path("sim"), "--refine-poses", "--layout", "semantickitti", "--out",
                 path("converted")})
                .exit_code,
            0);
  const cli::Answer next = run({"run", path("converted"), "--out", path("runs")});
  ASSERT_EQ(next.exit_code, 0) << next.err;
  EXPECT_THAT(result("runs").at("reading").at("pose_origin").get<std::string>(),
              HasSubstr("pose_refinement: registration"));
}

TEST_F(RefinedPosesCommand, NeedPosesAndNoOdometry) {
  const cli::Answer both =
      run({"run", path("sim"), "--refine-poses", "--odometry", "simple", "--out", path("runs")});
  EXPECT_EQ(both.exit_code, 2);
  EXPECT_THAT(both.err, HasSubstr("--refine-poses and --odometry: correct given poses and find new "
                                  "ones, expected one of them"));
  std::filesystem::remove(own_);
  const cli::Answer none = run({"run", path("sim"), "--refine-poses", "--out", path("runs")});
  EXPECT_EQ(none.exit_code, 3);
  EXPECT_THAT(none.err, AllOf(HasSubstr("poses.txt: does not exist"), HasSubstr("--odometry")));
}

TEST_F(RefinedPosesCommand, AreAKeyOfAJobInYaml) {
  write_file_atomic(folder_ / "job.yaml",
                    "name: job\n"
                    "data: {name: street, path: " +
                        path("sim") + ", reading: {poses: " + path("drifting.txt") +
                        ", refine_poses: on}}\n"
                        "methods: [hmm-mos]\n");
  const cli::Answer answer = run({"run", path("job.yaml"), "--out", path("job")});
  ASSERT_EQ(answer.exit_code, 0) << answer.out << answer.err;
  std::vector<std::string> refinements;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / "job")) {
    if (entry.path().filename() != "result.json") continue;
    const ordered_json json = ordered_json::parse(read_file(entry.path()));
    refinements.push_back(json.at("reading").value("pose_refinement", ""));
  }
  EXPECT_THAT(refinements, testing::ElementsAre(HasSubstr("registration")));
}

TEST_F(RefinedPosesCommand, StaticNeedsNoPosesAndDoubtsThoseThatMove) {
  const cli::Answer moving =
      run({"run", path("sim"), "--poses", "static", "--out", path("moving")});
  ASSERT_EQ(moving.exit_code, 0) << moving.err;
  EXPECT_EQ(result("moving").at("reading").at("poses"), "static");
  EXPECT_THAT(result("moving").at("doubts").dump(),
              HasSubstr(" m and are not used (--poses static)"));
  std::filesystem::remove(own_);
  ASSERT_EQ(run({"run", path("sim"), "--out", path("runs")}).exit_code, 3);
  const cli::Answer still = run({"run", path("sim"), "--poses", "static", "--out", path("runs")});
  ASSERT_EQ(still.exit_code, 0) << still.err;
  EXPECT_THAT(still.out,
              HasSubstr("the sensor is taken to stand still: every pose is the identity"));
  EXPECT_THAT(result("runs").value("doubts", ordered_json::array()).dump(),
              AllOf(Not(HasSubstr("equal")), Not(HasSubstr("not used"))));
  const cli::Answer doctor = run({"doctor", path("sim"), "--poses", "static"});
  EXPECT_EQ(doctor.exit_code, 1);
  EXPECT_THAT(doctor.out, HasSubstr("but the scans show that the sensor moves"));
  const cli::Answer both = run(
      {"run", path("sim"), "--poses", "static", "--odometry", "simple", "--out", path("other")});
  EXPECT_EQ(both.exit_code, 2);
}

}  // namespace
}  // namespace mosbench
