#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/cli/program.hpp"

namespace mosbench {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// A simulated room from a tripod, or from a robot that drives, without poses.
class FixedLidar : public testing::Test {
 protected:
  std::string simulate(const std::string& carrier, const nlohmann::json& legs) const {
    const auto make = [&](const std::string& scene, const std::string& scans,
                          const std::string& out) {
      const auto answer = cli::run({"simulate", "--layout", "semantickitti", "--scene", scene,
                                    "--scans", scans, "--seed", "1", "--out", out});
      EXPECT_EQ(answer.exit_code, 0) << answer.err;
    };
    make("room", "1", folder_ / "near");
    auto scene = nlohmann::json::parse(read_file(folder_ / "near/scene.json"));
    scene["ego"]["carrier"] = carrier;
    scene["ego"]["route"]["legs"] = legs;
    scene["ego"]["route"]["after"] = "stay";
    folder_.write(carrier + ".json", scene.dump());
    make(folder_ / (carrier + ".json"), "16", folder_ / carrier);
    const std::string sequence = folder_ / (carrier + "/sequences/08");
    EXPECT_TRUE(std::filesystem::remove(sequence + "/poses.txt"));
    return sequence;
  }

  TempFolder folder_;
};

TEST_F(FixedLidar, IsFoundWithoutPosesAndSaid) {
  const std::string data = simulate("tripod", nlohmann::json::array());
  const std::string found = "no poses: scan matching finds the sensor standing still (";
  const cli::Answer run = cli::run({"run", data, "--out", folder_ / "found"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("08: " + found));
  EXPECT_THAT(run.out, HasSubstr(" degrees over 16 scans), taken as static\n"));
  EXPECT_EQ(cli::run({"run", data, "--poses", "static", "--out", folder_ / "told"}).exit_code, 0);
  const auto labels = cli::contents(folder_ / "found/08/labels");
  EXPECT_EQ(labels.size(), 16U);
  EXPECT_EQ(labels, cli::contents(folder_ / "told/08/labels"));
  const auto result = cli::timeless_result(folder_ / "found/08");
  EXPECT_EQ(result.at("reading").at("poses"), "static");
  // What scan matching found it is not asked again.
  EXPECT_THAT(cli::run({"doctor", data}).out, AllOf(HasSubstr(found), Not(HasSubstr("\n  fit "))));
  EXPECT_THAT(cli::run({"doctor", data, "--poses", "static"}).out, HasSubstr("\n  fit "));
  // Who asks for something of poses has some.
  for (const char* asked :
       {"map_frame=odom", "pose_topic=/odom", "pose_frame=lidar", "pose_direction=map-from-sensor",
        "pose_format=tum", "pose_offset_s=0.1"}) {
    const cli::Answer refused =
        cli::run({"run", data, "--read", asked, "--out", folder_ / "asked"});
    EXPECT_EQ(refused.exit_code, 3) << asked;
    EXPECT_THAT(refused.err, HasSubstr("poses.txt: does not exist")) << asked;
  }
}

TEST_F(FixedLidar, IsNotFoundWhereTheSensorMoves) {
  const std::string data =
      simulate("ground-robot", {{{"to_m", {2.0, 0.0}}, {"speed_m_s", 0.2}, {"wait_s", 0.0}}});
  const cli::Answer run = cli::run({"run", data, "--out", folder_ / "out"});
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_THAT(run.err, HasSubstr("poses.txt: does not exist, expected one pose per scan there"));
  EXPECT_THAT(run.err, Not(HasSubstr("standing still")));
  EXPECT_EQ(cli::run({"doctor", data}).exit_code, 3);
}

}  // namespace
}  // namespace mosbench
