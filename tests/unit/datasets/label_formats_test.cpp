#include "datasets/formats/label_formats.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <string>
#include <vector>

#include "datasets/formats/byte_cursor.hpp"
#include "datasets/formats/npy_file.hpp"
#include "datasets/layouts/dataset.hpp"
#include "datasets/text/errors.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

using Labels = std::vector<std::uint32_t>;

std::string npy(const std::string& type, const std::string& shape, const std::string& numbers) {
  const std::string header =
      "{'descr': '" + type + "', 'fortran_order': False, 'shape': (" + shape + "), }\n";
  ByteSink sink;
  sink.put(static_cast<std::uint16_t>(header.size()));
  return "\x93NUMPY\x01" + std::string(1, '\0') + std::move(sink).bytes() + header + numbers;
}

template <typename Number>
std::string three(Number a, Number b, Number c, bool big_endian = false) {
  std::string bytes;
  for (const Number number : {a, b, c}) {
    std::string raw(sizeof(Number), '\0');
    std::memcpy(raw.data(), &number, sizeof(Number));
    bytes += big_endian ? std::string(raw.rbegin(), raw.rend()) : raw;
  }
  return bytes;
}

class LabelFiles : public testing::Test {
 protected:
  Labels read(const std::string& name, const std::string& bytes) {
    folder_.write(name, bytes);
    return read_any_labels(folder_ / name, 3);
  }
  std::string error(const std::string& name, const std::string& bytes) {
    return message_of<DataError>([&] { read(name, bytes); });
  }
  TempFolder folder_;
};

TEST_F(LabelFiles, AreNumpyArraysOfAnyType) {
  const Labels expected = {9, 251, 0};
  EXPECT_EQ(read("a.npy", npy("<u4", "3,", three<std::uint32_t>(9, 251, 0))), expected);
  EXPECT_EQ(read("a.npy", npy("|u1", "3,", three<std::uint8_t>(9, 251, 0))), expected);
  EXPECT_EQ(read("a.npy", npy("<i2", "3, 1", three<std::int16_t>(9, 251, 0))), expected);
  EXPECT_EQ(read("a.npy", npy(">i4", "1, 3", three<std::int32_t>(9, 251, 0, true))), expected);
  EXPECT_EQ(read("a.npy", npy("<i8", "3,", three<std::int64_t>(9, 251, 0))), expected);
  EXPECT_EQ(read("a.npy", npy("<f4", "3,", three(9.0F, 251.0F, 0.0F))), expected);
  EXPECT_EQ(read("a.npy", npy(">f8", "3,", three(9.0, 251.0, 0.0, true))), expected);
  // 251 as a float of 16 bits is 0x5bd8, 9 is 0x4880.
  EXPECT_EQ(read("a.npy", npy("<f2", "3,", three<std::uint16_t>(0x4880, 0x5bd8, 0))), expected);
  EXPECT_EQ(read("a.npy", npy("|b1", "3,", three<std::uint8_t>(0, 1, 0))), (Labels{9, 251, 9}));
}

/// A .npz archive whose directory states a size of its one member, stored as it is.
std::string npz(const std::string& content, std::uint32_t stated_bytes) {
  const auto number = [](std::uint32_t value, std::size_t bytes) {
    return std::string(reinterpret_cast<const char*>(&value), bytes);
  };
  const std::string name = "labels.npy", no_field(2, '\0');
  const std::string sizes = number(static_cast<std::uint32_t>(content.size()), 4) +
                            number(stated_bytes, 4) + number(10, 2) + no_field;
  const std::string start(8, '\0');  // stored; without date and sum
  const std::string file =
      "PK\x03\x04" + std::string(2, '\0') + no_field + start + no_field + sizes + name + content;
  const std::string entry = "PK\x01\x02" + std::string(4, '\0') + no_field + start + no_field +
                            sizes + std::string(14, '\0') + name;
  return file + entry + "PK\x05\x06" + std::string(6, '\0') + number(1, 2) +
         number(static_cast<std::uint32_t>(entry.size()), 4) +
         number(static_cast<std::uint32_t>(file.size()), 4) + no_field;
}

TEST_F(LabelFiles, InArchivesHaveTheSizeThatIsStated) {
  const std::string array = npy("|u1", "3,", three<std::uint8_t>(9, 251, 0));
  const auto bytes = static_cast<std::uint32_t>(array.size());
  EXPECT_EQ(read("a.npz", npz(array, bytes)), (Labels{9, 251, 0}));
  EXPECT_THAT(error("a.npz", npz(array, bytes + 1)),
              AllOf(HasSubstr("a.npz: its member \"labels.npy\" has "),
                    HasSubstr("do not unpack to the " + std::to_string(bytes + 1) +
                              " that the archive states")));
}

TEST_F(LabelFiles, NameTheFirstLabelThatIsNone) {
  EXPECT_THAT(error("a.npy", npy("<f4", "3,", three(9.0F, 250.7F, 0.0F))),
              AllOf(HasSubstr("a.npy: point 1 has the label 250.7"), HasSubstr("a label id")));
  EXPECT_THAT(error("a.npy", npy("<i4", "3,", three(9, -1, 0))), HasSubstr("the label -1"));
  EXPECT_THAT(error("a.npy", npy("<i4", "2,", three(9, 1, 0).substr(4))),
              HasSubstr("has 2 labels, expected one for each of the 3 points"));
  EXPECT_THAT(error("a.npy", npy("<i4", "4,", three(9, 1, 0))),
              HasSubstr("has 12 bytes behind its header, expected 16 of 4 numbers"));
  EXPECT_THAT(error("a.npy", npy("<c8", "3,", std::string(24, '\0'))), HasSubstr("type <c8"));
  EXPECT_THAT(error("a.npy", "\x93NUMPY"), HasSubstr("is no .npy file"));
  EXPECT_THAT(error("a.npz", "PK"), HasSubstr("has no end of a zip archive"));
  EXPECT_THAT(error("a.csv", "x,label\n1,9\n2,9.5\n3,9\n"),
              AllOf(HasSubstr("a.csv:3: label is \"9.5\""), HasSubstr("a label id")));
  EXPECT_THAT(error("b.npy", npy("|u1", "3,", three<std::uint8_t>(0, 1, 0))),
              HasSubstr("b.npy: holds the labels 0 and 1 alone"));
  EXPECT_EQ(read("b.npy", npy("|u1", "3,", three<std::uint8_t>(0, 0, 0))), (Labels{0, 0, 0}));
  EXPECT_THAT(error("a.csv", "x,label\n1,9\n2\n3,9\n"), HasSubstr("a.csv:3: label is not there"));
}

TEST_F(LabelFiles, AreTables) {
  EXPECT_EQ(read("a.csv", "x,label,y\n1,9,0\n1,251.0,0\n1,16777467,0\n"),
            (Labels{9, 251, 0x010000fb}));
  EXPECT_EQ(read("a.csv", "moving\n0\n1\n0\n"), (Labels{9, 251, 9}));
}

constexpr const char* kPly =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
    "property float z\nproperty float scalar_Label\nend_header\n";
constexpr const char* kPcd =
    "FIELDS x y z label\nSIZE 4 4 4 2\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH 3\nHEIGHT 1\nPOINTS 3\n"
    "DATA ascii\n";

TEST_F(LabelFiles, AreLabelledClouds) {
  const std::string rows = "1 2 3 9\n1 2 4 251\n1 2 5 0\n";
  const Labels expected = {9, 251, 0};
  EXPECT_EQ(read("a.ply", kPly + rows), expected);
  EXPECT_EQ(read("a.pcd", kPcd + rows), expected);
  EXPECT_THAT(error("b.ply", kPly + std::string("1 2 3 9\n1 2 4 250.7\n1 2 5 0\n")),
              HasSubstr("b.ply: point 1 has the label 250.7"));
}

/// A folder of scans with labels in some of them, or beside them.
class LabelledSequence : public testing::Test {
 protected:
  void SetUp() override {
    folder_.write("velodyne/1.ply", kPly + std::string("1 2 3 9\n1 2 4 251\n1 2 5 0\n"));
    folder_.write("velodyne/2.ply",
                  "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                  "property float z\nend_header\n1 2 3\n");
    folder_.write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n");
  }
  Dataset opened() const { return open_dataset(folder_.path(), {}); }

  TempFolder folder_;
};

TEST_F(LabelledSequence, HasTheLabelsOfItsScansScanByScan) {
  const Dataset dataset = opened();
  const Sequence& sequence = *dataset.sequences.at(0);
  EXPECT_TRUE(sequence.has_truth(0));
  EXPECT_FALSE(sequence.has_truth(1));
  EXPECT_EQ(sequence.read(0).truth, (Labels{9, 251, 0}));
  EXPECT_FALSE(sequence.read(1).truth);
  EXPECT_THAT(sequence.recording().remarks, Contains(HasSubstr("of 1 of 2 scans")));
}

TEST_F(LabelledSequence, KeepsLabelsWithTheirScansWhereSomeAreLeftOut) {
  folder_.write("velodyne/3.ply", kPly + std::string("1 2 3 9\n1 2 4 0\n1 2 5 251\n"));
  folder_.write("times.txt", "0\n1\n2\n");
  folder_.write("p.tum", "1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0 1\n");
  const Dataset dataset =
      open_dataset(folder_.path(), {.reading = {.poses = PoseFile{folder_ / "p.tum"}}});
  const Sequence& sequence = *dataset.sequences.at(0);
  ASSERT_EQ(sequence.size(), 2U);
  EXPECT_EQ(sequence.stem(0), "2");
  EXPECT_FALSE(sequence.has_truth(0));
  EXPECT_EQ(sequence.read(1).truth, (Labels{9, 0, 251}));
  EXPECT_EQ(sequence.read_truth(1), (Labels{9, 0, 251}));
}

TEST_F(LabelledSequence, TakesLabelsInAnyFormatBesideItsScans) {
  folder_.write("labels/1.csv", "label\n9\n9\n251\n");
  folder_.write("labels/2.npy", npy("|u1", "1,", "\xfb"));
  const Dataset dataset = opened();
  const Sequence& sequence = *dataset.sequences.at(0);
  EXPECT_EQ(sequence.read_truth(0), (Labels{9, 9, 251}));
  EXPECT_EQ(sequence.read_truth(1), Labels{251});
}

TEST_F(LabelledSequence, RefusesALabelledCloudInAnotherOrder) {
  folder_.write("labels/1.pcd", kPcd + std::string("1 2 3 9\n1 2 5 0\n1 2 4 251\n"));
  const Dataset dataset = opened();
  EXPECT_THAT(message_of<DataError>([&] { (void)dataset.sequences.at(0)->read_truth(0); }),
              AllOf(HasSubstr("1.pcd: point 1 is not where it is in the scan"),
                    HasSubstr("the points of 1.ply, in their order and frame")));
}

TEST_F(LabelledSequence, RefusesATableInAnotherOrder) {
  folder_.write("labels/1.csv", "x,y,z,moving\n1,2,4,0\n1,2,3,1\n1,2,5,0\n");
  const Dataset dataset = opened();
  EXPECT_THAT(message_of<DataError>([&] { (void)dataset.sequences.at(0)->read_truth(0); }),
              HasSubstr("1.csv: point 0 is not where it is in the scan"));
  folder_.write("labels/1.csv", "\xEF\xBB\xBFmoving,z,y,x\n0,3,2,1\n1,4,2,1\n0,5,2,1\n");
  EXPECT_EQ(dataset.sequences.at(0)->read_truth(0), (Labels{9, 251, 9}));
}

TEST_F(LabelledSequence, NamesTheFirstCloudOfLabelsThatIsCut) {
  folder_.write("labels/2.pcd", kPcd + std::string("1 2 3 9\n1 2 5 0\n1 2 4 251\n"));
  EXPECT_THAT(message_of<DataError>([&] { opened(); }),
              HasSubstr("2.pcd: has 3 labels, expected one for each of the 1 points"));
}

TEST_F(LabelledSequence, RefusesTwoFilesOfLabelsForAScan) {
  folder_.write("labels/1.csv", "label\n9\n9\n251\n");
  folder_.write("labels/1.npy", npy("|u1", "3,", "\xfb\x09\x09"));
  EXPECT_THAT(message_of<DataError>([&] { opened(); }),
              AllOf(HasSubstr("stands for the same scan"), HasSubstr("1.npy")));
}

}  // namespace
}  // namespace mosbench
