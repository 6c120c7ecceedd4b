#include "datasets/rosbag/ros2_bag.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <string>

#include "datasets/disk/files.hpp"
#include "datasets/layouts/dataset.hpp"
#include "datasets/layouts/sequence_writer.hpp"
#include "datasets/rosbag/bag_reader.hpp"
#include "datasets/rosbag/bag_sequence.hpp"
#include "datasets/rosbag/chunk_reader.hpp"
#include "datasets/rosbag/message_format.hpp"
#include "datasets/rosbag/ros2_bag.hpp"
#include "datasets/text/errors.hpp"
#include "tests/bag_bytes.hpp"
#include "tests/mcap_bytes.hpp"
#include "tests/temp_folder.hpp"
#include "tests/unit/datasets/pose_at_x.hpp"

namespace mosbench {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::int64_t kRos2Start = 1'700'000'000'000'000'000;
constexpr std::int64_t kRos2Period = 100'000'000;
constexpr auto kCdr = MessageEncoding::kCdr;
const std::vector<Point> kRos2Points = {{1, 2, 3, 4}, {0, 0, 0, 0}, {5, 6, 7, 8}};

/// Three scans and four transforms, the sensor going 1 m per scan.
McapBytes good_mcap(MessageEncoding encoding = kCdr) {
  McapBytes bag;
  bag.channels = {{"/points", "sensor_msgs/msg/PointCloud2"}, {"/tf", "tf2_msgs/msg/TFMessage"}};
  for (std::int64_t i = 0; i < 4; ++i) {
    const std::int64_t stamp_ns = kRos2Start + i * kRos2Period;
    std::vector<McapEntry> chunk = {
        {1, stamp_ns, tf_at(stamp_ns, pose_at_x(static_cast<double>(i)), encoding)}};
    if (i < 3) chunk.push_back({0, stamp_ns, timed_cloud(stamp_ns, kRos2Points, {}, encoding)});
    bag.chunks.push_back(chunk);
  }
  return bag;
}

/// The three scans at x = 0, 1, 2 m.
void expect_good(const Sequence& recording) {
  ASSERT_EQ(recording.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const Frame frame = recording.read(i);
    EXPECT_EQ(frame.stamp_ns, kRos2Start + static_cast<std::int64_t>(i) * kRos2Period);
    EXPECT_EQ(frame.map_from_sensor.translation().x(), static_cast<double>(i));
    ASSERT_EQ(frame.points.size(), 3U);
    EXPECT_EQ(std::memcmp(frame.points.data(), kRos2Points.data(), sizeof(Point) * 3), 0);
  }
}

class Ros2Bag : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& bytes, const char* name = "s.mcap") const {
    return folder_.write(name, bytes);
  }
  std::string error_of(const std::string& bytes) const {
    const auto file = write(bytes);
    return message_of<DataError>([&] {
      const BagSequence recording("s", file, {});
      for (std::size_t i = 0; i < recording.size(); ++i) recording.read(i);
    });
  }

  TempFolder folder_;
};

TEST_F(Ros2Bag, InMcapIsReadWithAndWithoutChunksIndexesAndSummary) {
  for (const char* compression : {"", "lz4", "zstd"}) {
    for (const bool in_chunks : {true, false}) {
      for (const bool has_indexes : {true, false}) {
        for (const bool has_summary : {true, false}) {
          McapBytes bag = good_mcap();
          bag.compression = compression;
          bag.in_chunks = in_chunks;
          bag.has_indexes = has_indexes;
          bag.has_summary = has_summary;
          SCOPED_TRACE(testing::Message()
                       << compression << in_chunks << has_indexes << has_summary);
          const BagSequence recording("s", write(bag.str()), {});
          expect_good(recording);
          EXPECT_THAT(recording.recording().doubts, IsEmpty());
        }
      }
    }
  }
}

TEST_F(Ros2Bag, OfEitherByteOrderGivesTheSame) {
  expect_good(BagSequence("s", write(good_mcap(MessageEncoding::kCdrBigEndian).str()), {}));
}

TEST_F(Ros2Bag, InMcapMayHoldMessagesOfRos1) {
  McapBytes bag = good_mcap(MessageEncoding::kRos1);
  for (McapChannel& channel : bag.channels) channel.encoding = "ros1";
  bag.channels[0].type = kPointCloud2;
  bag.channels[1].type = kTfMessage;
  expect_good(BagSequence("s", write(bag.str()), {}));
}

TEST_F(Ros2Bag, ThatWasNotClosedIsReadToItsLastWholeRecord) {
  McapBytes bag = good_mcap();
  bag.closed = bag.has_summary = false;
  const std::string whole = bag.str();
  const BagSequence recording("s", write(whole), {});
  expect_good(recording);
  EXPECT_THAT(recording.recording().doubts, Contains(HasSubstr("was not closed by its recorder")));
  // The last chunk, with the fourth transform, is lost; zeros are what some disks leave there.
  for (const std::string& end : {std::string(), std::string(500, '\0')}) {
    const std::string cut = whole.substr(0, whole.size() - 150) + end;
    const BagSequence shorter("s", write(cut), {});
    expect_good(shorter);
    EXPECT_THAT(shorter.recording().doubts, Contains(HasSubstr("no whole record and left out")));
  }
  std::size_t most = 0;
  for (std::size_t bytes = kMcapMagic.size(); bytes < whole.size(); bytes += 7) {
    std::size_t scans = 0;
    const auto file = write(whole.substr(0, bytes));
    const std::string error =
        message_of<DataError>([&] { scans = BagSequence("s", file, {}).size(); });
    EXPECT_GE(scans, most) << bytes << " bytes give less than fewer did: " << error;
    most = scans;
  }
  EXPECT_EQ(most, 3U);
}

TEST_F(Ros2Bag, RefusesADamagedMcap) {
  const std::string good = good_mcap().str();
  ASSERT_EQ(error_of(good), "nothing thrown");
  EXPECT_THAT(error_of("nothing"), HasSubstr("does not start like a bag"));
  EXPECT_THAT(error_of(""), HasSubstr("s.mcap: is empty, expected a bag"));
  EXPECT_THAT(error_of("PK\3\4" + std::string(90, 'x')), HasSubstr("is a zip archive"));
  EXPECT_THAT(error_of("\x1f\x8b\x08" + std::string(90, 'x')), HasSubstr("is packed by gzip"));
  EXPECT_THAT(error_of("<!DOCTYPE html><html>"), HasSubstr("seems to be a web page"));
  EXPECT_THAT(error_of(std::string(90, '\0')), HasSubstr("begins with zeros"));
  McapBytes bag = good_mcap();
  bag.compression = "br";
  EXPECT_THAT(error_of(bag.str()), HasSubstr("compressed by \"br\", expected none, lz4 or zstd"));
  bag = good_mcap();
  bag.offset_error_bytes = 1;
  EXPECT_THAT(error_of(bag.str()), testing::Not("nothing thrown"));
  bag.offset_error_bytes = 1 << 20;
  EXPECT_THAT(error_of(bag.str()), HasSubstr("points beyond its chunk"));
  bag = good_mcap();
  bag.more_counted = 1;
  EXPECT_THAT(error_of(bag.str()), HasSubstr("holds 7 messages, expected 8 by its statistics"));
  bag = good_mcap();
  bag.channels.pop_back();
  EXPECT_THAT(error_of(bag.str()), HasSubstr("channel 1 of a message is missing"));
  bag = good_mcap();
  bag.compression = "zstd";
  bag.crc = 1;
  EXPECT_THAT(error_of(bag.str()), HasSubstr("is damaged, expected content of its CRC"));
  bag = good_mcap();
  bag.channels[0].encoding = "json";
  EXPECT_THAT(error_of(bag.str()), HasSubstr("/points (sensor_msgs/PointCloud2 as json)"));
  bag = good_mcap();
  bag.chunks[0][1].message[1] = 7;  // parameter list of CDR's second version
  EXPECT_THAT(error_of(bag.str()), HasSubstr("is not encoded as plain CDR"));
}

/// Values one after the other, each with its padding written out.
TEST(Cdr, AlignsEveryNumberToItsSizeFromAfterTheFirstFourBytes) {
  const std::string bytes{
      "\0\1\0\0"      // little endian
      "\2\0\0\0a\0"   // a text with its end
      "\0\0\5\0\0\0"  // padding and a uint32
      "\7\0\0\0"      // a uint8 and padding
      "\0\0\0\0\0\0\xF8\x3F",
      28};
  const std::filesystem::path file = "f";
  MessageCursor cursor(bytes, kCdr, file, "a message");
  EXPECT_EQ(cursor.take_text(), "a");
  EXPECT_EQ(cursor.take<std::uint32_t>(), 5U);
  EXPECT_EQ(cursor.take<std::uint8_t>(), 7U);
  EXPECT_EQ(cursor.take<double>(), 1.5);
  EXPECT_EQ(cursor.position_bytes(), 28U);
  EXPECT_THROW(cursor.take<std::uint8_t>(), DataError);
  MessageSink sink(kCdr);
  sink.put_text("a");
  sink.put(std::uint32_t{5});
  sink.put(std::uint8_t{7});
  sink.put(1.5);
  EXPECT_EQ(std::move(sink).bytes(), bytes);
  const std::string big{"\0\0\0\0\0\0\1\2", 8};
  EXPECT_EQ(MessageCursor(big, kCdr, "f", "m").take<std::uint32_t>(), 258U);
}

TEST_F(Ros2Bag, WrittenIsReadAgain) {
  const std::pair<Ros2Storage, const char*> kinds[] = {{Ros2Storage::kMcap, "none"},
                                                       {Ros2Storage::kMcap, "lz4"},
                                                       {Ros2Storage::kMcap, "zstd"},
                                                       {Ros2Storage::kSqlite, "none"},
                                                       {Ros2Storage::kSqlite, "zstd"}};
  for (const auto& [storage, compression] : kinds) {
    SCOPED_TRACE(std::string(message_file_of(storage)) + compression);
    const auto folder = folder_ / (std::string(message_file_of(storage)) + compression);
    const auto writer = Ros2BagWriter::open(storage, folder, compression);
    for (std::int64_t i = 0; i < 200; ++i) {
      const std::int64_t stamp_ns = kRos2Start + i * kRos2Period;
      writer->write("/tf", stamp_ns, kTfMessage,
                    tf_at(stamp_ns, pose_at_x(static_cast<double>(i)), kCdr));
      const std::vector<Point> points(1000, Point{static_cast<float>(i), 1, 2, 3});
      writer->write("/p", stamp_ns, kPointCloud2, timed_cloud(stamp_ns, points, {}, kCdr));
    }
    EXPECT_FALSE(is_there(folder / message_file_of(storage)));
    writer->close();
    for (const auto& path : {folder, folder / message_file_of(storage)}) {
      const BagSequence recording("s", path, {});
      ASSERT_EQ(recording.size(), 200U);
      const Frame frame = recording.read(199);
      EXPECT_EQ(frame.map_from_sensor.translation().x(), 199.0);
      EXPECT_EQ(frame.points.at(999).x, 199.0F);
      EXPECT_EQ(frame.stamp_ns, kRos2Start + 199 * kRos2Period);
    }
  }
  EXPECT_THAT(message_of<UsageError>(
                  [&] { Ros2BagWriter::open(Ros2Storage::kSqlite, folder_ / "z", "lz4"); }),
              HasSubstr("expected none or zstd"));
}

TEST_F(Ros2Bag, IsNotWrittenWithStampsThatItCannotHold) {
  constexpr std::int64_t kEndNs = (std::int64_t{1} << 31U) * 1'000'000'000;
  for (const auto storage : {Ros2Storage::kMcap, Ros2Storage::kSqlite}) {
    const auto writer = Ros2BagWriter::open(storage, folder_ / "late", "none");
    const auto error_at = [&](std::int64_t stamp_ns) {
      return message_of<DataError>([&] { writer->write("/tf", stamp_ns, kTfMessage, ""); });
    };
    EXPECT_EQ(error_at(kEndNs - 1), "nothing thrown");
    EXPECT_THAT(error_at(kEndNs), HasSubstr("beyond 2^31 s"));
    EXPECT_THAT(error_at(-1), HasSubstr("is negative"));
  }
}

TEST_F(Ros2Bag, IsNotWrittenFromScansThatItWouldGiveBackInAnotherOrder) {
  WriteOptions options;
  options.bag = BagKind::kMcap;
  options.compression = "none";
  options.scans = 3;
  for (const std::int64_t third_ns : {0L, 100L, 101L}) {
    const auto writer = write_as_ros2_bag(folder_ / "order", options);
    Frame frame;
    const auto error_at = [&](std::size_t scan, std::int64_t stamp_ns) {
      frame.stem = std::to_string(scan);
      frame.stamp_ns = stamp_ns;
      return message_of<DataError>([&] { writer->write(scan, frame); });
    };
    ASSERT_EQ(error_at(0, 0), "nothing thrown");
    ASSERT_EQ(error_at(1, 100), "nothing thrown");
    EXPECT_THAT(error_at(2, third_ns),
                third_ns > 100 ? HasSubstr("nothing thrown")
                               : HasSubstr("bag_0.mcap: scan 2 is not later than the one before"));
  }
}

/// A writer's bag with the three scans.
std::string good_db3(const TempFolder& folder, const char* name,
                     const std::string& compression = "none") {
  const auto writer = Ros2BagWriter::open(Ros2Storage::kSqlite, folder / name, compression);
  for (const auto& chunk : good_mcap().chunks) {
    for (const McapEntry& entry : chunk) {
      const bool is_tf = entry.channel == 1;
      writer->write(is_tf ? "/tf" : "/points", entry.recorded_ns, is_tf ? kTfMessage : kPointCloud2,
                    entry.message);
    }
  }
  writer->close();
  return folder / name / "bag_0.db3";
}

TEST_F(Ros2Bag, OfSeveralFilesIsOneSequence) {
  McapBytes first = good_mcap(), second = good_mcap();
  first.chunks.resize(2);
  second.chunks.erase(second.chunks.begin(), second.chunks.begin() + 2);
  folder_.write("drive/drive_0.mcap", first.str());
  folder_.write("drive/drive_1.mcap.zstd", compress_zstd(second.str()));
  const std::string metadata =
      "rosbag2_bagfile_information:\n  version: 5\n  compression_format: zstd\n"
      "  relative_file_paths:\n    - drive_0.mcap\n    - drive/drive_1.mcap\n";
  folder_.write("drive/metadata.yaml", metadata);
  const Dataset dataset = open_dataset(folder_ / "drive", {});
  EXPECT_EQ(dataset.kind, DatasetKind::kRecording);
  EXPECT_THAT(dataset.remarks, Contains(HasSubstr("the folder of a ROS 2 bag")));
  ASSERT_EQ(dataset.sequences.size(), 1U);
  EXPECT_EQ(dataset.sequences[0]->name(), "drive");
  EXPECT_EQ(dataset.sequences[0]->recording().files.size(), 2U);
  expect_good(*dataset.sequences[0]);
  folder_.write("drive/metadata.yaml", metadata + "    - drive_2.mcap\n");
  EXPECT_THAT(message_of<DataError>([&] { open_dataset(folder_ / "drive", {}); }),
              HasSubstr("names drive_2.mcap, which is not there"));
  folder_.write("drive/metadata.yaml", metadata + "    - drive_0.mcap\n");
  EXPECT_THAT(message_of<DataError>([&] { open_dataset(folder_ / "drive", {}); }),
              HasSubstr("names drive_0.mcap twice"));
  folder_.write("drive/metadata.yaml",
                "rosbag2_bagfile_information:\n  compression_format: snappy\n"
                "  relative_file_paths: [drive_0.mcap]\n");
  EXPECT_THAT(message_of<DataError>([&] { open_dataset(folder_ / "drive", {}); }),
              HasSubstr("is of a ROS 2 bag with compression snappy"));
  folder_.write("two/a/metadata.yaml",
                "rosbag2_bagfile_information:\n  relative_file_paths: [\"b.mcap\"]\n");
  folder_.write("two/a/b.mcap", good_mcap().str());
  folder_.write("two/c.mcap", good_mcap().str());
  const Dataset two = open_dataset(folder_ / "two", {});
  ASSERT_EQ(two.sequences.size(), 2U);
  EXPECT_EQ(two.sequences[0]->name(), "c");
  EXPECT_EQ(two.sequences[1]->name(), "a");
  folder_.write("two/a.mcap", good_mcap().str());
  EXPECT_THAT(message_of<DataError>([&] { open_dataset(folder_ / "two", {}); }),
              HasSubstr("holds the bags a.mcap and a, both called a"));
}

TEST_F(Ros2Bag, PackedAsAWholeLeavesNoFileWhereTheProgramIsKilledWhileItUnpacks) {
  const auto whole = write(compress_zstd(good_mcap().str()), "s.mcap.zstd");
  std::filesystem::create_directory(folder_ / "temporary");
  const auto unpack_beyond_the_limit = [&] {
    setenv("TMPDIR", (folder_ / "temporary").c_str(), 1);
    const rlimit limit{.rlim_cur = 1000, .rlim_max = 1000};
    setrlimit(RLIMIT_FSIZE, &limit);
    signal(SIGXFSZ, SIG_DFL);
    BagSequence("s", whole, {});
  };
  EXPECT_EXIT(unpack_beyond_the_limit(), testing::KilledBySignal(SIGXFSZ), "");
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "temporary"));
}

TEST_F(Ros2Bag, InSqliteIsReadWithPackedMessagesAndPackedAsAWhole) {
  expect_good(BagSequence("s", good_db3(folder_, "plain"), {}));
  expect_good(BagSequence("s", good_db3(folder_, "packed", "zstd"), {}));
  const auto whole = write(compress_zstd(read_file(good_db3(folder_, "p"))), "s.db3.zstd");
  expect_good(BagSequence("s", whole, {}));
  write(compress_zstd("no bag"), "s.db3.zstd");
  EXPECT_THAT(message_of<DataError>([&] { BagSequence("s", whole, {}); }),
              HasSubstr("s.db3.zstd: is unpacked to no bag"));
  const std::string mcap = good_mcap().str();
  const auto cut = write(compress_zstd(mcap.substr(0, mcap.size() - 30)), "cut.mcap.zstd");
  EXPECT_THAT(BagSequence("s", cut, {}).recording().doubts,
              Contains(testing::StartsWith("cut.mcap.zstd was not closed by its recorder")));
  write(read_file(good_db3(folder_, "p")).substr(0, 3000), "s.db3");
  EXPECT_THROW(BagSequence("s", folder_ / "s.db3", {}), DataError);
}

void run_sql(const std::filesystem::path& file, const char* statements) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(database, statements, nullptr, nullptr, nullptr), SQLITE_OK)
      << sqlite3_errmsg(database);
  sqlite3_close(database);
}

TEST_F(Ros2Bag, RefusesADamagedDatabase) {
  const auto error_with = [&](const char* statements) {
    const auto file = write(read_file(good_db3(folder_, "good")), "spoilt.db3");
    run_sql(file, statements);
    return message_of<DataError>([&] { BagSequence("s", file, {}).read(0); });
  };
  EXPECT_EQ(error_with("SELECT 1"), "nothing thrown");
  EXPECT_THAT(error_with("DROP TABLE messages"), HasSubstr("has no table messages"));
  EXPECT_THAT(error_with("DROP TABLE topics; CREATE VIEW topics AS SELECT 1 AS id"),
              HasSubstr("has no table topics"));
  EXPECT_THAT(error_with("DELETE FROM topics WHERE name = '/tf'"),
              HasSubstr("of a message is missing"));
  EXPECT_THAT(error_with("ALTER TABLE messages RENAME COLUMN data TO bytes"),
              HasSubstr("cannot be read"));
  EXPECT_THAT(error_with("UPDATE messages SET data = x'00010000'"), HasSubstr("ends early"));
  EXPECT_THAT(error_with("UPDATE topics SET serialization_format = 'ros2idl'"),
              HasSubstr("(sensor_msgs/PointCloud2 as ros2idl)"));
  EXPECT_THAT(error_with("UPDATE messages SET data = x'28B52FFD00'"), HasSubstr("is damaged"));
}

TEST_F(Ros2Bag, NamesTheRowOfADatabaseThatHoldsNoMessage) {
  const auto error_with = [&](const std::string& change) {
    const auto file = write(read_file(good_db3(folder_, "good")), "spoilt.db3");
    // The tables of recorders say NOT NULL; a damaged file need not.
    run_sql(file, ("CREATE TABLE loose AS SELECT topic_id, timestamp, data FROM messages; "
                   "DROP TABLE messages; ALTER TABLE loose RENAME TO messages; UPDATE messages " +
                   change + " WHERE rowid = 3")
                      .c_str());
    return message_of<DataError>([&] { BagSequence("s", file, {}); });
  };
  EXPECT_EQ(error_with("SET topic_id = topic_id"), "nothing thrown");
  EXPECT_THAT(error_with("SET timestamp = NULL"),
              HasSubstr("spoilt.db3: row 3 of messages has null in place of its timestamp, "
                        "expected nanoseconds"));
  EXPECT_THAT(error_with("SET timestamp = 'noon'"),
              HasSubstr("row 3 of messages has text in place of its timestamp"));
  EXPECT_THAT(error_with("SET topic_id = NULL"),
              HasSubstr("row 3 of messages has null in place of its topic_id"));
  for (const std::string type : {"text", "null"}) {
    EXPECT_THAT(error_with(type == "text" ? "SET data = 'scan'" : "SET data = NULL"),
                HasSubstr("row 3 of messages has " + type +
                          " in place of its data, expected the bytes of a message"));
  }
}

TEST_F(Ros2Bag, InSqliteThatItsRecorderDidNotCloseIsReadOnlyWhereItIsWhole) {
  const auto file = write(read_file(good_db3(folder_, "good")), "open.db3");
  sqlite3* recorder = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &recorder), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(recorder,
                         "PRAGMA journal_mode=WAL; DELETE FROM messages WHERE timestamp = "
                         "(SELECT max(timestamp) FROM messages WHERE topic_id = 2)",
                         nullptr, nullptr, nullptr),
            SQLITE_OK);
  const auto killed = write(read_file(file), "killed.db3");
  write(read_file(file.native() + "-wal"), "killed.db3-wal");
  sqlite3_close(recorder);
  const BagSequence recording("s", killed, {});
  EXPECT_EQ(recording.size(), 2U);
  EXPECT_THAT(recording.remarks(), Contains(HasSubstr("its log is read, too")));

  const auto changed = write(read_file(good_db3(folder_, "good")), "changed.db3");
  write(std::string(28, '\0'), "changed.db3-journal");
  expect_good(BagSequence("s", changed, {}));
  write("\xD9\xD5\x05\xF9\x20\xA1\x63\xD7 and pages", "changed.db3-journal");
  EXPECT_THAT(message_of<DataError>([&] { BagSequence("s", changed, {}); }),
              HasSubstr("in the middle of a change, which changed.db3-journal takes back"));
}

TEST_F(Ros2Bag, PackedAfterItsRecorderWroteWithALogIsRead) {
  const auto file = write(read_file(good_db3(folder_, "good")), "logged.db3");
  sqlite3* recorder = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &recorder), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(recorder, "PRAGMA journal_mode=WAL; CREATE TABLE more (id)", nullptr,
                         nullptr, nullptr),
            SQLITE_OK);
  sqlite3_close(recorder);
  const std::string bytes = read_file(file);
  ASSERT_EQ(bytes.substr(18, 2), "\x02\x02");
  expect_good(BagSequence("s", write(compress_zstd(bytes), "logged.db3.zstd"), {}));
}

/// Puts other messages than transforms in the second channel.
McapBytes with_poses(const char* type,
                     const std::function<std::string(std::int64_t, double)>& make) {
  McapBytes bag = good_mcap();
  bag.channels[1] = {"/pose", type};
  for (std::size_t i = 0; i < bag.chunks.size(); ++i) {
    bag.chunks[i][0].message = make(bag.chunks[i][0].recorded_ns, static_cast<double>(i));
  }
  return bag;
}

void put_stamp_and_frame(MessageSink& sink, std::int64_t stamp_ns, std::string_view frame) {
  sink.put(static_cast<std::uint32_t>(stamp_ns / 1'000'000'000));
  sink.put(static_cast<std::uint32_t>(stamp_ns % 1'000'000'000));
  sink.put_text(frame);
}

void put_pose(MessageSink& sink, double x_m) {
  for (const double value : {x_m, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0}) sink.put(value);
}

std::string pose_stamped(std::int64_t stamp_ns, double x_m) {
  MessageSink sink(kCdr);
  put_stamp_and_frame(sink, stamp_ns, "map");
  put_pose(sink, x_m);
  return std::move(sink).bytes();
}

std::string odometry(std::int64_t stamp_ns, double x_m, std::string_view child) {
  MessageSink sink(kCdr);
  put_stamp_and_frame(sink, stamp_ns, "odom");
  sink.put_text(child);
  put_pose(sink, x_m);
  for (int i = 0; i < 36 + 6 + 36; ++i) sink.put(0.0);
  return std::move(sink).bytes();
}

std::string path_until(std::int64_t stamp_ns, double last) {
  MessageSink sink(kCdr);
  put_stamp_and_frame(sink, stamp_ns, "map");
  sink.put(static_cast<std::uint32_t>(last) + 1);
  for (double i = 0; i <= last; ++i) {
    put_stamp_and_frame(sink, kRos2Start + static_cast<std::int64_t>(i) * kRos2Period, "map");
    put_pose(sink, i);
  }
  return std::move(sink).bytes();
}

TEST_F(Ros2Bag, TakesPosesOfPoseStampedPathTransformStampedAndOdometry) {
  expect_good(
      BagSequence("s", write(with_poses("geometry_msgs/msg/PoseStamped", pose_stamped).str()), {}));
  expect_good(BagSequence("s", write(with_poses("nav_msgs/msg/Path", path_until).str()), {}));
  const auto transform = [](std::int64_t stamp_ns, double x_m) {
    MessageSink sink(kCdr);
    put_stamp_and_frame(sink, stamp_ns, "map");
    sink.put_text("lidar");
    put_pose(sink, x_m);
    return std::move(sink).bytes();
  };
  expect_good(BagSequence(
      "s", write(with_poses("geometry_msgs/msg/TransformStamped", transform).str()), {}));
  const auto of_lidar = [](std::int64_t stamp_ns, double x_m) {
    return odometry(stamp_ns, x_m, "lidar");
  };
  const BagSequence recording("s", write(with_poses("nav_msgs/msg/Odometry", of_lidar).str()), {});
  expect_good(recording);
  EXPECT_THAT(recording.remarks(),
              Contains(HasSubstr("poses from the bag: /pose, odom from lidar")));
}

TEST_F(Ros2Bag, TakesHowTheSensorIsMountedToOdometryButNotAsPoses) {
  const auto of_base = [](std::int64_t stamp_ns, double x_m) {
    return odometry(stamp_ns, x_m, "base");
  };
  McapBytes bag = with_poses("nav_msgs/msg/Odometry", of_base);
  EXPECT_THAT(error_of(bag.str()), HasSubstr("no transforms lead from a map to lidar"));
  bag.channels.push_back({"/tf_static", "tf2_msgs/msg/TFMessage"});
  bag.chunks[0].push_back(
      {2, kRos2Start, format_tf_message({{0, "base", "lidar", pose_at_x(10.0)}}, kCdr)});
  const BagSequence recording("s", write(bag.str()), {});
  ASSERT_EQ(recording.size(), 3U);
  EXPECT_EQ(recording.read(2).map_from_sensor.translation().x(), 12.0);
  for (auto& chunk : bag.chunks) chunk[0].channel = 3;
  bag.channels[1].topic = "/unused";
  bag.channels.push_back({"/other", "std_msgs/msg/Empty"});
  EXPECT_THAT(error_of(bag.str()), HasSubstr("no transforms lead from a map to lidar"));
}

TEST_F(Ros2Bag, TakesTheOdometryOfAFrameThatIsAlsoMounted) {
  for (const char* child : {"lidar", ""}) {
    const auto of_child = [child](std::int64_t stamp_ns, double x_m) {
      return odometry(stamp_ns, x_m, child);
    };
    McapBytes bag = with_poses("nav_msgs/msg/Odometry", of_child);
    bag.channels.push_back({"/tf_static", "tf2_msgs/msg/TFMessage"});
    bag.chunks[0].push_back(
        {2, kRos2Start, format_tf_message({{0, "base", "lidar", pose_at_x(10.0)}}, kCdr)});
    expect_good(BagSequence("s", write(bag.str()), {}));
  }
}

TEST_F(Ros2Bag, NamesTheFramesOfOdometryThatDoesNotLeadToTheSensor) {
  const auto of_base = [](std::int64_t stamp_ns, double x_m) {
    return odometry(stamp_ns, x_m, "base");
  };
  EXPECT_THAT(error_of(with_poses("nav_msgs/msg/Odometry", of_base).str()),
              AllOf(HasSubstr("Odometry: base, odom)"), HasSubstr("found by odometry")));
}

TEST_F(Ros2Bag, TakesNoSinglePoseForTheWayOfTheSensor) {
  McapBytes bag = with_poses("nav_msgs/msg/Path", path_until);
  bag.channels.push_back({"/goal_pose", "geometry_msgs/msg/PoseStamped"});
  bag.chunks[0].push_back({2, kRos2Start, pose_stamped(kRos2Start, 99.0)});
  expect_good(BagSequence("s", write(bag.str()), {}));
}

TEST_F(Ros2Bag, AsksWhichOfSeveralTopicsOfPosesIsMeant) {
  McapBytes bag = with_poses("geometry_msgs/msg/PoseStamped", pose_stamped);
  bag.channels.push_back({"/gps", "geometry_msgs/msg/PoseStamped"});
  for (auto& chunk : bag.chunks) {
    chunk.push_back({2, chunk[0].recorded_ns, chunk[0].message});
  }
  EXPECT_THAT(error_of(bag.str()), AllOf(HasSubstr("has poses in the topics /gps, /pose"),
                                         HasSubstr("one of them in pose_topic")));
  const BagSequence recording("s", write(bag.str()), {.pose_topic = "/gps"});
  expect_good(recording);
  EXPECT_THAT(recording.remarks(), Contains(HasSubstr("poses from the bag: /gps")));
  EXPECT_THAT(
      message_of<DataError>([&] { BagSequence("s", write(bag.str()), {.pose_topic = "/imu"}); }),
      HasSubstr("has no topic of poses /imu, expected one of /gps, /pose"));
}

/// A CustomMsg with the points of kRos2Points, 50 ms apart.
std::string livox_message(std::int64_t stamp_ns, MessageEncoding encoding) {
  MessageSink sink(encoding);
  if (encoding == MessageEncoding::kRos1) sink.put(std::uint32_t{0});
  put_stamp_and_frame(sink, stamp_ns, "lidar");
  sink.put(static_cast<std::uint64_t>(stamp_ns));
  sink.put(std::uint32_t{3});
  for (int i = 0; i < 4; ++i) sink.put(std::uint8_t{0});
  sink.put(std::uint32_t{3});
  for (std::uint32_t i = 0; i < 3; ++i) {
    sink.put(i * 50'000'000U);
    for (const float value : {kRos2Points[i].x, kRos2Points[i].y, kRos2Points[i].z})
      sink.put(value);
    sink.put(static_cast<std::uint8_t>(kRos2Points[i].intensity));
    sink.put(std::uint8_t{0x10});
    sink.put(std::uint8_t{2});
  }
  return std::move(sink).bytes();
}

TEST_F(Ros2Bag, ReadsCustomMsgOfLivox) {
  for (const auto encoding : {kCdr, MessageEncoding::kCdrBigEndian, MessageEncoding::kRos1}) {
    const std::string message = livox_message(kRos2Start, encoding);
    const TimedCloud cloud = parse_cloud(message, "f", {kLivoxMessages[0], encoding});
    ASSERT_EQ(cloud.points.size(), 3U);
    EXPECT_EQ(std::memcmp(cloud.points.data(), kRos2Points.data(), sizeof(Point) * 3), 0);
    EXPECT_THAT(cloud.times, ElementsAre(0, 50'000'000, 100'000'000));
    for (std::size_t bytes = 0; bytes + 2 < message.size(); ++bytes) {
      EXPECT_THROW(parse_cloud(message.substr(0, bytes), "f", {kLivoxMessages[0], encoding}),
                   DataError)
          << bytes;
    }
  }
  McapBytes bag = good_mcap();
  for (auto& chunk : bag.chunks) {
    if (chunk.size() > 1) chunk[1].message = livox_message(chunk[1].recorded_ns, kCdr);
  }
  for (const char* package : {"livox_ros_driver", "livox_interfaces", "livox_ros_driver2"}) {
    bag.channels[0].type = package + std::string("/msg/CustomMsg");
    expect_good(BagSequence("s", write(bag.str()), {.deskew = Deskew::kNone}));
  }
  const BagSequence moved("s", write(bag.str()), {});
  EXPECT_FLOAT_EQ(moved.read(0).points[2].x, 6.0F);  // a metre further on after 0.1 s
}

/// The three scans with a time for each point, and poses until two seconds later.
McapBytes with_times(const std::vector<float>& times_s) {
  McapBytes bag = good_mcap();
  for (auto& chunk : bag.chunks) {
    if (chunk.size() < 2) continue;
    CloudHead head = parse_cloud_head(chunk[1].message, "f", {kPointCloud2, kCdr});
    head.fields.back() = {"time", sizeof(Point), 7, 1};
    ByteSink records;
    for (std::size_t i = 0; i < kRos2Points.size(); ++i) {
      records.put(kRos2Points[i]);
      records.put(times_s.at(i));
    }
    chunk[1].message = format_cloud(head, std::move(records).bytes(), kCdr);
  }
  constexpr std::int64_t kLaterNs = kRos2Start + 2'000'000'000;
  bag.chunks.push_back({{1, kLaterNs, tf_at(kLaterNs, pose_at_x(20), kCdr)}});
  return bag;
}

TEST_F(Ros2Bag, LeavesOutAScanWhosePointsWereMeasuredBeforeTheFirstPose) {
  const BagSequence recording("s", write(with_times({-0.05F, -0.02F, 0.0F}).str()), {});
  EXPECT_THAT(recording.recording().doubts, Contains(HasSubstr("1 of 3 scans are left out")));
  ASSERT_EQ(recording.size(), 2U);
  EXPECT_EQ(recording.read(0).stamp_ns, kRos2Start + kRos2Period);
  EXPECT_EQ(recording.read(0).map_from_sensor.translation().x(), 1.0);
  EXPECT_EQ(BagSequence("s", folder_ / "s.mcap", {.deskew = Deskew::kNone}).size(), 3U);
}

TEST_F(Ros2Bag, ReadsScansWithTimesOfNoUnitAsTheyWereMeasured) {
  for (const std::vector<float>& times :
       {std::vector{0.0F, 1500.0F, 3000.0F}, {NAN, NAN, NAN}, {3.0F, 3.0F, 3.0F}}) {
    const BagSequence raw("s", write(with_times(times).str()), {});
    EXPECT_THAT(raw.reading().point_times, HasSubstr("not used"));
    EXPECT_EQ(raw.size(), 3U);
    EXPECT_EQ(std::memcmp(raw.read(1).points.data(), kRos2Points.data(), sizeof(Point) * 3), 0);
  }
}

TEST_F(Ros2Bag, MovesPointsByTimesInEveryUnitAndLeavesThoseThatAreOff) {
  for (const auto& [per_s, unit] : {std::pair{1.0F, PointTimes::kSeconds},
                                    {1e3F, PointTimes::kMilliseconds},
                                    {1e6F, PointTimes::kMicroseconds},
                                    {1e9F, PointTimes::kNanoseconds}}) {
    const auto file = write(with_times({0.0F, 0.05F * per_s, 0.1F * per_s}).str());
    const BagSequence moved("s", file, {});
    EXPECT_NEAR(moved.read(0).points[2].x, kRos2Points[2].x + 1.0F, 1e-5F);
    const BagSequence told("s", file, {.point_times = unit});
    EXPECT_EQ(told.read(0).points[2].x, moved.read(0).points[2].x);
    EXPECT_EQ(told.reading().point_times, moved.reading().point_times);
    const BagSequence spoiled("s", write(with_times({NAN, 0.0F, 0.1F * per_s}).str()), {});
    EXPECT_EQ(spoiled.read(0).points[0].x, kRos2Points[0].x);
    EXPECT_NEAR(spoiled.read(0).points[2].x, kRos2Points[2].x + 1.0F, 1e-5F);
    EXPECT_THAT(spoiled.recording().doubts, Contains(HasSubstr("3 points in 3 scans")));
  }
}

TEST(BagMetadata, NamesFilesInListsOfEitherKind) {
  const auto files = [](const std::string& text) { return parse_bag_metadata(text, "f").files; };
  EXPECT_THAT(files("a:\n  relative_file_paths:\n    - x.db3\n    - 'y z.db3'\r\n  other: - no\n"),
              ElementsAre("x.db3", "y z.db3"));
  EXPECT_THAT(files("relative_file_paths: [x.mcap, \"y.mcap\"]"), ElementsAre("x.mcap", "y.mcap"));
  EXPECT_THROW(files("relative_file_paths: []"), DataError);
  EXPECT_THROW(files(""), DataError);
  const BagMetadata own = parse_bag_metadata(
      format_bag_metadata({"sqlite3", "bag_0.db3", "zstd", 1, 2, {{"/tf", "t", 3}}}), "f");
  EXPECT_THAT(own.files, ElementsAre("bag_0.db3"));
  EXPECT_EQ(own.compression, "zstd");
}

TEST_F(Ros2Bag, KeepsTruthInAField) {
  CloudHead head =
      parse_cloud_head(timed_cloud(kRos2Start, kRos2Points, {}, kCdr), "f", {kPointCloud2, kCdr});
  head.fields.back().name = "label";
  ByteSink records;
  for (const std::uint32_t label : {9U, 251U, (7U << 16U) + 252U}) {
    records.put(kRos2Points[0]);
    records.put(label);
  }
  McapBytes bag = good_mcap();
  bag.chunks[1][1].message =
      format_cloud({kRos2Start + kRos2Period, "lidar", 1, 3, head.fields, false, 20, 60},
                   std::move(records).bytes(), kCdr);
  const BagSequence recording("s", write(bag.str()), {});
  EXPECT_FALSE(recording.has_truth(0));
  ASSERT_TRUE(recording.has_truth(1));
  EXPECT_THAT(*recording.read(1).truth, ElementsAre(9, 251, (7 << 16) + 252));
  EXPECT_EQ(recording.read_truth(1), recording.read(1).truth);
  EXPECT_THROW(recording.read_truth(0), DataError);
}

}  // namespace
}  // namespace mosbench
