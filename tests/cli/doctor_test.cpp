#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

class DoctorCommand : public testing::Test {
 protected:
  DoctorCommand() { cli::write_small_sequence(folder_ / "room", 12); }
  std::string room() const { return (folder_ / "room").string(); }

  TempFolder folder_;
};

TEST_F(DoctorCommand, EndsWithAVerdictTheNextCommandAndItsExitCode) {
  const cli::Answer good = cli::run({"doctor", room()});
  EXPECT_EQ(good.exit_code, 0) << good.out;
  EXPECT_THAT(good.out,
              HasSubstr("Verdict: nothing wrong was found. Next\n  mosbench run " + room()));
  fs::remove(folder_ / "room/labels/000003.label");
  const cli::Answer doubtful = cli::run({"doctor", room()});
  EXPECT_EQ(doubtful.exit_code, 1);
  EXPECT_THAT(doubtful.out, HasSubstr("warning: room: 1 of 12 scans have no label: 000003"));
  EXPECT_THAT(doubtful.out, HasSubstr("Verdict: can be run"));
  fs::remove(folder_ / "room/velodyne/000003.bin");
  const cli::Answer unusable = cli::run({"doctor", room()});
  EXPECT_EQ(unusable.exit_code, 3);
  EXPECT_THAT(unusable.out, HasSubstr("the numbering of the scans lacks 1: 000003"));
  EXPECT_THAT(unusable.out, HasSubstr("12 pose rows for 11 scans"));
  EXPECT_THAT(unusable.out, HasSubstr("Verdict: cannot be used"));
}

TEST_F(DoctorCommand, ChecksScansThatHaveNoPosesYet) {
  fs::remove(folder_ / "room/poses.txt");
  const cli::Answer good = cli::run({"doctor", room()});
  EXPECT_EQ(good.exit_code, 3);
  EXPECT_THAT(good.out, HasSubstr("room: 12 scans, 12 labelled\n"));
  EXPECT_THAT(good.out, HasSubstr("returns         103680 of 103680 points in 12 scans"));
  EXPECT_THAT(good.out, Not(HasSubstr("overlap")));
  EXPECT_THAT(good.out, HasSubstr("Verdict: has no poses yet. Find them"));
  write_file_atomic(folder_ / "room/velodyne/000007.bin", "");
  fs::remove(folder_ / "room/labels/000007.label");
  const cli::Answer empty = cli::run({"doctor", room()});
  EXPECT_EQ(empty.exit_code, 3);
  EXPECT_THAT(empty.out, HasSubstr("1 of 12 scans hold no points, first 000007; expected"));
  EXPECT_THAT(empty.out, Not(HasSubstr("far smaller")));
  EXPECT_THAT(empty.out, HasSubstr("has no poses yet, and is doubtful until"));
}

TEST_F(DoctorCommand, ChecksThePosesOfSequencesBesideOneWithout) {
  for (const char* name : {"00", "01"}) {
    cli::write_small_sequence(folder_ / "data/sequences" / name, 12);
  }
  fs::remove(folder_ / "data/sequences/00/poses.txt");
  const cli::Answer answer = cli::run({"doctor", (folder_ / "data").string(), "--json"});
  EXPECT_EQ(answer.exit_code, 3);
  const auto json = nlohmann::json::parse(answer.out);
  ASSERT_EQ(json.at("sequences").size(), 2U);
  EXPECT_EQ(json.at("sequences")[0].at("name"), "00");
  EXPECT_TRUE(json.at("sequences")[0].at("poses").is_null());
  EXPECT_FALSE(json.at("sequences")[1].at("poses").is_null());
  ASSERT_EQ(json.at("symptoms").size(), 1U);
  EXPECT_THAT(json.at("symptoms")[0].at("where").get<std::string>(), HasSubstr("sequences/00"));
}

TEST_F(DoctorCommand, WarnsOfAnEmptyScanOfARecording) {
  fs::create_directory(folder_ / "flat");
  for (int k = 0; k < 12; ++k) {
    const std::string name = cli::stem(static_cast<std::size_t>(k)) + ".bin";
    fs::rename(folder_ / "room/velodyne" / name, folder_ / "flat" / name);
  }
  fs::rename(folder_ / "room/poses.txt", folder_ / "flat/poses.txt");
  write_file_atomic(folder_ / "flat/000007.bin", "");
  const cli::Answer answer = cli::run({"doctor", folder_ / "flat"});
  EXPECT_EQ(answer.exit_code, 1) << answer.out;
  EXPECT_THAT(answer.out, HasSubstr("flat: 1 of 12 scans hold no points, first 000007"));
}

TEST_F(DoctorCommand, KeepsTheReadingFlagsInTheNextCommand) {
  fs::rename(folder_ / "room/poses.txt", folder_ / "my poses.txt");
  const std::string poses = (folder_ / "my poses.txt").string();
  const cli::Answer answer =
      cli::run({"doctor", room(), "--poses", poses, "--pose-frame", "lidar", "--dataset",
                "semantickitti", "--sequences", "room", "--deskew", "none"});
  EXPECT_EQ(answer.exit_code, 0) << answer.out << answer.err;
  EXPECT_THAT(answer.out, HasSubstr("\n  mosbench run " + room() +
                                    " --dataset semantickitti --sequences room --poses '" + poses +
                                    "' --deskew none --read pose_frame=lidar\n"));
}

TEST_F(DoctorCommand, PutsTheFlagThatMendsThePosesIntoTheNextCommand) {
  const std::string drive = (folder_ / "drive").string();
  ASSERT_EQ(cli::run({"simulate", "--layout", "semantickitti", "--scene", "street", "--scans", "12",
                      "--seed", "1", "--out", drive})
                .exit_code,
            0);
  const std::string sequence = drive + "/sequences/08";
  // Poses of the LiDAR beside a Tr that is then applied to them.
  Pose tr = Pose::Identity();
  tr.linear() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  std::vector<Pose> poses = read_poses(sequence + "/poses.txt");
  for (Pose& pose : poses) pose = tr.inverse() * pose * tr;
  write_poses(sequence + "/poses.txt", poses);
  const cli::Answer wrong = cli::run({"doctor", sequence});
  EXPECT_EQ(wrong.exit_code, 1) << wrong.out;
  EXPECT_THAT(wrong.out, HasSubstr("the lidar's, Tr not to be applied"));
  const std::string next = sequence + " --read pose_frame=lidar";
  EXPECT_THAT(wrong.out, HasSubstr("\n  mosbench run " + next + "\n"));
  const cli::Answer mended = cli::run({"doctor", sequence, "--pose-frame", "lidar"});
  EXPECT_EQ(mended.exit_code, 0) << mended.out;
}

TEST_F(DoctorCommand, SaysHowFarOffPosesThatDriftAre) {
  const std::string drive = (folder_ / "drive").string(), poses = (folder_ / "poses.txt").string();
  ASSERT_EQ(cli::run({"simulate", "--layout", "semantickitti", "--scene", "street", "--scans", "60",
                      "--seed", "1301", "--out", drive})
                .exit_code,
            0);
  const std::string sequence = drive + "/sequences/08";
  const cli::Answer sound = cli::run({"doctor", sequence});
  EXPECT_EQ(sound.exit_code, 0) << sound.out;
  EXPECT_THAT(sound.out, HasSubstr("  fit             over 20 scans surfaces are 0."));
  std::vector<Pose> longer = read_poses(sequence + "/poses.txt");
  for (Pose& pose : longer) pose.translation() *= 1.02;
  write_poses(poses, longer);
  const cli::Answer drifting = cli::run({"doctor", sequence, "--poses", poses});
  EXPECT_EQ(drifting.exit_code, 1) << drifting.out;
  EXPECT_THAT(drifting.out, HasSubstr("warning: 08: the poses drift: over 20 scans they put "));
  EXPECT_THAT(drifting.out, HasSubstr("; expected at most 4 cm: run with --refine-poses\n"));
  const std::string doubt = "the poses do not fit the scans: over 20 scans they put surfaces ";
  const std::string out = (folder_ / "out").string();
  const cli::Answer run = cli::run({"run", sequence, "--poses", poses, "--out", out});
  EXPECT_THAT(run.out, HasSubstr("08: " + doubt));
  EXPECT_THAT(run.err, HasSubstr("08: " + doubt));
  EXPECT_THAT(cli::timeless_result(folder_ / "out/08").at("doubts").at(0).get<std::string>(),
              testing::StartsWith(doubt));
  const cli::Answer silent = cli::run({"run", sequence, "--out", (folder_ / "sound").string()});
  EXPECT_THAT(silent.out, Not(HasSubstr("the poses do not fit")));
}

TEST_F(DoctorCommand, SaysThatPosesOfFewScansWereNotChecked) {
  cli::write_small_sequence(folder_ / "short", 4);
  const cli::Answer answer = cli::run({"doctor", (folder_ / "short").string()});
  EXPECT_EQ(answer.exit_code, 0) << answer.out;
  EXPECT_THAT(answer.out, HasSubstr("nothing wrong was found; the poses of short were NOT checked: "
                                    "too few scans or points. Next\n"));
}

TEST_F(DoctorCommand, NamesAFileOnce) {
  const fs::path label = folder_ / "room/labels/000003.label";
  fs::resize_file(label, fs::file_size(label) - 4);
  const cli::Answer answer = cli::run({"doctor", room()});
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.out, HasSubstr("error: " + label.string() + ": "));
  EXPECT_THAT(answer.out, Not(HasSubstr(room() + ": " + room())));
}

TEST_F(DoctorCommand, SaysWhatASensorThatStandsStillCannotTell) {
  const cli::Answer answer = cli::run({"doctor", room()});
  EXPECT_EQ(answer.exit_code, 0);
  EXPECT_THAT(answer.out, HasSubstr("  not checked     the camera's, Tr is missing; "));
  EXPECT_THAT(answer.out, HasSubstr(" more (the same motions here)\n"));
}

TEST_F(DoctorCommand, IsShortOnSoundData) {
  const cli::Answer answer = cli::run({"doctor", room()});
  EXPECT_LE(std::ranges::count(answer.out, '\n'), 19) << answer.out;
  EXPECT_THAT(answer.out, HasSubstr("room: 12 scans, 12 labelled\n"));
  EXPECT_THAT(answer.out, HasSubstr(" points in 12 scans; 0 NaN or infinite\n"));
  EXPECT_THAT(answer.out, HasSubstr("  range           3-10 m 100.0 %\n"));
}

TEST_F(DoctorCommand, PrintsTheSameAsJson) {
  const cli::Answer answer = cli::run({"doctor", room(), "--json"});
  ASSERT_EQ(answer.exit_code, 0) << answer.out;
  const auto json = nlohmann::json::parse(answer.out);
  EXPECT_EQ(json.at("dataset"), "semantickitti");
  EXPECT_EQ(json.at("sequences").at(0).at("scans"), 12);
  EXPECT_TRUE(json.at("symptoms").empty());
  const auto& bins = json.at("range_bins_m");
  EXPECT_EQ(bins.size(), json.at("sequences").at(0).at("points_of_range").size());
  EXPECT_EQ(bins.front(), 0.5);
  EXPECT_TRUE(bins.back().is_null());
}

TEST_F(DoctorCommand, RefusesWhatIsNoFolderAsUnusable) {
  const cli::Answer answer = cli::run({"doctor", (folder_ / "nothing").string()});
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.out, HasSubstr("is no folder that can be listed"));
}

TEST(DoctorMarks, AreThoseOfSimulatedAndDisturbedData) {
  const TempFolder folder;
  const std::string noise = "range_noise_m=0.01,seed=3", data = folder / "sim";
  ASSERT_EQ(cli::run({"simulate", "--layout", "semantickitti", "--scene", "room", "--scans", "6",
                      "--seed", "5", "--perturb", noise, "--out", data})
                .exit_code,
            0);
  for (const std::vector<std::string>& as : {std::vector<std::string>{}, {"--json"}}) {
    std::vector<std::string> words = {"doctor", data};
    words.insert(words.end(), as.begin(), as.end());
    EXPECT_THAT(cli::run(words).out,
                testing::AllOf(testing::HasSubstr("simulated: scene room, seed 5"),
                               testing::HasSubstr("disturbed on purpose by " + noise)));
  }
}

}  // namespace
}  // namespace mosbench
