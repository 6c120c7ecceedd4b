#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <limits>
#include <set>
#include <span>

#include "datasets/disk/files.hpp"
#include "datasets/formats/bin_file.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/formats/point_range.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/formats/times_file.hpp"
#include "datasets/layouts/dataset.hpp"
#include "datasets/layouts/kitti_sequence.hpp"
#include "datasets/layouts/layout.hpp"
#include "datasets/sequence/fingerprint.hpp"
#include "datasets/sequence/kept_scans.hpp"
#include "datasets/text/errors.hpp"
#include "tests/temp_folder.hpp"
#include "tests/unit/datasets/pose_at_x.hpp"

namespace mosbench {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

std::vector<Point> points_of(std::size_t count) {
  std::vector<Point> points;
  for (std::size_t i = 0; i < count; ++i) points.push_back({static_cast<float>(i), 1, 2, 3});
  return points;
}

/// Scans of 3, 4, 5, ... points with the given stems, and a pose for each.
void write_recording(const TempFolder& folder, const std::vector<std::string>& stems,
                     const std::string& scan_folder = "velodyne") {
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < stems.size(); ++i) {
    write_bin(folder / (scan_folder + "/" + stems[i] + ".bin"), points_of(3 + i));
    poses.push_back(pose_at_x(0.5 * static_cast<double>(i)));
  }
  write_poses(folder / "poses.txt", poses);
}

std::string kitti_error(const TempFolder& folder) {
  return message_of<DataError>([&] { KittiSequence("s", folder.path()); });
}

TEST(KittiSequence, ReadsScansPosesTimesAndLabelsForPartOfTheScans) {
  const TempFolder folder;
  write_recording(folder, {"000000", "000001", "000002"});
  write_times(folder / "times.txt", std::vector<std::int64_t>{0, 100000000, 1582193985123456789});
  write_labels(folder / "labels/000001.label", std::vector<std::uint32_t>{0, 9, 251, 0x500fb});
  const KittiSequence sequence("08", folder.path());
  EXPECT_EQ(sequence.name(), "08");
  ASSERT_EQ(sequence.size(), 3U);
  EXPECT_EQ(sequence.point_count(2), 5U);
  EXPECT_FALSE(sequence.has_truth(0));
  EXPECT_TRUE(sequence.has_truth(1));

  const Frame frame = sequence.read(1);
  EXPECT_EQ(frame.stem, "000001");
  EXPECT_EQ(format_bin(frame.points), format_bin(points_of(4)));
  EXPECT_EQ(frame.map_from_sensor.matrix(), pose_at_x(0.5).matrix());
  EXPECT_EQ(frame.stamp_ns, 100000000);
  ASSERT_TRUE(frame.truth.has_value());
  EXPECT_THAT(*frame.truth, ElementsAre(0U, 9U, 251U, 0x500fbU));
  EXPECT_EQ(sequence.read_truth(1), *frame.truth);

  EXPECT_FALSE(sequence.read(0).truth.has_value());
  EXPECT_THAT(message_of<DataError>([&] { sequence.read_truth(0); }),
              AllOf(HasSubstr("000000.bin"), HasSubstr("no truth")));
  EXPECT_EQ(sequence.read(2).stamp_ns, 1582193985123456789);
  EXPECT_THAT(sequence.remarks(), Contains("labels for 1 of 3 scans"));
  EXPECT_EQ(sequence.files().size(), 6U);
}

TEST(KittiSequence, OrdersScansByTheValueOfTheirStem) {
  const TempFolder folder;
  write_recording(folder, {"10", "9", "0100"});
  const KittiSequence sequence("s", folder.path());
  EXPECT_EQ(sequence.stem(0), "9");
  EXPECT_EQ(sequence.stem(1), "10");
  EXPECT_EQ(sequence.stem(2), "0100");
}

TEST(KittiSequence, OrdersScansByTheNumbersInTheirStems) {
  const std::vector<std::vector<std::string>> in_order = {
      {"9", "10", "first"},
      {"cloud-0", "cloud-2", "cloud-10", "cloud-100"},
      {"a-1-2", "a-1-10", "a-2"},
      {"1531883530.449377000", "1531883530.5", "1531883531", "1531883531.04", "1531883531.1"},
      {"s18446744073709551616", "s18446744073709551617", "s20000000000000000000"}};
  for (const std::vector<std::string>& stems : in_order) {
    const TempFolder folder;
    write_recording(folder, {stems.rbegin(), stems.rend()});
    const KittiSequence sequence("s", folder.path());
    for (std::size_t k = 0; k < stems.size(); ++k) EXPECT_EQ(sequence.stem(k), stems[k]);
  }
}

TEST(KittiSequence, NamesPosesThatLieAsInKittisOdometryBenchmark) {
  const TempFolder folder;
  write_bin(folder / "kitti/sequences/04/velodyne/000000.bin", points_of(3));
  const auto error = [&] {
    return message_of<DataError>([&] { KittiSequence("04", folder / "kitti/sequences/04"); });
  };
  EXPECT_THAT(error(), HasSubstr("in a file given by poses, or found by odometry"));
  write_poses(folder / "kitti/poses/04.txt", std::vector<Pose>(1, Pose::Identity()));
  EXPECT_THAT(error(), HasSubstr("04/poses.txt: does not exist, expected one pose per scan there, "
                                 "or poses " +
                                 (folder / "kitti/poses").string()));
}

TEST(KittiSequence, RefusesTwoScansWithTheSameNumber) {
  const TempFolder folder;
  write_recording(folder, {"7", "007"});
  EXPECT_THAT(kitti_error(folder), HasSubstr("same scan"));
}

TEST(KittiSequence, PassesOverHiddenAndForeignFiles) {
  const TempFolder folder;
  write_recording(folder, {"000000"});
  folder.write("velodyne/._000000.bin", "metadata of another system");
  folder.write("velodyne/000001.bin.partial", "half a scan");
  EXPECT_EQ(KittiSequence("s", folder.path()).size(), 1U);
}

TEST(KittiSequence, TakesPosesBitForBitWhenTrIsTheIdentityOrMissing) {
  const TempFolder folder;
  write_recording(folder, {"0", "1"});
  folder.write("poses.txt", "1 0 0 0.1 0 1 0 0.2 0 0 1 0.3\n1 0 0 1e-17 0 1 0 7 0 0 1 9\n");
  const KittiSequence without("s", folder.path());
  EXPECT_THAT(without.remarks(), Contains(HasSubstr("no calib.txt")));
  write_file_atomic(folder / "calib.txt", format_calib(Pose::Identity()));
  const KittiSequence with("s", folder.path());
  for (const KittiSequence* sequence : {&without, &with}) {
    EXPECT_EQ(sequence->read(0).map_from_sensor.translation(), Eigen::Vector3d(0.1, 0.2, 0.3));
    EXPECT_EQ(sequence->read(1).map_from_sensor.translation(), Eigen::Vector3d(1e-17, 7, 9));
  }
  EXPECT_THAT(with.remarks(), Each(Not(HasSubstr("calib"))));
}

TEST(KittiSequence, TurnsCameraPosesIntoLidarPosesAndSaysSo) {
  const TempFolder folder;
  write_recording(folder, {"0"});
  folder.write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 5\n");
  folder.write("calib.txt", "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n");
  const KittiSequence sequence("s", folder.path());
  EXPECT_EQ(sequence.read(0).map_from_sensor.translation(), Eigen::Vector3d(5, 0, 0));
  EXPECT_THAT(sequence.remarks(), Contains(HasSubstr("Tr^-1 * P * Tr")));
}

TEST(KittiSequence, TakesAnotherPoseFile) {
  const TempFolder folder;
  write_recording(folder, {"0"});
  std::filesystem::remove(folder / "poses.txt");
  write_poses(folder / "elsewhere.txt", std::vector<Pose>{pose_at_x(7)});
  const KittiSequence sequence("s", folder.path(),
                               Reading{.poses = PoseFile{folder / "elsewhere.txt"}});
  EXPECT_EQ(sequence.read(0).map_from_sensor.translation().x(), 7.0);
}

TEST(KittiSequence, NamesWhatIsMissing) {
  const TempFolder folder;
  EXPECT_THAT(kitti_error(folder), AllOf(HasSubstr("no folder of scans"), HasSubstr("velodyne/")));
  std::filesystem::create_directories(folder / "velodyne");
  EXPECT_THAT(kitti_error(folder), AllOf(HasSubstr("holds no scan"), HasSubstr(".bin")));
  write_bin(folder / "velodyne/0.bin", points_of(1));
  EXPECT_THAT(kitti_error(folder), AllOf(HasSubstr("poses.txt"), HasSubstr("poses")));
}

TEST(KittiSequence, NamesBothCountsWhenPosesOrTimesDoNotFit) {
  const TempFolder folder;
  write_recording(folder, {"0", "1"});
  write_poses(folder / "poses.txt", std::vector<Pose>{pose_at_x(0)});
  EXPECT_THAT(kitti_error(folder), HasSubstr("poses.txt: 1 pose rows for 2 scans"));
  write_poses(folder / "poses.txt", std::vector<Pose>{pose_at_x(0), pose_at_x(1), pose_at_x(2)});
  EXPECT_THAT(kitti_error(folder), HasSubstr("poses.txt: 3 pose rows for 2 scans"));
  write_poses(folder / "poses.txt", std::vector<Pose>{pose_at_x(0), pose_at_x(1)});
  folder.write("times.txt", "0\n0.1\n0.2\n");
  EXPECT_THAT(kitti_error(folder), HasSubstr("times.txt: 3 times for 2 scans"));
}

TEST(KittiSequence, ChecksSizesAndPairsOfFilesWhenOpened) {
  const TempFolder folder;
  write_recording(folder, {"0", "1"});
  write_labels(folder / "labels/0.label", std::vector<std::uint32_t>{9, 9});
  EXPECT_THAT(kitti_error(folder), AllOf(HasSubstr("0.label: has 8 bytes"), HasSubstr("3 points")));
  std::filesystem::remove(folder / "labels/0.label");
  write_labels(folder / "labels/2.label", std::vector<std::uint32_t>{9});
  EXPECT_THAT(kitti_error(folder), HasSubstr("2.label: belongs to no scan"));
  std::filesystem::remove(folder / "labels/2.label");
  folder.write("velodyne/1.bin", "seventeen bytes..");
  EXPECT_THAT(kitti_error(folder), HasSubstr("1.bin: 17 bytes are no multiple of 16"));
}

TEST(KittiSequence, NoticesAScanThatChangedAfterOpening) {
  const TempFolder folder;
  write_recording(folder, {"0"});
  const KittiSequence sequence("s", folder.path());
  write_bin(folder / "velodyne/0.bin", points_of(9));
  EXPECT_THAT(message_of<DataError>([&] { sequence.read(0); }), HasSubstr("changed since"));
}

std::unique_ptr<Sequence> open_doals(const std::filesystem::path& folder) {
  return layout_of(DatasetKind::kDoals).open({"s", folder, ""}, {});
}

TEST(DoalsSequence, FindsTheLabelledScansByStampAndKeepsRawOrder) {
  const TempFolder folder;
  write_recording(folder, {"000000", "000001", "000002"}, "binFiles");
  folder.write("times.txt", "1582193985.1\n1582193985.200000001\n1582193985.3\n");
  folder.write("indices.csv", "1582193985200000001,3,0,3\n1582193985300000000\n");
  const auto opened = open_doals(folder.path());
  const Sequence& sequence = *opened;
  EXPECT_FALSE(sequence.has_truth(0));
  ASSERT_TRUE(sequence.has_truth(1));
  EXPECT_THAT(sequence.read_truth(1), ElementsAre(251U, 9U, 9U, 251U));
  EXPECT_EQ(sequence.read(1).truth, sequence.read_truth(1));
  EXPECT_EQ(format_bin(sequence.read(1).points), format_bin(points_of(4)));
  EXPECT_THAT(sequence.read_truth(2), Each(9U));
}

TEST(DoalsSequence, TakesScanNamesInNanosecondsAsStamps) {
  const TempFolder folder;
  write_recording(folder, {"1582193985123456788", "1582193985123456789"});
  folder.write("indices.csv", "1582193985123456789,1\n");
  const auto opened = open_doals(folder.path());
  const Sequence& sequence = *opened;
  EXPECT_FALSE(sequence.has_truth(0));
  EXPECT_TRUE(sequence.has_truth(1));
}

TEST(DoalsSequence, NeverTakesTheNearestStamp) {
  const TempFolder folder;
  write_recording(folder, {"0", "1"});
  folder.write("times.txt", "1.000000000\n1.100000000\n");
  folder.write("indices.csv", "1000000000,1\n1100000001,1\n");
  const auto error_of_opening = [&] {
    return message_of<DataError>([&] { open_doals(folder.path()); });
  };
  EXPECT_THAT(error_of_opening(), HasSubstr("indices.csv:2: 0 scans have the stamp 1100000001"));
  folder.write("times.txt", "1\n1\n");
  EXPECT_THAT(error_of_opening(), HasSubstr("indices.csv:1: 2 scans have the stamp 1000000000"));
}

TEST(DoalsSequence, RefusesAnIndexBeyondItsScan) {
  const TempFolder folder;
  write_recording(folder, {"0", "1"});
  folder.write("times.txt", "1\n2\n");
  folder.write("indices.csv", "1000000000,2\n2000000000,4\n");
  EXPECT_THAT(message_of<DataError>([&] { open_doals(folder.path()); }),
              HasSubstr("indices.csv:2: index 4 is beyond the scan"));
}

TEST(DoalsSequence, UsesThePublishedListOnlyForTheWholePublishedRecording) {
  const TempFolder folder;
  std::string poses, rows;
  for (std::size_t i = 0; i < 1068; ++i) poses += "1 0 0 0 0 1 0 0 0 0 1 0\n";
  for (int row = 1; row <= 10; ++row) rows += std::to_string(row) + "\n";
  for (const std::string place : {"shopville/sequence_1/", "station/sequence_1/", "a/"}) {
    for (std::size_t i = 0; i < 1068; ++i) {
      folder.write(place + "velodyne/" + std::to_string(i) + ".bin", "");
    }
    folder.write(place + "poses.txt", poses);
    folder.write(place + "indices.csv", rows);
  }
  const auto sequence = open_doals(folder / "shopville/sequence_1");
  ASSERT_EQ(sequence->size(), 1068U);
  for (std::size_t i = 0; i < sequence->size(); ++i) {
    EXPECT_EQ(sequence->has_truth(i), i % 100 == 78 && i < 1000) << i;
  }
  EXPECT_THAT(sequence->remarks(), Contains(HasSubstr("DOALS sequence 5")));

  EXPECT_THAT(message_of<DataError>([&] { open_doals(folder / "a"); }),
              HasSubstr("stamps cannot be matched"));
  EXPECT_THAT(message_of<DataError>([&] { open_doals(folder / "station/sequence_1"); }),
              AllOf(HasSubstr("10 rows for 1068 scans"), HasSubstr("2008 scans")));
}

TEST(DoalsSequence, KnowsTheEightPublishedRecordings) {
  std::size_t scans = 0;
  const auto& published = layout_of(DatasetKind::kDoals).files.published;
  for (const PublishedCount& recording : published) scans += recording.scans;
  EXPECT_EQ(published.size(), 8U);
  EXPECT_EQ(scans, 12825U);
}

TEST(DoalsSequence, HasNoTruthWithoutIndices) {
  const TempFolder folder;
  write_recording(folder, {"0"});
  const auto opened = open_doals(folder.path());
  const Sequence& sequence = *opened;
  EXPECT_FALSE(sequence.has_truth(0));
  EXPECT_THAT(message_of<DataError>([&] { sequence.read_truth(0); }), HasSubstr("no truth"));
  EXPECT_THAT(sequence.remarks(), Contains(HasSubstr("no indices.csv")));
}

/// Two sequences over a scan with truth, whose scans are kept together.
struct SharedKitti {
  explicit SharedKitti(std::size_t most_bytes) : scans(std::make_shared<KeptScans>(most_bytes)) {
    write_bin(folder / "velodyne/000000.bin", points);
    folder.write("poses.txt", "1 0 0 7 0 1 0 0 0 0 1 0\n");
    write_labels(folder / "labels/000000.label", truth);
    first =
        std::make_unique<KeptSequence>(std::make_unique<KittiSequence>("s", folder.path()), scans);
    second =
        std::make_unique<KeptSequence>(std::make_unique<KittiSequence>("s", folder.path()), scans);
  }

  TempFolder folder;
  std::vector<Point> points = {{1, 2, 3, 4}, {5, 6, 7, 8}};
  std::vector<std::uint32_t> truth = {kMovingLabel, kStaticLabel};
  std::shared_ptr<KeptScans> scans;
  std::unique_ptr<Sequence> first, second;
};

TEST(KeptSequence, ReadsAScanOnceForAllThatShareIt) {
  const SharedKitti shared(1000);
  const Frame read = shared.first->read(0);
  ASSERT_EQ(read.truth, shared.truth);
  EXPECT_EQ(shared.second->kept_bytes(), 2 * (sizeof(Point) + sizeof(std::uint32_t)));
  std::filesystem::remove(shared.folder / "velodyne/000000.bin");
  Frame kept;
  kept.point_times_ns = {3};
  shared.second->read(0, kept);
  EXPECT_EQ(kept.stem, "000000");
  EXPECT_EQ(kept.map_from_sensor.translation().x(), 7);
  EXPECT_EQ(kept.truth, read.truth);
  EXPECT_TRUE(kept.point_times_ns.empty());
  ASSERT_EQ(kept.points.size(), 2U);
  EXPECT_EQ(std::memcmp(kept.points.data(), shared.points.data(), 2 * sizeof(Point)), 0);
  shared.scans->clear();
  EXPECT_EQ(shared.first->kept_bytes(), 0U);
  EXPECT_THROW(shared.second->read(0), DataError);
}

TEST(KeptSequence, ReadsAgainWhatThereIsNoRoomFor) {
  const SharedKitti shared(39);  // the scan has 40 bytes
  ASSERT_EQ(shared.first->read(0).points.size(), 2U);
  EXPECT_EQ(shared.first->kept_bytes(), 0U);
  EXPECT_EQ(shared.second->read(0).points.size(), 2U);
  std::filesystem::remove(shared.folder / "velodyne/000000.bin");
  EXPECT_THROW(shared.second->read(0), DataError);
}

TEST(KeptScans, HoldStampsTimesAndMotionsOfPoints) {
  KeptScans scans(1000);
  Frame frame;
  frame.points.resize(1);
  frame.stamp_ns = 5;
  frame.point_times_ns = {-1};
  scans.keep(6, frame);
  frame.motions.emplace().classes = {3};
  scans.keep(7, frame);
  Frame found;
  found.truth.emplace();
  EXPECT_FALSE(scans.find(5, found));
  ASSERT_TRUE(scans.find(7, found));
  EXPECT_EQ(found.motions.value().classes, frame.motions->classes);
  ASSERT_TRUE(scans.find(6, found));
  EXPECT_FALSE(found.motions);
  EXPECT_EQ(found.stamp_ns, 5);
  EXPECT_EQ(found.point_times_ns, frame.point_times_ns);
  EXPECT_FALSE(found.truth);
}

/// Every point one metre further on; the rest as in the sequence it is around.
class Shifted : public SequenceAround {
 public:
  explicit Shifted(std::unique_ptr<Sequence> inner) : SequenceAround(std::move(inner)) {}
  using Sequence::read;
  void read(std::size_t scan_index, Frame& frame) const override {
    SequenceAround::read(scan_index, frame);
    for (Point& point : frame.points) point.x += 1.0F;
  }
};

TEST(SequenceAround, ChangesWhatItOverridesAndNothingElse) {
  const TempFolder folder;
  const Point point{1, 2, 3, 4};
  write_bin(folder / "velodyne/000000.bin", {&point, 1});
  folder.write("poses.txt", "1 0 0 7 0 1 0 0 0 0 1 0\n");
  const std::uint32_t label = kMovingLabel;
  write_labels(folder / "labels/000000.label", {&label, 1});
  const KittiSequence plain("s", folder.path());
  const Shifted shifted(std::make_unique<KittiSequence>("s", folder.path()));
  Frame frame;
  frame.points.resize(100);
  frame.truth.emplace(100, 0U);
  shifted.read(0, frame);
  ASSERT_EQ(frame.points.size(), 1U);
  EXPECT_EQ(frame.points[0].x, 2.0F);
  EXPECT_EQ(frame.points[0].y, 2.0F);
  EXPECT_EQ(frame.map_from_sensor.translation().x(), 7.0);
  EXPECT_EQ(frame.truth, plain.read(0).truth);
  EXPECT_EQ(shifted.read_truth(0), plain.read_truth(0));
  EXPECT_EQ(shifted.files(), plain.files());
  EXPECT_EQ(shifted.name(), "s");
}

Frame sample_frame() {
  Frame frame;
  frame.stem = "000000";
  frame.points = points_of(4);
  frame.stamp_ns = 5;
  frame.truth = std::vector<std::uint32_t>{9, 9, 251, 0};
  return frame;
}

std::string fingerprint_of(const std::vector<Frame>& frames) {
  ContentFingerprint fingerprint;
  for (const Frame& frame : frames) fingerprint.add(frame);
  return fingerprint.hex();
}

TEST(ContentFingerprint, ChangesWithEverythingThatDecidesResults) {
  const std::string original = fingerprint_of({sample_frame()});
  EXPECT_EQ(original.size(), 32U);
  EXPECT_EQ(fingerprint_of({sample_frame()}), original);
  std::set<std::string> seen = {original, fingerprint_of({}),
                                fingerprint_of({sample_frame(), sample_frame()})};
  const auto expect_new = [&](auto&& change) {
    Frame frame = sample_frame();
    change(frame);
    EXPECT_TRUE(seen.insert(fingerprint_of({frame})).second);
  };
  expect_new([](Frame& frame) { frame.stem = "000001"; });
  expect_new([](Frame& frame) { frame.points[3].intensity = 4; });
  expect_new([](Frame& frame) { frame.points.pop_back(); });
  expect_new([](Frame& frame) { frame.map_from_sensor.translation().z() = 1e-17; });
  expect_new([](Frame& frame) { frame.stamp_ns = 6; });
  expect_new([](Frame& frame) { frame.stamp_ns.reset(); });
  expect_new([](Frame& frame) { (*frame.truth)[0] = 251; });
  expect_new([](Frame& frame) { frame.truth.reset(); });
}

TEST(FileStamp, ChangesOnlyWhenAFileDoes) {
  const TempFolder folder;
  write_recording(folder, {"0", "1"});
  const auto stamp = [&] { return file_stamp(KittiSequence("s", folder.path())); };
  const std::string original = stamp();
  EXPECT_EQ(original.size(), 32U);
  EXPECT_EQ(stamp(), original);
  const auto scan = folder / "velodyne/1.bin";
  const auto written = std::filesystem::last_write_time(scan);
  std::filesystem::last_write_time(scan, written + std::chrono::seconds(1));
  EXPECT_NE(stamp(), original);
  // As copies do that keep the time of modification.
  std::filesystem::last_write_time(scan, written);
  const std::string copied = stamp();
  EXPECT_NE(copied, original);
  EXPECT_EQ(stamp(), copied);
  folder.write("times.txt", "0\n1\n");
  EXPECT_NE(stamp(), copied);
}

TEST(PointsBeyondSight, AreMissingReturnsAndCounted) {
  const TempFolder folder;
  const std::vector<Point> sound = {{1, 2, 3, 4}, {0, -9e3F, 0, 1}};
  std::vector<Point> odd = sound;
  for (const float far_m : {1e30F, -std::numeric_limits<float>::max(), 2e6F}) {
    odd.push_back({far_m, far_m, far_m, 5});
  }
  for (int k = 0; k < 3; ++k) {
    write_bin(folder / "odd" / (std::to_string(k) + ".bin"), odd);
    write_bin(folder / "sound" / (std::to_string(k) + ".bin"), sound);
  }
  const auto open = [&](const char* name) {
    return open_dataset(folder / name, {.reading = {.poses = ByOdometry{}}});
  };
  const Dataset dataset = open("odd");
  const std::vector<Point> read = dataset.sequences[0]->read(1).points;
  ASSERT_EQ(read.size(), odd.size());
  EXPECT_EQ(format_bin(std::span(read).first(2)), format_bin(sound));
  for (std::size_t i = 2; i < read.size(); ++i) EXPECT_FALSE(is_return(read[i]));
  EXPECT_THAT(
      dataset.sequences[0]->recording().doubts,
      testing::Contains(testing::HasSubstr("9 of 15 points looked at are more than 1000 km")));
  EXPECT_THAT(open("sound").sequences[0]->recording().doubts,
              testing::Not(testing::Contains(testing::HasSubstr("1000 km"))));
}

}  // namespace
}  // namespace mosbench
