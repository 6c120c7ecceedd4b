#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "tests/cli/program.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr const char* kNotice =
    "simulated data (scene room, seed 5): not comparable with published numbers";
constexpr const char* kMark =
    "SIMULATED data (scene room, seed 5): not comparable with published numbers";

class Simulate : public testing::Test {
 protected:
  cli::Answer simulate(const std::string& layout, const std::string& scene,
                       const std::string& out) const {
    return cli::run({"simulate", "--layout", layout, "--scene", scene, "--scans", "6", "--seed",
                     "5", "--out", (folder_ / out).string()});
  }

  TempFolder folder_;
};

TEST_F(Simulate, SaysHowItDisturbs) {
  const cli::Answer answer =
      cli::run({"simulate", "--layout", "semantickitti", "--scene", "room", "--scans", "2",
                "--seed", "5", "--perturb", "pose_noise_m=0.1", "--out", folder_ / "noisy"});
  EXPECT_THAT(answer.out, HasSubstr("seed 5, disturbed by pose_noise_m=0.1,seed=1, as "));
}

TEST_F(Simulate, GivesDataThatRunAndScoreTakeAndNeverPassForReal) {
  for (const std::string layout : {"doals", "sipailou", "helimos", "semantickitti", "nuscenes",
                                   "kitti-raw", "kitti-tracking"}) {
    const cli::Answer simulated = simulate(layout, "room", layout);
    ASSERT_EQ(simulated.exit_code, 0) << simulated.err;
    EXPECT_THAT(simulated.out, HasSubstr("simulated 6 scans of scene room, seed 5"));
    const std::string input = (folder_ / layout).string();
    const std::string out = (folder_ / ("out_" + layout)).string();
    const cli::Answer text = cli::run({"run", input, "--out", out});
    ASSERT_EQ(text.exit_code, 0) << text.err;
    EXPECT_THAT(text.out, HasSubstr(layout + " data set"));
    EXPECT_THAT(text.out, HasSubstr(kMark));
    const cli::Answer run = cli::run({"run", input, "--out", out, "--json"});
    const auto ran = nlohmann::json::parse(run.out);
    EXPECT_EQ(ran.at("simulated").at("notice"), kNotice);
    for (const auto& sequence : ran.at("sequences")) {
      const auto result = cli::timeless_result(sequence.at("folder").get<std::string>());
      EXPECT_EQ(result.at("provenance").at("simulated").at("notice"), kNotice);
    }
    EXPECT_THAT(cli::run({"score", input, "--predictions", out}).out, HasSubstr(kMark));
    const cli::Answer score = cli::run({"score", input, "--predictions", out, "--json"});
    ASSERT_EQ(score.exit_code, 0) << score.err;
    const auto scored = nlohmann::json::parse(score.out);
    ASSERT_EQ(scored.at("sequences").size(), ran.at("sequences").size());
    for (std::size_t i = 0; i < scored.at("sequences").size(); ++i) {
      EXPECT_EQ(scored.at("sequences")[i].at("summary"), ran.at("sequences")[i].at("summary"));
    }
  }
}

TEST_F(Simulate, GivesScansOfHeliprWithoutTruthThatRunAndDoctorTake) {
  ASSERT_EQ(simulate("helipr", "room", "sim").exit_code, 0);
  const std::string input = (folder_ / "sim").string();
  const cli::Answer run = cli::run({"run", input, "--out", (folder_ / "out").string(), "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto ran = nlohmann::json::parse(run.out);
  EXPECT_EQ(ran.at("simulated").at("notice"), kNotice);
  EXPECT_EQ(ran.at("sequences").at(0).at("name"), "room/Aeva");
  EXPECT_EQ(ran.at("sequences").at(1).at("name"), "room/Ouster");
  EXPECT_EQ(cli::run({"doctor", input}).exit_code, 0);
}

TEST_F(Simulate, GivesTheSameFilesForTheSameSeed) {
  ASSERT_EQ(simulate("semantickitti", "room", "a").exit_code, 0);
  ASSERT_EQ(simulate("semantickitti", "room", "b").exit_code, 0);
  const auto files = cli::contents(folder_ / "a");
  EXPECT_GT(files.size(), 12U);
  EXPECT_EQ(files, cli::contents(folder_ / "b"));
}

TEST_F(Simulate, RefusesWhatItDoesNotKnow) {
  const cli::Answer scene = simulate("doals", "rom", "out");
  EXPECT_EQ(scene.exit_code, 2);
  EXPECT_THAT(scene.err, HasSubstr("room"));
  const cli::Answer layout = simulate("kitti", "room", "out");
  EXPECT_EQ(layout.exit_code, 2);
  EXPECT_THAT(layout.err,
              HasSubstr("expected doals, sipailou, helimos, semantickitti, "
                        "opensceneflow, nuscenes, helipr, kitti-raw or kitti-tracking"));
  EXPECT_EQ(simulate("recording", "room", "out").exit_code, 2) << "is written by convert alone";
  const cli::Answer file = simulate("doals", folder_.write("scene.json", "{").string(), "out");
  EXPECT_EQ(file.exit_code, 3);
  EXPECT_THAT(file.err, HasSubstr("scene.json"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

/// As users gather sequences of several data sets in one.
TEST_F(Simulate, IsKnownOfACopyAndWhereALinkLeadsToIt) {
  ASSERT_EQ(simulate("semantickitti", "room", "a").exit_code, 0);
  std::filesystem::create_directories(folder_ / "mine/sequences");
  std::filesystem::copy(folder_ / "a/sequences/08", folder_ / "mine/sequences/00",
                        std::filesystem::copy_options::recursive);
  std::filesystem::create_directory_symlink(folder_ / "a/sequences/08",
                                            folder_ / "mine/sequences/01");
  const cli::Answer run = cli::run({"run", folder_ / "mine", "--out", folder_ / "out"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("SIMULATED data (scene room"));
  for (const char* name : {"out/00", "out/01"}) {
    EXPECT_TRUE(cli::timeless_result(folder_ / name).at("provenance").contains("simulated"));
  }
}

TEST_F(Simulate, TellsThatAScenesOwnTimePerScanIsLostInLayoutsWithoutStamps) {
  ASSERT_EQ(simulate("semantickitti", "room", "usual").exit_code, 0);
  auto scene = nlohmann::json::parse(read_file(folder_ / "usual/scene.json"));
  scene.at("scan_period_s") = 0.2;
  folder_.write("slow.json", scene.dump());
  const std::string slow = (folder_ / "slow.json").string();
  for (const auto& [layout, scans] :
       {std::pair{"sipailou", "6 scans"}, {"kitti-tracking", "6 scans"}, {"helimos", "24 scans"}}) {
    const cli::Answer lost = simulate(layout, slow, std::string("slow_") + layout);
    ASSERT_EQ(lost.exit_code, 0) << lost.err;
    EXPECT_THAT(lost.err,
                HasSubstr(std::string("the stamps of ") + scans + " are left out: layout " +
                          layout + " has none, its scans are 0.1 s apart"));
    EXPECT_THAT(simulate(layout, "room", std::string("usual_") + layout).err,
                Not(HasSubstr("stamps")));
  }
  for (const char* layout : {"semantickitti", "kitti-raw", "nuscenes"}) {
    const cli::Answer kept = simulate(layout, slow, std::string("slow_") + layout);
    ASSERT_EQ(kept.exit_code, 0) << kept.err;
    EXPECT_THAT(kept.err, Not(HasSubstr("stamps")));
  }
}

TEST_F(Simulate, NamesAnOutputFolderThatCannotBeMade) {
  folder_.write("out", "in the way");
  const cli::Answer answer = simulate("doals", "room", "out/below");
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.err, HasSubstr("out/below"));
}

}  // namespace
}  // namespace mosbench
