#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>

#include "datasets/disk/files.hpp"
#include "datasets/hdf5/flow_truth.hpp"
#include "datasets/hdf5/hdf5_file.hpp"
#include "datasets/hdf5/scene_flow_sequence.hpp"
#include "datasets/layouts/dataset.hpp"
#include "datasets/layouts/sequence_writer.hpp"
#include "datasets/sequence/pose_source.hpp"
#include "datasets/text/errors.hpp"
#include "tests/hdf5_bytes.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;
using Kind = Hdf5Number::Kind;

constexpr float kNoNumber = std::numeric_limits<float>::quiet_NaN();

TEST(ProcessCopy, GivesBackWhatTheWorkReturns) {
  std::string large(1'000'000, 'x');
  EXPECT_EQ(in_process_copy([&] { return large; }).bytes, large);
  EXPECT_EQ(in_process_copy([] { return std::string(); }).failure, "");
}

TEST(ProcessCopy, SaysWhatBecameOfACopyThatDidNotAnswer) {
  EXPECT_EQ(in_process_copy([]() -> std::string { throw std::runtime_error("no"); }).failure, "no");
  const CopyAnswer crashed = in_process_copy([]() -> std::string {
    signal(SIGSEGV, SIG_DFL);
    raise(SIGSEGV);
    return "alive";
  });
  EXPECT_THAT(crashed.failure, StartsWith("ended by signal Segmentation fault"));
  EXPECT_EQ(crashed.bytes, "");
  EXPECT_EQ(in_process_copy([]() -> std::string { _exit(0); }).failure, "ended without an answer");
}

TEST(ProcessCopy, EndsACopyThatComputesForEver) {
  const CopyAnswer answer = in_process_copy(
      []() -> std::string {
        std::atomic<unsigned> turns = 0;
        while (true) ++turns;
      },
      1);
  EXPECT_THAT(answer.failure, HasSubstr("ended by signal"));
}

TEST(ProcessCopy, MakesACopyThatOnlyWaitedOnceMore) {
  TempFolder folder;
  const auto waits_at_first = [&]() -> std::string {
    if (std::filesystem::exists(folder / "was_here")) return "answer";
    folder.write("was_here", "");
    while (true) pause();
  };
  EXPECT_EQ(in_process_copy(waits_at_first, 1).bytes, "answer");
  const auto waits = []() -> std::string {
    while (true) pause();
  };
  EXPECT_EQ(in_process_copy(waits, 1).failure, "ended by signal Alarm clock");
}

/// The sensor goes 1 m ahead and turns left by 90 degrees within 0.1 s.
SensorStep quarter_turn() {
  Pose map_from_next = Pose::Identity();
  map_from_next.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  map_from_next.translation() << 1, 0, 0;
  return {map_from_next.inverse(), 0.1};
}

TEST(FlowTruth, TakesTheSensorsOwnMotionOutOfTheFlow) {
  // A point at (3, 0, 0) that stands still is seen at (0, -2, 0) after the turn.
  const std::vector<Point> points = {{3, 0, 0, 0}, {3, 0, 0, 0}, {3, 0, 0, 0}, {3, 0, 0, 0}};
  // The second went 0.2 m to the side that is ahead of the sensor then; the third is not valid.
  const std::vector<float> flow = {-3, -2, 0, -2.8F, -2, 0, 9, 9, 9, kNoNumber, 0, 0};
  const std::vector<std::int64_t> valid = {1, 1, 0, 1};
  const auto found = velocities(displacements(points, flow, valid, quarter_turn()), quarter_turn());
  ASSERT_EQ(found.size(), 4U);
  EXPECT_NEAR(found[0].norm(), 0.0, 1e-6);
  EXPECT_NEAR(found[1].x(), 2.0, 1e-5);
  EXPECT_NEAR(found[1].tail<2>().norm(), 0.0, 1e-5);
  EXPECT_TRUE(std::isnan(found[2].x()) && std::isnan(found[3].x()));
  const std::vector<float> again = flow_of(points, found, quarter_turn());
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(again[i], flow[i], 1e-6);
  EXPECT_THAT(std::vector<float>(again.begin() + 6, again.end()), testing::Each(0.0F));
}

TEST(FlowTruth, MovesFromTheStepOnAndKnowsWhereTheBenchmarkDoesNotLook) {
  std::vector<Eigen::Vector3d> moved_m;
  for (const double step_m : {0.0, 0.049, 0.05, 0.3, double{kNoNumber}}) {
    moved_m.push_back({0, step_m, 0});
  }
  PointMotions motions;
  EXPECT_THAT(flow_labels(moved_m, motions, 0.05), ElementsAre(9, 9, 251, 251, 0));
  EXPECT_THAT(flow_labels(moved_m, motions, 0.1), ElementsAre(9, 9, 9, 251, 0));
  motions.on_ground = {1, 0, 0, 1, 1};
  EXPECT_THAT(flow_labels(moved_m, motions, 0.05), ElementsAre(40, 9, 251, 259, 0));
  motions.evaluated = {0, 0, 1, 1, 1};
  EXPECT_THAT(flow_labels(moved_m, motions, 0.05), ElementsAre(40, 99, 251, 259, 0));
  motions.evaluated = {1, 1, 1, 1, 1};
  motions.classes = {0, 31, 31, 30, 0};
  EXPECT_THAT(flow_labels(moved_m, motions, 0.05), ElementsAre(40, 99, 259, 259, 0));
}

class SceneFlowFile : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_hdf5()) GTEST_SKIP() << "this build is without libhdf5";
  }

  /// Four points in a sensor that goes 1 m ahead per scan: still, moving by 0.06 m, moving by 0.3 m
  /// without valid flow, still on the ground.
  static Hdf5GroupBytes scan(const std::string& stamp, double x_m) {
    return {
        stamp,
        {hdf5_array<float>("lidar", Kind::kReal, {4, 3}, {5, 0, 0, 6, 1, 0, 7, 0, 0, 8, 0, -1}),
         hdf5_array<double>("pose", Kind::kReal, {4, 4},
                            {1, 0, 0, x_m, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}),
         hdf5_array<std::uint8_t>("ground_mask", Kind::kTruth, {4}, {0, 0, 0, 1}),
         hdf5_array<float>("flow", Kind::kReal, {4, 3},
                           {-1, 0, 0, -1, 0.06F, 0, -0.7F, 0, 0, -1, 0, 0}),
         hdf5_array<std::uint8_t>("flow_is_valid", Kind::kTruth, {4}, {1, 1, 0, 1}),
         hdf5_array<std::uint8_t>("flow_category_indices", Kind::kUnsigned, {4}, {0, 19, 19, 0}),
         hdf5_array<std::int16_t>("flow_instance_id", Kind::kInteger, {4}, {0, 3, 3, 0})}};
  }
  static std::vector<Hdf5GroupBytes> scans() {
    return {scan("1600000000000000", 0), scan("1600000000100000", 1), scan("1600000000200000", 2)};
  }
  std::filesystem::path write(const std::vector<Hdf5GroupBytes>& groups,
                              const char* name = "drive.h5") const {
    write_hdf5(folder_ / name, groups);
    return folder_ / name;
  }
  std::string error_of(const std::vector<Hdf5GroupBytes>& groups) const {
    return message_of<DataError>([&] { open_scene_flow_file("s", write(groups), {})->read(0); });
  }
  /// The error of a file whose second group has another array of this name.
  template <typename Value>
  std::string error_with(const std::string& name, Kind kind, std::vector<std::uint64_t> shape,
                         const std::vector<Value>& values) const {
    auto groups = scans();
    std::erase_if(groups[1].arrays, [&](const auto& array) { return array.first.name == name; });
    groups[1].arrays.push_back(hdf5_array(name, kind, std::move(shape), values));
    return error_of(groups);
  }

  TempFolder folder_;
};

TEST_F(SceneFlowFile, GivesScansByStampsWithTruthOfTheirFlow) {
  auto groups = scans();
  std::swap(groups[0], groups[2]);
  const Dataset data = open_dataset(write(groups), {});
  EXPECT_EQ(data.kind, DatasetKind::kOpenSceneFlow);
  EXPECT_THAT(data.remarks, Contains(HasSubstr("it is an .h5 file")));
  const Sequence& drive = *data.sequences.at(0);
  EXPECT_EQ(drive.name(), "drive");
  ASSERT_EQ(drive.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    const Frame frame = drive.read(k);
    EXPECT_EQ(frame.stamp_ns,
              1'600'000'000'000'000'000 + static_cast<std::int64_t>(k) * 100'000'000);
    EXPECT_EQ(frame.map_from_sensor.translation().x(), static_cast<double>(k));
    ASSERT_EQ(frame.points.size(), 4U);
    EXPECT_EQ(frame.points[1].y, 1.0F);
    EXPECT_EQ(frame.points[1].intensity, 0.0F);
    // The flow of the last scan leads nowhere.
    EXPECT_EQ(frame.truth.has_value(), k < 2);
    EXPECT_EQ(drive.has_truth(k), k < 2);
    if (k == 2) continue;
    EXPECT_THAT(*frame.truth, ElementsAre(9, 251 + (3 << 16), 0, 40));
    EXPECT_EQ(drive.read_truth(k), *frame.truth);
    ASSERT_TRUE(frame.motions.has_value());
    EXPECT_NEAR(frame.motions->velocities_m_s[1].y(), 0.6, 1e-5);
  }
}

TEST_F(SceneFlowFile, TakesAnotherSpeedAndPosesButKeepsTheTruthOfItsOwnPoses) {
  const auto file = write(scans());
  const auto slow = open_dataset(file, {.reading = {.moving_speed_m_s = 0.7}});
  EXPECT_THAT(slow.sequences.at(0)->read_truth(0), ElementsAre(9, 9 + (3 << 16), 0, 40));
  const auto poses = folder_.write("p.txt",
                                   "1 0 0 5 0 1 0 0 0 0 1 0\n1 0 0 5 0 1 0 0 0 0 1 0\n"
                                   "1 0 0 5 0 1 0 0 0 0 1 0\n");
  const auto told = open_dataset(file, {.reading = {.poses = PoseFile{poses}}});
  EXPECT_EQ(told.sequences.at(0)->map_from_sensor(2).translation().x(), 5.0);
  EXPECT_EQ(told.sequences.at(0)->read_truth(0)[1], 251U + (3U << 16U));
}

TEST_F(SceneFlowFile, MovesByTheStepWhateverTheStampsUnlessASpeedIsAsked) {
  for (const int step_us : {50'000, 100'000, 101'000, 500'000}) {
    const auto file = write(
        {scan("1600000000000000", 0), scan(std::to_string(1'600'000'000'000'000 + step_us), 1)});
    const auto moves = [&](std::optional<double> speed_m_s) {
      const auto data = open_dataset(file, {.reading = {.moving_speed_m_s = speed_m_s}});
      return (data.sequences.at(0)->read_truth(0)[1] & 0xFFFFU) == 251U;
    };
    EXPECT_TRUE(moves({})) << step_us;
    EXPECT_EQ(moves(0.5), step_us < 120'000) << step_us;
  }
}

TEST_F(SceneFlowFile, KnowsNanosecondsByTheTimeBetweenScans) {
  auto groups = scans();
  for (auto& group : groups) group.name += "000";
  EXPECT_EQ(open_scene_flow_file("s", write(groups), {})->stamp_ns(1), 1'600'000'000'100'000'000);
  groups = {scan("100000000", 0), scan("200000000", 1)};
  EXPECT_EQ(open_scene_flow_file("s", write(groups), {})->stamp_ns(1), 200'000'000);
}

TEST_F(SceneFlowFile, MakesASplitOfTheScansThatHaveAMask) {
  auto groups = scans();
  groups[0].arrays.push_back(
      hdf5_array<std::uint8_t>("eval_mask", Kind::kTruth, {4, 1}, {0, 1, 1, 0}));
  const Dataset data = open_dataset(write(groups), {});
  ASSERT_EQ(data.splits.size(), 1U);
  EXPECT_EQ(data.splits[0].name, "eval");
  EXPECT_THAT(*data.splits[0].parts.at(0).stems, ElementsAre("1600000000000000"));
  EXPECT_THAT(data.sequences[0]->read_truth(0), ElementsAre(99, 251 + (3 << 16), 0, 40));
  EXPECT_TRUE(open_dataset(write(scans(), "other.h5"), {}).splits.empty());
}

TEST_F(SceneFlowFile, TakesTheEgoMotionByWhichTheFlowWasMade) {
  auto groups = scans();
  groups[0].arrays.push_back(hdf5_array<float>(
      "ego_motion", Kind::kReal, {4, 4}, {1, 0, 0, -0.9F, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}));
  EXPECT_EQ(open_scene_flow_file("s", write(groups), {})->read_truth(0)[0], 251U);
}

TEST_F(SceneFlowFile, TakesTheFourthColumnForTheIntensity) {
  auto groups = scans();
  groups[0].arrays[0] = hdf5_array<float>(
      "lidar", Kind::kReal, {4, 5}, {5, 0, 0, 7, 1, 6, 1, 0, 8, 1, 7, 0, 0, 9, 1, 8, 0, -1, 10, 1});
  const Frame frame = open_scene_flow_file("s", write(groups), {})->read(0);
  EXPECT_EQ(frame.points[1].intensity, 8.0F);
  EXPECT_EQ(frame.points[3].z, -1.0F);
}

TEST_F(SceneFlowFile, LeavesOutGroupsThatADriveWasCutAt) {
  auto groups = scans();
  groups.push_back({"1600000000300000", {hdf5_array<float>("else", Kind::kReal, {1}, {1})}});
  const auto drive = open_scene_flow_file("s", write(groups), {});
  EXPECT_EQ(drive->size(), 3U);
  EXPECT_THAT(drive->recording().doubts, Contains(HasSubstr("the first is 1600000000300000")));
}

TEST_F(SceneFlowFile, NeedsNoPosesWhereOthersAreGiven) {
  auto groups = scans();
  const Hdf5GroupBytes posed = groups[0];
  const auto drop = [&](const std::string& name) {
    for (Hdf5GroupBytes& group : groups) {
      std::erase_if(group.arrays, [&](const auto& array) { return array.first.name == name; });
    }
  };
  drop("pose");
  Reading odometry;
  odometry.poses = ByOdometry{};
  EXPECT_THAT(
      message_of<DataError>([&] { open_scene_flow_file("s", write(groups), odometry); }),
      HasSubstr("group 1600000000000000 has no pose, expected pose (4, 4) or ego_motion where"));
  drop("flow");
  const auto bare = open_scene_flow_file("s", write(groups), odometry);
  EXPECT_EQ(bare->size(), 3u);
  EXPECT_FALSE(bare->has_truth(0));
  EXPECT_EQ(bare->read(0).points.size(), 4u);
  for (const bool of_some : {false, true}) {
    if (of_some) groups[0].arrays.push_back(posed.arrays.at(1));
    try {
      open_scene_flow_file("s", write(groups), {});
      ADD_FAILURE() << "opened";
    } catch (const MissingPoses& missing) {
      EXPECT_THAT(missing.what(), HasSubstr("has no pose, expected pose (4, 4) in each group, in a "
                                            "file given by poses, or found by odometry"));
      EXPECT_EQ(missing.of_some, of_some);
    }
  }
}

TEST_F(SceneFlowFile, NamesWhatIsWrong) {
  const auto file = (folder_ / "drive.h5").string();
  auto groups = scans();
  groups[2].arrays.erase(groups[2].arrays.begin() + 1);
  EXPECT_THAT(error_of(groups),
              AllOf(StartsWith(file), HasSubstr("has no pose"), HasSubstr("expected")));
  groups = {scan("1", 0), scan("01", 0)};
  EXPECT_THAT(error_of(groups), HasSubstr("have the same stamp"));
  EXPECT_THAT(error_of({scan("first", 0)}), HasSubstr("group first is not named by a stamp"));
  EXPECT_THAT(error_of({scan("9999999999999999999", 0)}), HasSubstr("later than any stamp"));
  EXPECT_THAT(error_of({}), HasSubstr("holds no scans"));
  EXPECT_THAT(error_with<float>("lidar", Kind::kReal, {2, 2}, {1, 2, 3, 4}),
              HasSubstr("lidar has shape (2, 2), expected (N, 3 or more)"));
  EXPECT_THAT(error_with<float>("flow", Kind::kReal, {1, 3}, {1, 2, 3}),
              HasSubstr("flow has shape (1, 3), expected (4, 3)"));
  EXPECT_THAT(error_with<std::uint8_t>("flow_is_valid", Kind::kTruth, {3}, {1, 1, 1}),
              HasSubstr("flow_is_valid has shape (3), expected (4)"));
  EXPECT_THAT(error_with<double>("pose", Kind::kReal, {4, 4}, std::vector<double>(16, 1.0)),
              HasSubstr("pose is no pose"));
  groups = scans();
  groups[0].arrays[2] = hdf5_array<float>("ground_mask", Kind::kReal, {4}, {0, 0, 0, 1});
  EXPECT_THAT(error_of(groups), HasSubstr("ground_mask holds reals"));
}

TEST_F(SceneFlowFile, RefusesNumbersThatLabelsAndClassesCannotHold) {
  const auto error_of_first = [&](const std::string& name, std::vector<std::int64_t> values) {
    auto groups = scans();
    std::erase_if(groups[0].arrays, [&](const auto& array) { return array.first.name == name; });
    groups[0].arrays.push_back(hdf5_array(name, Kind::kInteger, {4}, std::move(values)));
    return error_of(groups);
  };
  EXPECT_THAT(error_of_first("mos_label", {9, 9, (std::int64_t{1} << 32) + 251, 9}),
              HasSubstr("1600000000000000/mos_label[2] is 4294967547, expected 0 to 4294967295"));
  EXPECT_THAT(error_of_first("mos_label", {-1, 9, 9, 9}), HasSubstr("mos_label[0] is -1"));
  EXPECT_THAT(error_of_first("flow_category_indices", {0, 256, 0, 0}),
              HasSubstr("1600000000000000/flow_category_indices[1] is 256, expected 0 to 255"));
  EXPECT_THAT(error_of_first("flow_category_indices", {0, 0, 0, -1}),
              HasSubstr("flow_category_indices[3] is -1"));
}

TEST_F(SceneFlowFile, SaysWhereNothingTellsWhichFlowIsValid) {
  auto groups = scans();
  EXPECT_THAT(open_scene_flow_file("s", write(groups), {})->remarks(),
              Not(Contains(HasSubstr("flow_is_valid"))));
  std::erase_if(groups[1].arrays,
                [](const auto& array) { return array.first.name == "flow_is_valid"; });
  const auto drive = open_scene_flow_file("s", write(groups), {});
  EXPECT_THAT(drive->remarks(),
              Contains("1 scan has flow without flow_is_valid: all of it is taken for valid"));
  EXPECT_EQ(drive->read(1).truth->at(2) & 0xFFFFU, 251U);
}

TEST_F(SceneFlowFile, RefusesFilesThatAreNoneOrCut) {
  const auto text = folder_.write("text.h5", "text");
  EXPECT_THAT(message_of<DataError>([&] { open_scene_flow_file("s", text, {}); }),
              AllOf(StartsWith(text.string()), HasSubstr("does not begin as a file of HDF5")));
  const std::string bytes = read_file(write(scans()));
  for (const std::size_t size : {bytes.size() - 1, bytes.size() / 2, std::size_t{8}}) {
    const auto cut = folder_.write("cut.h5", bytes.substr(0, size));
    EXPECT_THAT(message_of<DataError>([&] { open_scene_flow_file("s", cut, {}); }),
                AllOf(StartsWith(cut.string()), HasSubstr("expected a whole HDF5 file")));
  }
  EXPECT_THROW(open_dataset(write(scans()), {.reading = {.point_times = PointTimes::kColumn}}),
               UsageError);
}

TEST(SceneFlowFolder, NamesAFileThatIsEmptyOrNone) {
  const TempFolder folder;
  folder.write("data/a.h5", "");
  for (const char* place : {"data", "data/a.h5"}) {
    EXPECT_THAT(message_of<DataError>([&] { open_dataset(folder / place, {}); }),
                AllOf(HasSubstr("a.h5: is empty, expected a whole HDF5 file of OpenSceneFlow")))
        << place;
  }
  folder.write("data/a.h5", "\x89HDF");
  EXPECT_THAT(message_of<DataError>([&] { open_dataset(folder / "data", {}); }),
              HasSubstr("a.h5: does not begin as a file of HDF5"));
}

TEST_F(SceneFlowFile, IsWrittenWithTheSameBytesInAnyOrder) {
  const Dataset data = open_dataset(write(scans()), {});
  const Sequence& drive = *data.sequences.at(0);
  const auto written = [&](const char* name, const std::vector<std::size_t>& order) {
    const auto writer = write_as_scene_flow(folder_ / name, {});
    for (const std::size_t k : order) writer->write(k, drive.read(k));
    writer->finish();
    return read_file(folder_ / name);
  };
  EXPECT_EQ(written("a.h5", {0, 1, 2}), written("b.h5", {2, 0, 1}));
  const auto again = open_scene_flow_file("s", folder_ / "a.h5", {});
  ASSERT_EQ(again->size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(again->read(k).truth, drive.read(k).truth);
    EXPECT_EQ(again->stamp_ns(k), drive.stamp_ns(k));
    EXPECT_EQ(again->map_from_sensor(k).matrix(), drive.map_from_sensor(k).matrix());
  }
}

TEST_F(SceneFlowFile, RefusesScansThatAreNotLater) {
  const auto writer = write_as_scene_flow(folder_ / "a.h5", {});
  Frame frame;
  frame.stem = "x";
  frame.stamp_ns = 5;
  writer->write(0, frame);
  EXPECT_THAT(message_of<DataError>([&] {
                writer->write(1, frame);
                writer->write(2, frame);
              }),
              HasSubstr("scan x is not later than the one before it"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.h5"));
}

TEST_F(SceneFlowFile, NamesAFolderThatCannotBeWritten) {
  const auto file = folder_.write("file", "") / "below" / "a.h5";
  const auto writer = write_as_scene_flow(file, {});
  EXPECT_THAT(message_of<DataError>([&] { writer->write(0, Frame{}); }),
              AllOf(StartsWith(file.string()), HasSubstr("cannot be written")));
}

TEST(SceneFlowWithoutLibrary, SaysHowToHaveIt) {
  if (has_hdf5()) GTEST_SKIP() << "this build has libhdf5";
  const TempFolder folder;
  const auto file = folder.write("a.h5", "\x89HDF\r\n\x1a\n");
  EXPECT_THAT(message_of<DataError>([&] { open_dataset(file, {}); }),
              HasSubstr("this build reads and writes no .h5, expected a build with libhdf5"));
}

TEST(MovingSpeed, IsForDataSetsOfSceneFlowAlone) {
  const TempFolder folder;
  folder.write("velodyne/000000.bin", "");
  folder.write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  EXPECT_THAT(message_of<UsageError>(
                  [&] { open_dataset(folder.path(), {.reading = {.moving_speed_m_s = 1.0}}); }),
              HasSubstr("moving_speed_m_s: the truth of semantickitti is no speed"));
}

}  // namespace
}  // namespace mosbench
