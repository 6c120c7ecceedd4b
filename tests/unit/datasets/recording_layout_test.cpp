#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/formats/bin_file.hpp"
#include "datasets/layouts/dataset.hpp"
#include "datasets/text/errors.hpp"
#include "tests/bag_bytes.hpp"
#include "tests/temp_folder.hpp"
#include "tests/unit/datasets/sequence_names.hpp"

namespace mosbench {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kTwoPoses = "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 2 0 1 0 0 0 0 1 0\n";

/// A bag with one scan of an Ouster's topic and two poses, as many a robot records it.
std::string ouster_bag() {
  constexpr std::int64_t kScan_ns = 1'500'000'000'000'000'000;
  BagBytes bag;
  bag.connections = {{"/os1_cloud_node/points", std::string(kPointCloud2)},
                     {"/tf", std::string(kTfMessage)}};
  bag.chunks = {{{0, kScan_ns, timed_cloud(kScan_ns, {{1, 2, 3, 4}}, {})},
                 {1, kScan_ns, tf_at(kScan_ns, Pose::Identity())}}};
  return bag.str();
}

class AnyRecording : public testing::Test {
 protected:
  Dataset opened(const std::string& below, const Reading& reading = {}) const {
    return open_dataset(folder_ / below, {.reading = reading});
  }
  std::string error_of_opening(const std::string& below) const {
    return message_of<DataError>([&] { opened(below); });
  }

  TempFolder folder_;
};

TEST_F(AnyRecording, IsAFolderOfScansWithItsPoses) {
  for (const char* name : {"1.bin", "2.bin"}) {
    folder_.write(std::string("drive/") + name, std::string(32, '\0'));
  }
  EXPECT_THAT(error_of_opening("drive"),
              AllOf(HasSubstr("poses.txt: does not exist"), HasSubstr("found by odometry")));
  folder_.write("drive/poses.txt", kTwoPoses);
  const Dataset dataset = opened("drive");
  EXPECT_EQ(dataset.kind, DatasetKind::kRecording);
  EXPECT_THAT(dataset.remarks, Contains("recognised as recording: 2 .bin files are there"));
  EXPECT_THAT(sequence_names(dataset), ElementsAre("drive"));
  const Frame frame = dataset.sequences[0]->read(1);
  EXPECT_EQ(frame.points.size(), 2U);
  EXPECT_EQ(frame.map_from_sensor.translation().x(), 2.0);
  EXPECT_EQ(dataset.sequences[0]->scan_file(0), folder_ / "drive/1.bin");
}

TEST_F(AnyRecording, IsAFolderOfPly) {
  folder_.write("drive/a.ply",
                "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                "property float z\nend_header\n1 2 3\n");
  const Dataset dataset = opened("drive", {.poses = ByOdometry{}});
  EXPECT_THAT(dataset.remarks, Contains(HasSubstr("1 .ply file is")));
  EXPECT_EQ(dataset.sequences[0]->read(0).points[0].z, 3.0F);
}

TEST_F(AnyRecording, IsOneScan) {
  folder_.write("one/scan.bin", format_bin(std::vector<Point>{{1, 2, 3, 4}}));
  const Dataset dataset = opened("one/scan.bin");
  EXPECT_EQ(dataset.kind, DatasetKind::kRecording);
  EXPECT_THAT(dataset.remarks, Contains(HasSubstr("it is a scan")));
  ASSERT_EQ(dataset.sequences[0]->size(), 1U);
  EXPECT_EQ(dataset.sequences[0]->stem(0), "scan");
  EXPECT_EQ(dataset.sequences[0]->read(0).points[0].y, 2.0F);
  EXPECT_FALSE(dataset.sequences[0]->has_truth(0));
  folder_.write("p.txt", "1 0 0 7 0 1 0 0 0 0 1 0\n");
  const Dataset posed = opened("one/scan.bin", {.poses = PoseFile{folder_ / "p.txt"}});
  EXPECT_EQ(posed.sequences[0]->map_from_sensor(0).translation().x(), 7.0);
  EXPECT_THROW(opened("one/scan.bin", {.point_times = PointTimes::kColumn, .bin_columns = 5}),
               UsageError);
}

TEST_F(AnyRecording, IsABagThatIsNotOfDoals) {
  folder_.write("robot/drive.bag", ouster_bag());
  for (const char* path : {"robot", "robot/drive.bag"}) {
    const Dataset dataset = opened(path);
    EXPECT_EQ(dataset.kind, DatasetKind::kRecording) << path;
    EXPECT_EQ(dataset.sequences[0]->size(), 1U) << path;
  }
  EXPECT_THAT(sequence_names(opened("robot")), ElementsAre("robot"));
  EXPECT_THAT(sequence_names(opened("robot/drive.bag")), ElementsAre("drive"));
  folder_.write("robot/more.bag", ouster_bag());
  EXPECT_THAT(sequence_names(opened("robot")), ElementsAre("drive", "more"));
}

TEST_F(AnyRecording, IsKnownByItsBytesWhateverItsName) {
  folder_.write("robot/drive.dat", ouster_bag());
  EXPECT_EQ(opened("robot/drive.dat").sequences[0]->size(), 1U);
}

TEST_F(AnyRecording, IsOfDoalsOnlyByWhatLiesAroundIt) {
  folder_.write("station/sequence_1/points.bag", ouster_bag());
  EXPECT_EQ(opened("station/sequence_1").kind, DatasetKind::kDoals);
  EXPECT_EQ(opened("station/sequence_1/points.bag").kind, DatasetKind::kDoals);
  folder_.write("robot/drive.bag", ouster_bag());
  folder_.write("robot/indices.csv", "1500000000000000000,0\n");
  EXPECT_EQ(opened("robot").kind, DatasetKind::kDoals);
  EXPECT_EQ(opened("robot/drive.bag").kind, DatasetKind::kDoals);
}

TEST_F(AnyRecording, NamesWhatIsNotRead) {
  for (const char* name : {"a.pcap", "b.pcap", "note.txt"}) {
    folder_.write(std::string("raw/") + name, "x");
  }
  EXPECT_THAT(error_of_opening("raw"), HasSubstr("but 3 files, 2 of them called *.pcap"));
  EXPECT_THAT(error_of_opening("raw/a.pcap"), HasSubstr("is no file that is read"));
}

}  // namespace
}  // namespace mosbench
