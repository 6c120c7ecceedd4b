#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <thread>
#include <vector>

#include "datasets/formats/pose_file.hpp"
#include "datasets/hdf5/hdf5_module.hpp"
#include "datasets/layouts/dataset.hpp"
#include "datasets/rosbag/bag_reader.hpp"
#include "datasets/rosbag/bag_writer.hpp"
#include "datasets/text/errors.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

/// Points, stamps, truth and, within `pose_error`, poses of two data sets are the same.
void expect_same_frames(const std::filesystem::path& a, const std::filesystem::path& b,
                        double pose_error) {
  const Dataset first = open_dataset(a, {});
  const Dataset second = open_dataset(b, {});
  ASSERT_EQ(first.sequences.size(), second.sequences.size());
  for (std::size_t s = 0; s < first.sequences.size(); ++s) {
    ASSERT_EQ(first.sequences[s]->size(), second.sequences[s]->size());
    for (std::size_t k = 0; k < first.sequences[s]->size(); ++k) {
      const Frame expected = first.sequences[s]->read(k);
      const Frame frame = second.sequences[s]->read(k);
      ASSERT_EQ(frame.points.size(), expected.points.size());
      EXPECT_EQ(std::memcmp(frame.points.data(), expected.points.data(),
                            expected.points.size() * sizeof(Point)),
                0);
      EXPECT_EQ(frame.truth, expected.truth);
      EXPECT_LE((frame.map_from_sensor.matrix() - expected.map_from_sensor.matrix())
                    .cwiseAbs()
                    .maxCoeff(),
                pose_error);
      if (expected.stamp_ns) {
        EXPECT_EQ(frame.stamp_ns, expected.stamp_ns);
      }
    }
  }
}

class Convert : public testing::Test {
 protected:
  std::string simulate(const std::string& layout, const char* scans = "12") const {
    const std::string out = (folder_ / layout).string();
    const cli::Answer answer = cli::run({"simulate", "--layout", layout, "--scene", "room",
                                         "--scans", scans, "--seed", "5", "--out", out});
    EXPECT_EQ(answer.exit_code, 0) << answer.err;
    return out;
  }
  cli::Answer convert(const std::string& input, const std::string& layout, const char* out,
                      const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"convert", input,   "--layout",
                                          layout,    "--out", (folder_ / out).string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return cli::run(arguments);
  }
  nlohmann::json scores(const std::string& input, const char* out,
                        const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"run", input, "--out", (folder_ / out).string(),
                                          "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const cli::Answer answer = cli::run(arguments);
    EXPECT_EQ(answer.exit_code, 0) << answer.err;
    return nlohmann::json::parse(answer.out).at("sequences").at(0).at("summary");
  }

  TempFolder folder_;
};

TEST_F(Convert, MakesABagOfSeveralChunksThatReadsAndScoresAsTheExportedScans) {
  if (!writes_bags()) GTEST_SKIP() << "this build is without librosbag_storage";
  const std::string exported = simulate("doals", "4");
  const nlohmann::json expected = scores(exported, "out");
  ASSERT_GT(expected.dump().size(), 20U);
  for (const char* compression : {"none", "lz4", "bz2"}) {
    const std::string bags = std::string("bags_") + compression;
    const cli::Answer answer =
        convert(exported, "doals-bag", bags.c_str(), {"--compression", compression});
    ASSERT_EQ(answer.exit_code, 0) << answer.err;
    EXPECT_THAT(answer.out, HasSubstr("converted 4 scans"));
    std::filesystem::path bag;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / bags)) {
      if (entry.path().extension() == ".bag") bag = entry.path();
    }
    ASSERT_FALSE(bag.empty());
    const auto messages = open_bag(bag)->messages("/os1_cloud_node/points");
    ASSERT_EQ(messages.size(), 4U);
    EXPECT_GT(messages.back().chunk, 2U);
    expect_same_frames(exported, folder_ / bags, 1e-12);
    EXPECT_EQ(scores((folder_ / bags).string(), (bags + "_out").c_str()), expected);
  }
}

TEST_F(Convert, MakesRos2BagsThatReadAndScoreAsTheScans) {
  const std::string exported = simulate("semantickitti");
  const nlohmann::json expected = scores(exported, "out");
  ASSERT_GT(expected.dump().size(), 20U);
  const std::vector<std::pair<std::string, std::string>> kinds = {
      {"ros2-mcap", "lz4"}, {"ros2-mcap", "zstd"}, {"ros2-db3", "none"}, {"ros2-db3", "zstd"}};
  for (const auto& [layout, compression] : kinds) {
    const std::string out = layout + compression;
    const cli::Answer answer =
        convert(exported, layout, out.c_str(), {"--compression", compression});
    ASSERT_EQ(answer.exit_code, 0) << answer.err;
    EXPECT_EQ(open_dataset(folder_ / out, {}).kind, DatasetKind::kRecording);
    expect_same_frames(exported, folder_ / out, 1e-12);
    EXPECT_EQ(cli::run({"doctor", (folder_ / out).string()}).exit_code, 0) << out;
    const cli::Answer run = cli::run({"run", (folder_ / out).string(), "--preset", "semantickitti",
                                      "--out", (folder_ / (out + "_out")).string(), "--json"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(nlohmann::json::parse(run.out).at("sequences").at(0).at("summary"), expected);
  }
  EXPECT_EQ(convert(exported, "ros2-db3", "z", {"--compression", "lz4"}).exit_code, 2);
  EXPECT_EQ(convert(exported, "semantickitti", "unpacked").exit_code, 0) << "has no compression";
}

TEST_F(Convert, MakesRos2BagsThatAreKnownAlsoInFoldersWithNumbers) {
  cli::write_small_sequence(folder_ / "data/sequences/08", 3);
  for (const std::string layout : {"ros2-mcap", "ros2-db3"}) {
    const std::string bags = (folder_ / layout).string();
    ASSERT_EQ(convert((folder_ / "data").string(), layout, layout.c_str()).exit_code, 0);
    EXPECT_EQ(open_dataset(bags, {}).kind, DatasetKind::kRecording);
  }
}

TEST_F(Convert, TurnsEveryLayoutIntoEveryOther) {
  for (const std::string from : {"doals", "sipailou", "helimos", "semantickitti"}) {
    const std::string input = simulate(from, "6");
    for (const std::string to :
         {"doals", "sipailou", "helimos", "semantickitti", "opensceneflow"}) {
      if (to == "opensceneflow" && !has_hdf5()) continue;
      const std::string out = from + "_as_" + to;
      const cli::Answer answer = convert(input, to, out.c_str());
      ASSERT_EQ(answer.exit_code, 0) << out << answer.err;
      if (to == "doals") {
        EXPECT_EQ(open_dataset(folder_ / out, {}).kind, DatasetKind::kDoals);
      } else {
        expect_same_frames(input, folder_ / out, 1e-12);
      }
    }
  }
}

TEST_F(Convert, MakesTablesOfNuscenesThatReadAndScoreAsTheScans) {
  for (const char* name : {"00", "01"}) {
    cli::write_small_sequence(folder_ / "data/sequences" / name, 12);
  }
  const std::string data = (folder_ / "data").string();
  for (const char* unlabelled : {"000000", "000005"}) {
    std::filesystem::remove(folder_ / "data/sequences/00/labels" /
                            (std::string(unlabelled) + ".label"));
  }
  const cli::Answer answer = convert(data, "nuscenes", "tables");
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  const Dataset tables = open_dataset(folder_ / "tables", {});
  EXPECT_EQ(tables.kind, DatasetKind::kNuscenes);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "tables/00/sweeps/LIDAR_TOP/000005.pcd.bin"));
  expect_same_frames(data, folder_ / "tables", 1e-12);
  EXPECT_EQ(cli::run({"doctor", (folder_ / "tables").string()}).exit_code, 0);
  EXPECT_EQ(scores((folder_ / "tables").string(), "tables_out"),
            scores(data, "out", {"--protocol", "mapmos-nuscenes"}));
  EXPECT_EQ(convert((folder_ / "tables").string(), "semantickitti", "back").exit_code, 0);
  expect_same_frames(data, folder_ / "back", 1e-12);
}

TEST_F(Convert, MakesScansOfHeliprThatAreTheSameButForTheirTruth) {
  cli::write_small_sequence(folder_ / "room", 3);
  std::filesystem::remove_all(folder_ / "room/labels");
  const cli::Answer answer = convert((folder_ / "room").string(), "helipr", "packed");
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_EQ(open_dataset(folder_ / "packed", {}).kind, DatasetKind::kHelipr);
  expect_same_frames(folder_ / "room", folder_ / "packed", 1e-12);
  EXPECT_EQ(open_dataset(folder_ / "packed", {}).sequences.at(0)->stamp_ns(2), 200'000'000);
}

TEST_F(Convert, KeepsRadialVelocitiesOfAnAevaAlsoDisturbedOnes) {
  const std::string data = simulate("helipr", "3");
  ASSERT_EQ(convert(data, "helipr", "again").exit_code, 0);
  const Dataset first = open_dataset(data, {}), second = open_dataset(folder_ / "again", {});
  ASSERT_EQ(second.sequences.size(), 2U);
  EXPECT_EQ(second.sequences[0]->name(), "room_Aeva");
  EXPECT_EQ(second.sequences[1]->name(), "room_Ouster");
  const Frame expected = first.sequences[0]->read(2), frame = second.sequences[0]->read(2);
  EXPECT_GT(frame.points.size(), 1000U);
  EXPECT_EQ(frame.radial_velocity_m_s, expected.radial_velocity_m_s);
  EXPECT_TRUE(second.sequences[1]->read(2).radial_velocity_m_s.empty());
  expect_same_frames(data, folder_ / "again", 1e-12);

  ASSERT_EQ(
      convert(data, "helipr", "lost", {"--perturb", "dropout_probability=0.5,seed=1"}).exit_code,
      0);
  const Frame lost = open_dataset(folder_ / "lost", {}).sequences[0]->read(2);
  ASSERT_EQ(lost.radial_velocity_m_s.size(), expected.points.size());
  for (std::size_t i = 0; i < lost.points.size(); ++i) {
    const bool is_lost = lost.points[i].x == 0 && lost.points[i].y == 0;
    EXPECT_EQ(lost.radial_velocity_m_s[i], is_lost ? 0.0F : expected.radial_velocity_m_s[i]);
  }
}

TEST_F(Convert, TellsWhatOfTheTruthALayoutDoesNotHold) {
  cli::write_small_sequence(folder_ / "room", 3);
  const std::filesystem::path file = folder_ / "room/labels/000001.label";
  std::vector<std::uint32_t> truth = read_labels(file, cli::kPointsPerScan);
  std::fill(truth.begin(), truth.begin() + 7, 0x30000U);
  write_labels(file, truth);
  const std::string room = (folder_ / "room").string();
  for (const char* layout : {"doals", "nuscenes"}) {
    EXPECT_THAT(convert(room, layout, layout).err,
                HasSubstr("7 points of the label id 0, which most data sets give to what nobody "
                          "labelled, become static: layout " +
                          std::string(layout)));
  }
  EXPECT_THAT(convert(room, "helipr", "helipr").err,
              HasSubstr("the labels of 3 scans are left out: layout helipr has none"));
  EXPECT_THAT(convert(room, "helimos", "helimos").err, Not(HasSubstr("label")));
}

TEST_F(Convert, MakesABagOfScansWithoutStamps) {
  if (!writes_bags()) GTEST_SKIP() << "this build is without librosbag_storage";
  cli::write_small_sequence(folder_ / "room", 3);
  const cli::Answer answer = convert((folder_ / "room").string(), "doals-bag", "bags");
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  expect_same_frames(folder_ / "room", folder_ / "bags", 1e-12);
  EXPECT_EQ(open_dataset(folder_ / "bags", {}).sequences.at(0)->stamp_ns(2), 200'000'000);
}

TEST_F(Convert, RefusesAFilledFolderAndAnUnknownLayout) {
  const std::string input = simulate("doals", "6");
  folder_.write("out/keep", "mine");
  const cli::Answer filled = convert(input, "doals", "out");
  EXPECT_EQ(filled.exit_code, 2);
  EXPECT_THAT(filled.err, HasSubstr("keep: is no file of this conversion"));
  EXPECT_EQ(convert(input, "kitti", "other").exit_code, 2);
}

TEST_F(Convert, GoesOnAfterAKillToTheFilesOfAnUndisturbedOne) {
  for (const char* name : {"00", "01"}) {
    cli::write_small_sequence(folder_ / "data/sequences" / name, 40);
  }
  const std::string data = (folder_ / "data").string();
  const std::vector<std::string> by_odometry = {"--odometry", "kiss"};
  ASSERT_EQ(convert(data, "semantickitti", "whole", by_odometry).exit_code, 0);
  const auto whole = cli::contents(folder_ / "whole");

  const std::vector<std::string> disturbed = {
      "convert", data, "--layout", "semantickitti", "--out", folder_ / "cut", "--odometry", "kiss"};
  const TempFolder streams;
  const pid_t child = cli::start(disturbed, streams.path());
  while (!std::filesystem::exists(folder_ / "cut/sequences/01/velodyne/000004.bin") &&
         waitpid(child, nullptr, WNOHANG) == 0) {
    std::this_thread::yield();
  }
  ASSERT_EQ(kill(child, SIGKILL), 0);
  ASSERT_EQ(cli::wait_for(child), 128 + SIGKILL);
  ASSERT_TRUE(std::filesystem::exists(folder_ / "cut/sequences/00/poses.txt"));
  ASSERT_FALSE(std::filesystem::exists(folder_ / "cut/sequences/01/poses.txt"));

  EXPECT_THAT(message_of<DataError>([&] { open_dataset(folder_ / "cut", {}); }),
              HasSubstr("holds part of a data set"));
  const cli::Answer other = convert(data, "doals", "cut");
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, HasSubstr("unfinished conversion of other files or to another layout"));
  folder_.write("cut/sequences/01/velodyne/mine.bin", "mine");
  const cli::Answer foreign = cli::run(disturbed);
  EXPECT_EQ(foreign.exit_code, 2);
  EXPECT_THAT(foreign.err, HasSubstr("mine.bin: is no file of this conversion"));
  std::filesystem::remove(folder_ / "cut/sequences/01/velodyne/mine.bin");

  const auto finished = std::filesystem::last_write_time(folder_ / "cut/sequences/00/poses.txt");
  const cli::Answer again = cli::run(disturbed);
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(cli::contents(folder_ / "cut"), whole);
  EXPECT_EQ(std::filesystem::last_write_time(folder_ / "cut/sequences/00/poses.txt"), finished);
  EXPECT_EQ(cli::run(disturbed).exit_code, 2) << "nor over a finished one";
}

TEST_F(Convert, LeavesNothingWhereThereIsNoRoom) {
  cli::write_small_sequence(folder_ / "room", 6);
  const std::string room = (folder_ / "room").string();
  for (const char* layout : {"semantickitti", "doals-bag", "ros2-mcap", "ros2-db3"}) {
    if (layout == std::string("doals-bag") && !writes_bags()) continue;
    const bool is_ros2 = std::string(layout).starts_with("ros2");
    for (const char* compression : {"none", is_ros2 ? "none" : "lz4", is_ros2 ? "none" : "bz2"}) {
      const cli::Answer answer = cli::run({"convert", room, "--layout", layout, "--compression",
                                           compression, "--out", (folder_ / "new").string()},
                                          [] {
                                            const struct rlimit small { 20'000, 20'000 };
                                            setrlimit(RLIMIT_FSIZE, &small);
                                          });
      EXPECT_EQ(answer.exit_code, 3) << layout << compression;
      EXPECT_THAT(answer.err, HasSubstr("cannot be written"));
      EXPECT_FALSE(std::filesystem::exists(folder_ / "new")) << layout << compression;
    }
  }
}

TEST_F(Convert, GoesOnWhereTooFewFilesCouldBeOpened) {
  cli::write_small_sequence(folder_ / "room", 3);
  for (const char* layout : {"semantickitti", "doals-bag", "ros2-mcap", "ros2-db3"}) {
    if (layout == std::string("doals-bag") && !writes_bags()) continue;
    int failures = 0;
    for (rlim_t files = 3; files < 16; ++files) {
      const std::string out = layout + std::to_string(files);
      const cli::Answer limited = cli::run(
          {"convert", folder_ / "room", "--layout", layout, "--out", (folder_ / out).string()},
          [files] {
            const struct rlimit few { files, files };
            setrlimit(RLIMIT_NOFILE, &few);
          });
      if (limited.exit_code == 0) continue;
      ++failures;
      const cli::Answer again = convert((folder_ / "room").string(), layout, out.c_str());
      EXPECT_EQ(again.exit_code, 0) << files << " files: " << limited.err << again.err;
    }
    EXPECT_GE(failures, 3) << layout;
  }
}

TEST_F(Convert, RefusesStampsThatABagCannotHold) {
  if (!writes_bags()) GTEST_SKIP() << "this build is without librosbag_storage";
  cli::write_small_sequence(folder_ / "room", 2);
  folder_.write("room/times.txt", "1\n4294967296\n");
  const cli::Answer answer = convert((folder_ / "room").string(), "doals-bag", "bags");
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.err, HasSubstr("bag.bag: a stamp to be written is beyond 2^32 s"));
}

TEST_F(Convert, RefusesStampsThatNuscenesCannotHold) {
  cli::write_small_sequence(folder_ / "room", 2);
  folder_.write("room/times.txt", "-0.1\n0\n");
  const cli::Answer answer = convert((folder_ / "room").string(), "nuscenes", "scenes");
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.err, HasSubstr("has a stamp below 0, expected us since 1970"));
}

TEST_F(Convert, TellsThatStampsAreLost) {
  const std::string source = simulate("semantickitti", "3");
  const cli::Answer lost = convert(source, "kitti-tracking", "tracking");
  ASSERT_EQ(lost.exit_code, 0) << lost.err;
  EXPECT_THAT(lost.err, HasSubstr("the stamps of 3 scans are left out: layout kitti-tracking has "
                                  "none, its scans are 0.1 s apart"));
  const cli::Answer kept = convert(source, "kitti-raw", "raw");
  ASSERT_EQ(kept.exit_code, 0) << kept.err;
  EXPECT_THAT(kept.err, Not(HasSubstr("stamps")));
  const cli::Answer none = convert(simulate("sipailou", "3"), "kitti-tracking", "unstamped");
  ASSERT_EQ(none.exit_code, 0) << none.err;
  EXPECT_THAT(none.err, Not(HasSubstr("stamps")));
}

TEST_F(Convert, KeepsWherePosesCameFrom) {
  const std::string source = simulate("sipailou", "4");
  ASSERT_EQ(convert(source, "semantickitti", "posed", {"--odometry", "simple"}).exit_code, 0);
  const auto origin = [](const std::filesystem::path& root) {
    const Dataset dataset = open_dataset(root, {});
    return dataset.sequences.at(0)->reading().poses.origin;
  };
  EXPECT_THAT(origin(folder_ / "posed"), StartsWith("poses: odometry simple; pose_odometry: "));
  ASSERT_EQ(convert((folder_ / "posed").string(), "sipailou", "twice").exit_code, 0);
  EXPECT_EQ(origin(folder_ / "twice"), origin(folder_ / "posed"));
}

TEST_F(Convert, SaysThatPosesWereReplacedWhoseOriginWasKept) {
  const std::string source = simulate("sipailou", "4");
  ASSERT_EQ(convert(source, "semantickitti", "posed", {"--odometry", "simple"}).exit_code, 0);
  const std::filesystem::path sequence = folder_ / "posed/sequences/06";
  std::string other_poses;
  for (int row = 0; row < 4; ++row) other_poses += "1 0 0 0 0 1 0 0 0 0 1 0\n";
  folder_.write("posed/sequences/06/poses.txt", other_poses);
  EXPECT_THAT(cli::run({"doctor", sequence.string()}).out,
              HasSubstr("pose_origin.txt was not written for poses.txt as it is now"));
  ASSERT_EQ(cli::run({"run", sequence.string(), "--out", (folder_ / "o").string()}).exit_code, 0);
  const auto result = cli::timeless_result(folder_ / "o/06");
  EXPECT_FALSE(result.at("reading").contains("pose_origin")) << result.at("reading");
}

TEST_F(Convert, StatesInTheResultHowASequenceWasRead) {
  cli::write_small_sequence(folder_ / "room", 6);
  folder_.write("p.csv",
                "0,0,0,0,0,0,1\n0,0,0,0,0,0,1\n0,0,0,0,0,0,1\n0,0,0,0,0,0,1\n"
                "0,0,0,0,0,0,1\n0,0,0,0,0,0,1\n");
  const std::vector<std::string> command = {"run", (folder_ / "room").string(), "--out",
                                            (folder_ / "out").string()};
  ASSERT_EQ(cli::run(command).exit_code, 0);
  auto told = command;
  told.insert(told.end(), {"--poses", (folder_ / "p.csv").string()});
  const cli::Answer other = cli::run(told);
  EXPECT_EQ(other.exit_code, 2) << "the same files read otherwise are another run";
  EXPECT_THAT(other.err, HasSubstr("reading"));
  told.emplace_back("--overwrite");
  ASSERT_EQ(cli::run(told).exit_code, 0);
  const auto reading = cli::timeless_result(folder_ / "out/room").at("reading");
  EXPECT_EQ(reading.at("pose_format"), "dynablox");
  EXPECT_EQ(reading.at("pose_direction"), "sensor_from_map, inverted");
}

TEST_F(Convert, TellsThatRadialVelocitiesAreLost) {
  const std::string source = simulate("helipr", "3");
  const cli::Answer lost = convert(source, "semantickitti", "plain", {"--sequences", "room/Aeva"});
  ASSERT_EQ(lost.exit_code, 0) << lost.err;
  EXPECT_THAT(lost.err,
              testing::ContainsRegex("the radial velocities of [0-9]+ points are left out: layout "
                                     "semantickitti has none"));
  const cli::Answer kept = convert(source, "helipr", "aeva", {"--sequences", "room/Aeva"});
  ASSERT_EQ(kept.exit_code, 0) << kept.err;
  EXPECT_THAT(kept.err, Not(HasSubstr("radial velocities")));
}

TEST_F(Convert, SaysAsRunAndScoreThatPosesDoNotFitAndKeepsIt) {
  const std::string data = simulate("semantickitti");
  const std::string sound = folder_ / "sound", doubtful = folder_ / "doubtful";
  EXPECT_THAT(convert(data, "semantickitti", "sound").out, Not(HasSubstr("poses jump")));
  EXPECT_THAT(read_file(sound + "/sequences/08/pose_origin.txt"), Not(HasSubstr("poses jump")));
  std::vector<Pose> poses = read_poses(data + "/sequences/08/poses.txt");
  for (std::size_t k = 7; k < poses.size(); ++k) poses[k].pretranslate(Eigen::Vector3d(2, 0, 0));
  write_poses(data + "/sequences/08/poses.txt", poses);
  const std::string doubt = "the poses jump between scans 000006 and 000007: they move by ";
  EXPECT_THAT(convert(data, "semantickitti", "doubtful").out, HasSubstr("08: " + doubt));
  EXPECT_THAT(read_file(doubtful + "/sequences/08/pose_origin.txt"), HasSubstr(doubt));
  const cli::Answer run = cli::run({"run", data, "--out", folder_ / "run"});
  EXPECT_THAT(run.out, HasSubstr("08: " + doubt));
  const cli::Answer score = cli::run({"score", data, "--predictions", folder_ / "run"});
  EXPECT_EQ(score.exit_code, 0) << score.err;
  EXPECT_THAT(score.out, HasSubstr(doubt));
}

}  // namespace
}  // namespace mosbench
