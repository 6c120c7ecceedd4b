#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "datasets/disk/files.hpp"
#include "datasets/formats/pose_file.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;
using testing::AllOf;
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
                                   kind, "--set", "min_range_m=3", "--overwrite"});
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

TEST_F(OdometryCommand, PrintsTheCommandThatReadsItsPosesAsTheLidars) {
  const cli::Answer found = run({"odometry", path("sim"), "-o", path("poses.txt")});
  EXPECT_THAT(found.out, HasSubstr("mosbench run " + path("sim") + " --poses " + path("poses.txt") +
                                   " --read pose_frame=lidar\n"));
}

TEST_F(OdometryCommand, MarksItsPosesAsTheLidarsForCommandsThatReadThem) {
  ASSERT_LE(run({"odometry", path("sim"), "-o", path("poses.txt")}).exit_code, 1);
  const auto labels_by = [&](const std::string& poses, const char* out) {
    const cli::Answer answer = run({"run", path("sim"), "--poses", poses, "--out", path(out)});
    EXPECT_EQ(answer.exit_code, 0) << answer.err;
    return answer.err;
  };
  const char* doubt = "08: THE POSES FIT AS THOSE OF THE LIDAR";
  EXPECT_THAT(labels_by(path("poses.txt"), "marked"), testing::Not(HasSubstr(doubt)));
  EXPECT_THAT(labels_by(truth_.string(), "camera"), testing::Not(HasSubstr(doubt)));
  EXPECT_EQ(cli::timeless_result(folder_ / "marked/08").at("reading").at("pose_frame"),
            "lidar, as the .frame beside the file says");
  // A copy has no mark, and that of other content says nothing.
  std::filesystem::copy(folder_ / "poses.txt", folder_ / "copied.txt");
  EXPECT_THAT(labels_by(path("copied.txt"), "copied"), HasSubstr(doubt));
  const ordered_json doubts = cli::timeless_result(folder_ / "copied/08").at("doubts");
  EXPECT_THAT(doubts.at(0).get<std::string>(), HasSubstr("run with --read pose_frame=lidar"));
  std::filesystem::copy(truth_, folder_ / "poses.txt",
                        std::filesystem::copy_options::overwrite_existing);
  labels_by(path("poses.txt"), "overwritten");
  EXPECT_EQ(cli::contents(folder_ / "overwritten/08/labels"),
            cli::contents(folder_ / "camera/08/labels"));
}

TEST_F(OdometryCommand, KnowsCamerasPosesThatAreReadAsTheLidars) {
  const char* doubt = "08: THE POSES FIT AS THOSE OF THE CAMERA: they were taken for the lidar's";
  const std::string lost = path("lost"), sequence = lost + "/sequences/08";
  std::filesystem::copy(folder_ / "sim", lost, std::filesystem::copy_options::recursive);
  std::filesystem::copy(truth_, sequence + "/poses.txt");
  const cli::Answer sound = run({"run", lost, "--out", path("sound")});
  EXPECT_EQ(sound.exit_code, 0) << sound.err;
  EXPECT_THAT(sound.out, testing::Not(HasSubstr("THE POSES")));
  EXPECT_THAT(run({"run", lost, "--read", "pose_frame=lidar", "--out", path("told")}).out,
              HasSubstr(doubt));
  ASSERT_TRUE(std::filesystem::remove(sequence + "/calib.txt"));
  const cli::Answer answer = run({"run", lost, "--out", path("run")});
  EXPECT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.out, HasSubstr(doubt));
  EXPECT_THAT(run({"rank", path("run"), "--as", "csv"}).out, HasSubstr(doubt));
}

TEST_F(OdometryCommand, ComparesTwoEstimatesAndDrawsThem) {
  for (const char* kind : {"simple", "kiss"}) {
    ASSERT_LE(run({"odometry", path("sim"), "-o", path(kind), "--odometry", kind}).exit_code, 1);
  }
  std::vector<std::string> command = {"trajectory",    path("simple"), path("kiss"),   "--truth",
                                      truth_.string(), "--align",      "origin",       "--camera",
                                      "truth",         "--calib",      calib_.string()};
  const auto asked = [&](std::vector<std::string> flags) {
    flags.insert(flags.begin(), command.begin(), command.end());
    return run(flags);
  };
  const cli::Answer text = asked({"--out", path("paths.png")});
  ASSERT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("first: " + path("simple")));
  EXPECT_THAT(text.out, HasSubstr("no interval for RPE m: 7 scans, expected at least 100"));
  EXPECT_THAT(text.out, HasSubstr("no interval for APE m: one bad motion shifts all later"));
  EXPECT_EQ(read_file(folder_ / "paths.png").substr(1, 3), "PNG");
  const cli::Answer refused = asked({"--out", path("")});
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_THAT(refused.err, HasSubstr("is a folder, expected a file to write"));
  const ordered_json json = ordered_json::parse(asked({"--json"}).out);
  const ordered_json& rpe = json.at("difference").at("relative_translation_m");
  EXPECT_DOUBLE_EQ(rpe.at("value"), rpe.at("second").get<double>() - rpe.at("first").get<double>());
  EXPECT_EQ(json.at("second").at("sequences")[0].at("name"), "kiss");
  EXPECT_EQ(json.at("confidence"), 0.95);
  EXPECT_THAT(asked({"--csv"}).out, AllOf(HasSubstr("error,first,second,difference,low,high"),
                                          HasSubstr("\nrelative_translation_m,")));
  command[2] = truth_.string();
  EXPECT_EQ(asked({}).exit_code, 0);
  std::ofstream(folder_ / "short") << "1 0 0 0 0 1 0 0 0 0 1 0\n";
  command[2] = path("short");
  EXPECT_EQ(asked({}).exit_code, 3);
}

TEST_F(OdometryCommand, SaysWhenTheOtherFrameFitsFarBetter) {
  const cli::Answer found = run({"odometry", path("sim"), "-o", path("poses.txt")});
  ASSERT_LE(found.exit_code, 1);
  const cli::Answer mixed = run({"trajectory", path("poses.txt"), "--truth", truth_.string()});
  EXPECT_THAT(mixed.out, HasSubstr("if the truth is the camera's: --camera truth:CALIB"));
  const cli::Answer right = run({"trajectory", path("poses.txt"), "--truth", truth_.string(),
                                 "--camera", "truth", "--calib", calib_.string()});
  EXPECT_THAT(right.out, testing::Not(HasSubstr("--camera")));
}

TEST_F(OdometryCommand, TakesTheTimesOfPointsFromTheirAzimuth) {
  std::vector<std::string> command = {"run",      path("sim"),  "--odometry",    "simple",
                                      "--out",    path("runs"), "--point-times", "azimuth",
                                      "--deskew", "velocity"};
  const cli::Answer answer = run(command);
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  const ordered_json json = cli::timeless_result(folder_ / "runs" / "08");
  EXPECT_EQ(json.at("reading").at("deskew"), "velocity");
  EXPECT_EQ(json.at("reading").at("point_times"), "by azimuth, a turn in 0.1 s");
  EXPECT_THAT(std::string(json.at("reading").at("pose_odometry")), HasSubstr("deskew=velocity"));
  const cli::Answer report =
      run({"report", path("runs"), "-o", path("report.html"), "--scans", "2"});
  EXPECT_EQ(report.exit_code, 0) << report.err;
  command.push_back("--raw-scans");
  EXPECT_EQ(run(command).exit_code, 2);
  const cli::Answer next =
      run({"odometry", path("sim"), "-o", path("poses.txt"), "--point-times", "azimuth"});
  EXPECT_THAT(next.out, HasSubstr(" --point-times azimuth --read pose_frame=lidar\n"));
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
  const cli::Answer limits =
      run({"odometry", path("sim"), "-o", path("p.txt"), "--set", "min_range_m=50,max_range_m=50"});
  EXPECT_EQ(limits.exit_code, 2);
  EXPECT_THAT(limits.err, HasSubstr("max_range_m"));
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
  EXPECT_THAT(answer.err, HasSubstr("\n  mosbench run " + path("sim") + " --out " + path("runs") +
                                    " --odometry simple\n"));
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

TEST_F(OdometryCommand, KeepsSequencesThatAnEarlierCallFinished) {
  const std::filesystem::path first = calib_.parent_path();
  std::filesystem::copy(first, first.parent_path() / "09",
                        std::filesystem::copy_options::recursive);
  const std::vector<std::string> command = {"odometry", path("sim"), "-o", path("poses")};
  const cli::Answer whole = run(command);
  ASSERT_LE(whole.exit_code, 1) << whole.err;
  const auto files = cli::contents(folder_ / "poses");
  ASSERT_EQ(files.size(), 6u);  // poses, their mark and a record of each
  // As kills leave it: during the second sequence, and between its record and its poses.
  const auto after_a_kill = [&](const std::vector<const char*>& lost) {
    for (const char* file : lost) std::filesystem::remove(folder_ / "poses" / file);
    return run(command);
  };
  const cli::Answer last = after_a_kill({"09.txt", "09.txt.frame"});
  EXPECT_THAT(last.err, HasSubstr("09: finished by an earlier call, kept"));
  EXPECT_EQ(cli::contents(folder_ / "poses"), files);
  const cli::Answer rest = after_a_kill({"09.json", "09.txt", "09.txt.frame"});
  EXPECT_THAT(rest.err, HasSubstr("08: finished by an earlier call, kept"));
  EXPECT_THAT(rest.err, testing::Not(HasSubstr("09: finished")));
  EXPECT_EQ(rest.out, whole.out);
  EXPECT_EQ(rest.exit_code, whole.exit_code);
  EXPECT_EQ(cli::contents(folder_ / "poses"), files);
}

TEST_F(OdometryCommand, GivesRunsAFolderWithThePosesOfSeveralSequences) {
  const std::filesystem::path first = calib_.parent_path();
  std::filesystem::copy(first, first.parent_path() / "09",
                        std::filesystem::copy_options::recursive);
  const cli::Answer found = run({"odometry", path("sim"), "-o", path("poses")});
  EXPECT_THAT(found.out, HasSubstr("--poses " + path("poses")));
  ASSERT_EQ(run({"run", path("sim"), "--odometry", "simple", "--out", path("found")}).exit_code, 0);
  for (const char* poses : {"poses", "found"}) {
    const std::string out = path("read") + poses;
    const cli::Answer read = run({"run", path("sim"), "--poses", path(poses), "--out", out});
    ASSERT_EQ(read.exit_code, 0) << read.err;
    for (const char* sequence : {"08", "09"}) {
      EXPECT_EQ(cli::contents(std::filesystem::path(out) / sequence / "labels"),
                cli::contents(folder_ / "found" / sequence / "labels"));
    }
  }
  std::filesystem::remove(folder_ / "poses" / "09.txt");
  const cli::Answer lacking =
      run({"run", path("sim"), "--poses", path("poses"), "--out", path("lacking")});
  EXPECT_EQ(lacking.exit_code, 3);
  EXPECT_THAT(lacking.err, HasSubstr("holds no poses of sequence 09"));
  const cli::Answer file =
      run({"run", path("sim"), "--poses", path("poses/08.txt"), "--out", path("lacking")});
  EXPECT_EQ(file.exit_code, 2);
  EXPECT_THAT(file.err, HasSubstr("or a folder with a file for each"));
}

TEST_F(OdometryCommand, ScoresPosesAgainstThoseOfADataSet) {
  ASSERT_LE(run({"odometry", path("sim"), "-o", path("poses.txt")}).exit_code, 1);
  std::filesystem::copy(truth_, calib_.parent_path() / "poses.txt");
  const auto scores = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"trajectory", path("poses.txt"), "--align", "origin", "--json"});
    const cli::Answer answer = run(words);
    EXPECT_EQ(answer.exit_code, 0) << answer.err;
    return ordered_json::parse(answer.out).at("sequences")[0].at("relative");
  };
  const ordered_json by_hand =
      scores({"--truth", truth_.string(), "--camera", "truth", "--calib", calib_.string()});
  const ordered_json by_data_set = scores({"--truth", path("sim")});
  EXPECT_NEAR(by_hand.at("translation_m").at("rmse"), by_data_set.at("translation_m").at("rmse"),
              1e-3);  // the camera is elsewhere and turns with the sensor
  const cli::Answer camera = run({"trajectory", path("poses.txt"), "--truth", path("sim"),
                                  "--camera", "truth", "--calib", calib_.string()});
  EXPECT_EQ(camera.exit_code, 2);
  EXPECT_THAT(camera.err, HasSubstr("are read as the lidar's"));
}

TEST_F(OdometryCommand, LeavesMovingPointsOutOfTheMapAndSaysSo) {
  const cli::Answer found = run({"odometry", path("sim"), "-o", path("poses.txt"), "--drop-moving",
                                 "--set", "min_range_m=3"});
  ASSERT_LE(found.exit_code, 1) << found.err;
  const cli::Answer answer =
      run({"run", path("sim"), "--odometry", "simple", "--odometry-set", "min_range_m=3",
           "--drop-moving", "--set", "delay_scans=2", "--out", path("runs")});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  const ordered_json json = cli::timeless_result(folder_ / "runs" / "08");
  EXPECT_THAT(std::string(json.at("reading").at("pose_map")), HasSubstr("hmm-mos finds moving"));
  EXPECT_THAT(std::string(json.at("reading").at("pose_map")), HasSubstr("delay_scans=0"));
  EXPECT_EQ(run({"run", path("sim"), "--drop-moving", "--out", path("runs")}).exit_code, 2);
  const cli::Answer votes =
      run({"run", path("sim"), "--odometry", "simple", "--drop-moving", "--method", "underwood",
           "--set", "delay_scans=5,min_votes=2", "--out", path("votes")});
  EXPECT_EQ(votes.exit_code, 2);
  EXPECT_THAT(votes.err, HasSubstr("drop_moving: needs method underwood with delay_scans=0"));
}

TEST_F(OdometryCommand, GivesAConversionItsPoses) {
  ASSERT_LE(run({"odometry", path("sim"), "-o", path("poses.txt")}).exit_code, 1);
  const cli::Answer answer = run({"convert", path("sim"), "--odometry", "simple", "--layout",
                                  "semantickitti", "--out", path("posed")});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.err, HasSubstr("poses found by SiMpLE"));
  const auto expected = read_poses(path("poses.txt"));
  const auto written = read_poses(folder_ / "posed" / "sequences" / "08" / "poses.txt");
  ASSERT_EQ(written.size(), 8u);
  for (std::size_t k = 0; k < 8; ++k) EXPECT_TRUE(written[k].isApprox(expected[k], 1e-9));
  EXPECT_GT(written.back().translation().norm(), 1.0);
}

TEST_F(OdometryCommand, LabelsTheScansOfAFolderWithNothingButABag) {
  ASSERT_EQ(run({"convert", path("sim"), "--poses", truth_.string(), "--layout", "doals-bag",
                 "--out", path("bags")})
                .exit_code,
            0);
  std::filesystem::path bag;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / "bags")) {
    if (entry.path().extension() == ".bag") bag = entry.path();
  }
  ASSERT_FALSE(bag.empty());
  std::filesystem::create_directory(folder_ / "mine");
  std::filesystem::rename(bag, folder_ / "mine" / "drive.bag");
  const cli::Answer answer =
      run({"run", path("mine"), "--odometry", "simple", "--out", path("runs")});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_EQ(read_poses(folder_ / "runs" / "mine" / "poses.txt").size(), 8u);
  // The bag itself is the same sequence, and its own poses are there to compare with.
  ASSERT_EQ(run({"run", path("mine/drive.bag"), "--odometry", "simple", "--out", path("other")})
                .exit_code,
            0);
  EXPECT_EQ(cli::contents(folder_ / "other/drive/labels"),
            cli::contents(folder_ / "runs/mine/labels"));
  EXPECT_EQ(run({"report", path("other"), "-o", path("report.html")}).exit_code, 0);
  EXPECT_LE(run({"doctor", path("mine/drive.bag")}).exit_code, 1);
  const cli::Answer score = run({"trajectory", path("other"), "--truth", path("mine/drive.bag"),
                                 "--align", "origin", "--json"});
  ASSERT_EQ(score.exit_code, 0) << score.err;
  const ordered_json error = ordered_json::parse(score.out).at("sequences")[0].at("absolute");
  EXPECT_LT(error.at("translation_m").at("max"), 0.3);
  const cli::Answer none = run({"run", path("mine/none.bag"), "--out", path("other")});
  EXPECT_EQ(none.exit_code, 3);
  EXPECT_THAT(none.err, HasSubstr("or a .bag file"));
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
