#include <bzlib.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lz4frame.h>

#include <cmath>
#include <functional>
#include <string>

#include "datasets/disk/files.hpp"
#include "datasets/layouts/layout.hpp"
#include "datasets/rosbag/bag_reader.hpp"
#include "datasets/rosbag/bag_sequence.hpp"
#include "datasets/rosbag/bag_writer.hpp"
#include "datasets/rosbag/chunk_reader.hpp"
#include "datasets/rosbag/ros_messages.hpp"
#include "datasets/text/errors.hpp"
#include "tests/bag_bytes.hpp"
#include "tests/temp_folder.hpp"
#include "tests/unit/datasets/pose_at_x.hpp"

namespace mosbench {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::int64_t kStart = 1'500'000'000'000'000'000;
constexpr std::int64_t kPeriod = 100'000'000;

const std::vector<Point> kPoints = {{1, 2, 3, 4}, {0, 0, 0, 0}, {5, 6, 7, 8}};

/// Three scans and four transforms, the sensor going 1 m per scan.
BagBytes good_bag(const std::vector<std::uint32_t>& times_ns = {}) {
  BagBytes bag;
  bag.connections = {{"/os1_cloud_node/points", std::string(kPointCloud2)},
                     {"/tf", std::string(kTfMessage)}};
  for (std::int64_t i = 0; i < 4; ++i) {
    const std::int64_t stamp_ns = kStart + i * kPeriod;
    std::vector<BagEntry> chunk = {
        {1, stamp_ns, tf_at(stamp_ns, pose_at_x(static_cast<double>(i)))}};
    if (i < 3) chunk.push_back({0, stamp_ns, timed_cloud(stamp_ns, kPoints, times_ns)});
    bag.chunks.push_back(chunk);
  }
  return bag;
}

class Bag : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& bytes) const {
    return folder_.write("s.bag", bytes);
  }
  std::string error_of(const BagBytes& bag, const Reading& options = {}) const {
    return error_of(bag.str(), options);
  }
  std::string error_of(const std::string& bytes, const Reading& options = {}) const {
    const auto file = write(bytes);
    return message_of<DataError>([&] {
      const BagSequence recording("s", file, options);
      for (std::size_t i = 0; i < recording.size(); ++i) recording.read(i);
    });
  }

  TempFolder folder_;
};

TEST_F(Bag, GivesScansInOrderWithTheirPosesAndStamps) {
  const BagSequence recording("s", write(good_bag().str()), {});
  ASSERT_EQ(recording.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const Frame frame = recording.read(i);
    EXPECT_EQ(frame.stem, "00000" + std::to_string(i));
    EXPECT_EQ(frame.stamp_ns, kStart + static_cast<std::int64_t>(i) * kPeriod);
    EXPECT_EQ(frame.map_from_sensor.translation().x(), static_cast<double>(i));
    ASSERT_EQ(frame.points.size(), 3U);
    EXPECT_EQ(frame.points[2].z, 7.0F);
  }
}

TEST_F(Bag, MovesEveryPointToWhereTheSensorIsAtTheStampAndKeepsCountAndOrder) {
  const BagSequence recording("s", write(good_bag({20'000'000, 20'000'000, 70'000'000}).str()), {});
  const Frame frame = recording.read(1);
  EXPECT_DOUBLE_EQ(frame.map_from_sensor.translation().x(), 1.0);
  EXPECT_EQ(frame.map_from_sensor.matrix(), recording.map_from_sensor(1).matrix());
  ASSERT_EQ(frame.points.size(), 3U);
  EXPECT_FLOAT_EQ(frame.points[0].x, 1.2F);
  EXPECT_EQ(frame.points[1].x, 0.0F) << "a missing return stays one";
  EXPECT_FLOAT_EQ(frame.points[2].x, 5.7F);
  EXPECT_EQ(frame.points[2].y, 6.0F);
  EXPECT_EQ(frame.stamp_ns, kStart + kPeriod);
}

TEST_F(Bag, KeepsRawScansWhenTold) {
  const BagSequence recording("s", write(good_bag({0, 0, 50'000'000}).str()),
                              {.deskew = Deskew::kNone});
  EXPECT_EQ(recording.read(0).points[2].x, 5.0F);
}

/// A bag whose points were measured before the stamps: the type of their times is int32.
std::string bag_stamped_at_the_end() {
  const auto before = [](int ms) { return static_cast<std::uint32_t>(-1'000'000 * ms); };
  BagBytes bag = good_bag({before(90), before(40), before(30)});
  const std::string field("t\x10\0\0\0\6", 6);
  for (auto& chunk : bag.chunks) {
    if (chunk.size() < 2) continue;
    std::string& cloud = chunk[1].message;
    cloud[cloud.find(field) + field.size() - 1] = 5;
  }
  return bag.str();
}

TEST_F(Bag, StampedAtTheEndOfItsSweepsHasPosesOfTheStamps) {
  const BagSequence recording("s", write(bag_stamped_at_the_end()), {});
  ASSERT_EQ(recording.size(), 2U) << "of the first scan only the end is known";
  const Frame frame = recording.read(0);
  EXPECT_EQ(frame.map_from_sensor.translation().x(), 1.0);
  EXPECT_EQ(recording.map_from_sensor(0).translation().x(), 1.0);
  EXPECT_FLOAT_EQ(frame.points[0].x, 0.1F);
  EXPECT_FLOAT_EQ(frame.points[2].x, 4.7F);
}

TEST_F(Bag, LeavesScansRawThatThePosesOfAFileDoNotCover) {
  const auto rows = folder_.write("rows.csv", "0,0,0,0,0,0,1\n-1,0,0,0,0,0,1\n-2,0,0,0,0,0,1\n");
  const BagSequence paired("s", write(bag_stamped_at_the_end()), {.poses = PoseFile{rows}});
  ASSERT_EQ(paired.size(), 3U);
  EXPECT_FLOAT_EQ(paired.read(0).points[2].x, 5.0F) << "nothing is known before";
  EXPECT_FLOAT_EQ(paired.read(2).points[2].x, 4.7F);
  EXPECT_THAT(paired.remarks(), Contains(HasSubstr("but for scans at the ends of the poses")));
  EXPECT_THAT(paired.recording().doubts, testing::IsEmpty());
  // Between stamps all rows count, also those beyond the scans.
  std::string tum;
  for (int i = -2; i < 8; ++i) {
    tum += fmt::format("{:.2f} {} 0 0 0 0 0 1\n", 1.5e9 + 0.05 * i, i == 3 ? 5.0 : 0.5 * i);
  }
  const BagSequence stamped("s", write(bag_stamped_at_the_end()),
                            {.poses = PoseFile{folder_.write("tum.txt", tum)}});
  EXPECT_FLOAT_EQ(stamped.read(0).points[2].x, 4.7F);
  EXPECT_FLOAT_EQ(stamped.read(1).points[2].x, 4.7F);
  // 30 ms before its stamp the sensor was at 3.8 m rather than 2 m, by the row of 0.15 s.
  EXPECT_FLOAT_EQ(stamped.read(2).points[2].x, 6.8F);
}

TEST_F(Bag, SaysThatScansAndPosesAreStampedByTwoClocks) {
  // Sixteen scans of 0.1 s, stamped by a clock that is so far ahead of the recorder's and of tf's.
  const auto bag_of_clocks = [](double ahead_s, double recorder_s) {
    BagBytes bag = good_bag();
    bag.chunks.clear();
    for (std::int64_t i = -40; i < 60; ++i) {
      const std::int64_t stamp_ns = kStart + i * kPeriod;
      const std::int64_t recorded_ns = stamp_ns + std::llround(1e9 * recorder_s);
      bag.chunks.push_back({{1, recorded_ns, tf_at(stamp_ns, pose_at_x(static_cast<double>(i)))}});
      if (i < 0 || i >= 16) continue;
      bag.chunks.back().push_back(
          {0, recorded_ns, timed_cloud(stamp_ns + std::llround(1e9 * ahead_s), kPoints, {})});
    }
    return bag.str();
  };
  // A bag that was recorded from another one has the recorder's clock elsewhere.
  for (const double recorder_s : {0.0, 0.4, 86400.0}) {
    for (const double ahead_s : {0.0, -0.3}) {
      const BagSequence one("s", write(bag_of_clocks(ahead_s, recorder_s)), {});
      EXPECT_THAT(one.recording().doubts, testing::IsEmpty()) << ahead_s << " " << recorder_s;
    }
    for (const double ahead_s : {2.0, -2.5, 3.0}) {
      const BagSequence two("s", write(bag_of_clocks(ahead_s, recorder_s)), {});
      EXPECT_THAT(two.recording().doubts,
                  Contains(HasSubstr(fmt::format("the clock of the scans is {:+.3f} s", ahead_s))));
    }
    EXPECT_THAT(error_of(bag_of_clocks(-1e-9 * static_cast<double>(kStart), recorder_s)),
                HasSubstr("the times of recording would fit"));
  }
}

TEST_F(Bag, CountsScansThatNoTransformCovers) {
  BagBytes bag = good_bag({0, 0, 60'000'000});
  bag.chunks.pop_back();
  const BagSequence recording("s", write(bag.str()), {});
  EXPECT_EQ(recording.size(), 2U);
  EXPECT_THAT(recording.recording().doubts, Contains(HasSubstr("1 of 3 scans are left out")));
  EXPECT_EQ(recording.stamp_ns(1), kStart + kPeriod);
}

TEST_F(Bag, TakesPosesOfTransformStampedOrOfAFile) {
  BagBytes bag = good_bag();
  bag.connections[1] = {"/T_map_os1_lidar", std::string(kTransformStamped)};
  for (auto& chunk : bag.chunks) chunk[0].message.erase(0, 4);  // the count of a TFMessage
  const BagSequence stamped("s", write(bag.str()), {});
  EXPECT_EQ(stamped.read(2).map_from_sensor.translation().x(), 2.0);
  const auto poses = folder_.write("p.csv", "-1,0,0,0,0,0,1\n-2,0,0,0,0,0,1\n-3,0,0,0,0,0,1\n");
  const BagSequence told("s", write(bag.str()), {.poses = PoseFile{poses}});
  EXPECT_EQ(told.read(2).map_from_sensor.translation().x(), 3.0);
}

TEST_F(Bag, ReadsThroughAChainOfFrames) {
  BagBytes bag = good_bag();
  bag.connections.push_back({"/tf_static", std::string(kTfMessage)});
  Pose map_in_world = pose_at_x(100.0);
  map_in_world.linear() = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  bag.chunks[0].push_back(
      {2, kStart, format_tf_message({{kStart, "world", "/map", map_in_world}})});
  const BagSequence to_map("s", write(bag.str()), {});
  EXPECT_EQ(to_map.read(1).map_from_sensor.translation().x(), 1.0);
  const BagSequence to_world("s", write(bag.str()), {.map_frame = "world"});
  const Eigen::Vector3d sensor_m = to_world.read(1).map_from_sensor.translation();
  EXPECT_TRUE(sensor_m.isApprox(Eigen::Vector3d(100, 1, 0), 1e-12)) << sensor_m.transpose();
}

TEST_F(Bag, IsTheScansOfADoalsSequence) {
  write(good_bag().str());
  folder_.write("indices.csv", std::to_string(kStart + kPeriod) + ",2\n");
  const auto open = layout_of(DatasetKind::kDoals).open;
  const auto opened = open({"s", folder_.path(), ""}, {});
  const Sequence& sequence = *opened;
  EXPECT_EQ(sequence.size(), 3U);
  EXPECT_TRUE(sequence.has_truth(1));
  EXPECT_THAT(*sequence.read(1).truth, ElementsAre(kStaticLabel, kStaticLabel, kMovingLabel));
  folder_.write("indices.csv", std::to_string(kStart + 1) + ",2\n");
  EXPECT_THAT(message_of<DataError>([&] {
                open({"s", folder_.path(), ""}, {});
              }),
              HasSubstr("0 scans have the stamp"));
}

TEST_F(Bag, NamesWhatItLacks) {
  BagBytes bag = good_bag();
  EXPECT_THAT(error_of(bag, {.topic = "/points"}),
              testing::AllOf(HasSubstr("no PointCloud2 topic /points"),
                             HasSubstr("/os1_cloud_node/points (sensor_msgs/PointCloud2)")));
  EXPECT_THAT(
      error_of(bag, {.map_frame = "odom"}),
      testing::AllOf(HasSubstr("no transforms lead from odom to lidar"), HasSubstr("poses FILE")));
  BagBytes two_topics = bag;
  two_topics.connections = {{"/a", std::string(kPointCloud2)}, {"/b", std::string(kPointCloud2)}};
  EXPECT_THAT(error_of(two_topics), HasSubstr("several PointCloud2 topics: /a, /b"));
  BagBytes no_message = bag;
  for (auto& chunk : no_message.chunks) chunk.resize(1);
  EXPECT_THAT(error_of(no_message), HasSubstr("holds no message"));
  BagBytes nothing;
  EXPECT_THAT(error_of(nothing), HasSubstr("holds no sensor_msgs/PointCloud2 but nothing"));
  BagBytes late = bag;
  late.chunks.resize(1);
  late.chunks[0][0].message = tf_at(kStart + 5 * kPeriod, pose_at_x(0));
  EXPECT_THAT(error_of(late), HasSubstr("transforms cover 0 of 1 scan"));
}

TEST_F(Bag, RefusesWhatIsDamaged) {
  const std::string good = good_bag().str();
  ASSERT_EQ(error_of(good), "nothing thrown");
  EXPECT_THAT(error_of(std::string()), HasSubstr("s.bag: is empty, expected a bag"));
  EXPECT_THAT(error_of("#ROSBAG V1.2\n"), HasSubstr("does not start like a ROS bag"));
  EXPECT_THAT(error_of(good.substr(0, good.size() - 1)), HasSubstr("is cut off"));
  EXPECT_THAT(error_of(good.substr(0, good.size() / 2)), HasSubstr("is cut off"));
  BagBytes bag = good_bag();
  bag.compression = "zstd";
  EXPECT_THAT(error_of(bag), HasSubstr("compressed by \"zstd\""));
  bag = good_bag();
  bag.closed = false;
  EXPECT_THAT(error_of(bag), HasSubstr("rosbag reindex"));
  bag = good_bag();
  bag.more_header_fields = {{"encryptor", "rosbag/AesCbcEncryptor"}};
  EXPECT_THAT(error_of(bag), HasSubstr("is encrypted"));
  bag = good_bag();
  bag.connections.pop_back();
  EXPECT_THAT(error_of(bag), HasSubstr("connection 1 of a message is missing"));
  bag = good_bag();
  bag.offset_error_bytes = 1;
  EXPECT_THAT(error_of(bag), testing::Not("nothing thrown"));
  bag.offset_error_bytes = 1 << 20;
  EXPECT_THAT(error_of(bag), HasSubstr("points beyond its chunk"));
}

TEST_F(Bag, RefusesAChunkThatIsNotCompressedAsItSays) {
  for (const char* compression : {"bz2", "lz4"}) {
    BagBytes bag = good_bag();
    bag.compression = compression;
    EXPECT_THAT(error_of(bag), HasSubstr("a chunk is damaged")) << compression;
  }
}

/// A text of 26 times 4000 bytes, so that the compressors have several blocks to write.
std::string long_text() {
  std::string text;
  for (char letter = 'a'; letter <= 'z'; ++letter) text.append(4000, letter);
  return text;
}

std::string compressed_bz2(std::string text) {
  std::string packed(text.size() + 1000, '\0');
  auto size_bytes = static_cast<unsigned>(packed.size());
  EXPECT_EQ(BZ2_bzBuffToBuffCompress(packed.data(), &size_bytes, text.data(),
                                     static_cast<unsigned>(text.size()), 9, 0, 0),
            BZ_OK);
  packed.resize(size_bytes);
  return packed;
}

std::string compressed_lz4(const std::string& text) {
  LZ4F_preferences_t preferences{};
  preferences.frameInfo.contentChecksumFlag = LZ4F_contentChecksumEnabled;
  std::string packed(LZ4F_compressFrameBound(text.size(), &preferences), '\0');
  const std::size_t size_bytes =
      LZ4F_compressFrame(packed.data(), packed.size(), text.data(), text.size(), &preferences);
  EXPECT_FALSE(LZ4F_isError(size_bytes));
  packed.resize(size_bytes);
  return packed;
}

TEST(BagChunk, IsDecompressedToExactlyTheBytesThatWentIn) {
  const std::string text = long_text();
  for (const char* compression : {"bz2", "lz4"}) {
    const std::string packed =
        std::string_view(compression) == "bz2" ? compressed_bz2(text) : compressed_lz4(text);
    ASSERT_LT(packed.size(), text.size() / 10) << compression;
    const auto decompress = [&](const std::string& bytes, std::size_t size_bytes) {
      return decompress_chunk(compression, bytes, static_cast<std::uint32_t>(size_bytes), "f.bag");
    };
    EXPECT_EQ(decompress(packed, text.size()), text) << compression;
    EXPECT_THROW(decompress(packed, text.size() - 1), DataError) << compression;
    EXPECT_THROW(decompress(packed, text.size() + 1), DataError) << compression;
    EXPECT_THROW(decompress(packed.substr(0, packed.size() - 1), text.size()), DataError);
    EXPECT_THROW(decompress("", text.size()), DataError) << compression;
    std::string spoilt = packed;
    spoilt[spoilt.size() / 2] = static_cast<char>(spoilt[spoilt.size() / 2] ^ 1);
    EXPECT_THROW(decompress(spoilt, text.size()), DataError) << compression;
  }
}

TEST_F(Bag, RefusesCloudsWithoutXyzOrWithOddTypes) {
  const auto error_with = [&](const std::function<void(CloudHead&)>& spoil) {
    const std::string good = timed_cloud(kStart, kPoints, {});
    CloudHead head = parse_cloud_head(good, "f");
    const std::string records = good.substr(head.records_at_bytes, head.records_bytes);
    spoil(head);
    BagBytes bag = good_bag();
    for (auto& chunk : bag.chunks) {
      if (chunk.size() > 1) chunk[1].message = format_cloud(head, records);
    }
    return error_of(bag);
  };
  EXPECT_THAT(error_with([](CloudHead& head) { head.fields[1].name = "Y"; }),
              HasSubstr("have no field y"));
  EXPECT_THAT(error_with([](CloudHead& head) { head.fields[1].datatype = 9; }),
              HasSubstr("datatype 9"));
  EXPECT_THAT(error_with([](CloudHead& head) {
                head.fields[1].datatype = 1;  // three bytes before z
                head.fields[1].count = 3;
              }),
              HasSubstr("count 3"));
  EXPECT_THAT(error_with([](CloudHead& head) { head.fields[1].offset_bytes = 17; }),
              HasSubstr("lies beyond them"));
  EXPECT_THAT(error_with([](CloudHead& head) { head.width = 4; }), HasSubstr("4 x 1 points"));
}

TEST_F(Bag, FindsFieldsAtAnyOffsetAndOfAnyType) {
  CloudHead head;
  head.frame = "lidar";
  head.height = 2;
  head.width = 1;
  head.fields = {{"z", 1, 3, 1}, {"x", 4, 8, 1}, {"y", 12, 2, 1}};
  head.point_step_bytes = 13;
  head.row_step_bytes = 16;  // rows may be padded
  ByteSink records;
  for (const double x : {1.5, -2.5}) {
    records.put(std::uint8_t{0});
    records.put(std::int16_t{-300});
    records.put(std::uint8_t{0});
    records.put(x);
    records.put(std::uint8_t{200});
    records.put_bytes("...");
  }
  BagBytes bag = good_bag();
  bag.chunks[0][1].message = format_cloud(head, std::move(records).bytes());
  bag.chunks.resize(1);
  bag.chunks[0].push_back({1, 0, tf_at(0, pose_at_x(0.0))});
  const Frame frame = BagSequence("s", write(bag.str()), {}).read(0);
  ASSERT_EQ(frame.points.size(), 2U);
  EXPECT_EQ(frame.points[1].x, -2.5F);
  EXPECT_EQ(frame.points[1].y, 200.0F);
  EXPECT_EQ(frame.points[1].z, -300.0F);
  EXPECT_EQ(frame.points[1].intensity, 0.0F);
}

TEST(PointCloud2, GivesTimesAsTheyAreStored) {
  CloudHead head;
  head.height = 1;
  head.width = 2;
  head.fields = {{"x", 0, 7, 1}, {"y", 4, 7, 1}, {"z", 8, 7, 1}, {"time", 12, 7, 1}};
  head.point_step_bytes = 16;
  head.row_step_bytes = 32;
  ByteSink records;
  for (const float time_s : {0.0F, 0.25F}) records.put(Point{1, 2, 3, time_s});
  const TimedCloud cloud = parse_cloud(format_cloud(head, std::move(records).bytes()), "f");
  EXPECT_THAT(cloud.times, ElementsAre(0, 0.25));
}

TEST_F(Bag, WrittenByTheLibraryGivesBackWhatWentIn) {
  if (!writes_bags()) GTEST_SKIP() << "this build is without librosbag_storage";
  for (const char* compression : {"none", "lz4", "bz2"}) {
    const auto file = folder_ / (std::string(compression) + ".bag");
    BagWriter writer(file, compression);
    for (std::int64_t i = 0; i < 200; ++i) {
      const std::int64_t stamp_ns = kStart + i * kPeriod;
      writer.write("/tf", stamp_ns, kTfMessage, tf_at(stamp_ns, pose_at_x(static_cast<double>(i))));
      std::vector<Point> points(1000, Point{static_cast<float>(i), 1, 2, 3});
      writer.write("/p", stamp_ns, kPointCloud2, timed_cloud(stamp_ns, points, {}));
    }
    EXPECT_FALSE(is_there(file));
    writer.close();
    const BagSequence recording("s", file, {});
    ASSERT_EQ(recording.size(), 200U) << compression;
    const Frame frame = recording.read(199);
    EXPECT_EQ(frame.map_from_sensor.translation().x(), 199.0);
    EXPECT_EQ(frame.points.at(999).x, 199.0F);
  }
  EXPECT_THAT(message_of<UsageError>([&] { BagWriter(folder_ / "z.bag", "zip"); }),
              HasSubstr("none, lz4 or bz2"));
}

}  // namespace
}  // namespace mosbench
