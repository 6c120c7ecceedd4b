#include "datasets/sequence/scan_range.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "datasets/formats/bin_file.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/formats/times_file.hpp"
#include "datasets/layouts/dataset.hpp"
#include "datasets/sequence/fingerprint.hpp"
#include "datasets/text/errors.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;

TEST(ScanRange, HoldsWhatPythonsRangeHolds) {
  std::mt19937 random(11);
  std::size_t scans_held = 0;
  for (int round = 0; round < 2000; ++round) {
    const std::size_t from = random() % 12, to = from + 1 + random() % 12, step = 1 + random() % 5;
    const bool has_from = random() % 4 != 0, has_to = random() % 4 != 0, has_step = random() % 2;
    std::string text = (has_from ? std::to_string(from) : "") + ':';
    if (has_to) text += std::to_string(to);
    if (has_step) text += ':' + std::to_string(step);
    const ScanRange range = parse_scan_range(text);
    const ScanRange again = parse_scan_range(to_string(range));
    constexpr std::size_t kScans = 30;
    std::vector<bool> expected(kScans, false);
    for (std::size_t k = has_from ? from : 0; k < (has_to ? to : kScans);
         k += has_step ? step : 1) {
      expected[k] = true;
    }
    for (std::size_t k = 0; k < kScans; ++k) {
      EXPECT_EQ(range.holds(k), expected[k]) << text << " of " << k;
      EXPECT_EQ(again.holds(k), expected[k]) << to_string(range) << " of " << k;
      scans_held += expected[k];
    }
  }
  EXPECT_GT(scans_held, 2000U);
}

TEST(ScanRange, HasOneTextForEqualRanges) {
  for (const auto& [text, expected] : {std::pair("5", ":5"),
                                       {"0:5:1", ":5"},
                                       {":", ":"},
                                       {"::", ":"},
                                       {"10:", "10:"},
                                       {"10::1", "10:"},
                                       {"::2", "::2"},
                                       {"10:60:5", "10:60:5"}}) {
    EXPECT_EQ(to_string(parse_scan_range(text)), expected) << text;
  }
}

TEST(ScanRange, RefusesWhatIsNoneOrHoldsNothing) {
  for (const char* text : {"", "a", "1:b", "-3:", ":-1", "1:2:3:4", "1.5:", " 1:", "1,2"}) {
    EXPECT_THAT(message_of<UsageError>([&] { parse_scan_range(text); }),
                AllOf(HasSubstr("is no range of scans"), HasSubstr("FROM:TO:STEP")))
        << text;
  }
  for (const char* text : {"0", ":0", "5:5", "7:3"}) {
    EXPECT_THAT(message_of<UsageError>([&] { parse_scan_range(text); }),
                HasSubstr("a TO above FROM"))
        << text;
  }
  EXPECT_THAT(message_of<UsageError>([] { parse_scan_range("::0"); }), HasSubstr("a STEP of 1"));
}

/// Ten scans of one point each at x = the scan's number, with poses there, truth of scans 0, 4, 8,
/// and stamps.
class ScanRangeOf : public testing::Test {
 protected:
  ScanRangeOf() {
    std::string poses;
    std::vector<std::int64_t> stamps_ns;
    for (std::size_t k = 0; k < 10; ++k) {
      const std::string stem = "00000" + std::to_string(k);
      const auto x = static_cast<float>(k);
      write_bin(folder_ / "s/velodyne" / (stem + ".bin"), std::vector<Point>{{x, 1, 0, 0}});
      if (k % 4 == 0) {
        const auto id = static_cast<std::uint32_t>(100 + k);
        write_labels(folder_ / "s/labels" / (stem + ".label"), std::vector<std::uint32_t>{id});
      }
      poses += "1 0 0 " + std::to_string(k) + " 0 1 0 0 0 0 1 0\n";
      stamps_ns.push_back(static_cast<std::int64_t>(k) * 100'000'000);
    }
    folder_.write("s/poses.txt", poses);
    write_times(folder_ / "s/times.txt", stamps_ns);
  }
  Dataset open(const char* range, Reading reading = {}) const {
    reading.scans = parse_scan_range(range);
    return open_dataset(folder_ / "s", {.reading = reading});
  }

  TempFolder folder_;
};

std::vector<std::string> stems_of(const Sequence& sequence) {
  std::vector<std::string> stems;
  for (const ScanEntry& scan : sequence.recording().scans) stems.push_back(scan.stem);
  return stems;
}

TEST_F(ScanRangeOf, ASequenceWithoutEmptyAndRepeatedScansCountsAllOfThem) {
  write_bin(folder_ / "s/velodyne/000005.bin", std::vector<Point>{{2, 1, 0, 0}});
  write_bin(folder_ / "s/velodyne/000006.bin", std::vector<Point>{});
  const Dataset left = open_dataset(folder_ / "s", {.reading = {.drop_scans = Drop::kAuto}});
  const Sequence& sequence = *left.sequences.at(0);
  ASSERT_THAT(stems_of(sequence), ElementsAre("000000", "000001", "000002", "000003", "000004",
                                              "000007", "000008", "000009"));
  EXPECT_EQ(sequence.read(5).points.at(0).x, 7.0F);
  EXPECT_EQ(sequence.read_truth(6).at(0), 108U);
  EXPECT_TRUE(is_left_out(sequence.recording(), "000006"));
  EXPECT_THAT(members_of(sequence.reading()), Contains(Pair("drop_scans", "1 empty, 1 repeated")));
  EXPECT_THAT(sequence.remarks(), Contains("scans left out: 1 empty, 1 repeated"));
  EXPECT_THAT(stems_of(*open("4:9", {.drop_scans = Drop::kAuto}).sequences.at(0)),
              ElementsAre("000004", "000007", "000008"));
}

TEST_F(ScanRangeOf, ASequenceKeepsPosesTruthAndNamesWithTheirScans) {
  const Dataset dataset = open("1:9:3");
  const Sequence& sequence = *dataset.sequences.at(0);
  ASSERT_THAT(stems_of(sequence), ElementsAre("000001", "000004", "000007"));
  for (std::size_t k = 0; k < 3; ++k) {
    const Frame frame = sequence.read(k);
    EXPECT_EQ(frame.stem, sequence.stem(k));
    EXPECT_EQ(frame.points.at(0).x, static_cast<float>(1 + 3 * k));
    EXPECT_EQ(frame.map_from_sensor.translation().x(), static_cast<double>(1 + 3 * k));
    EXPECT_EQ(sequence.map_from_sensor(k).matrix(), frame.map_from_sensor.matrix());
  }
  EXPECT_THAT(scans_with_truth(sequence), ElementsAre(1));
  EXPECT_THAT(sequence.read_truth(1), ElementsAre(104));
  EXPECT_THAT(members_of(sequence.reading()), Contains(Pair("scans", "1:9:3, 3 of 10 scans")));
  EXPECT_THAT(sequence.recording().doubts,
              Contains("only a part of the sequence is read: 1:9:3, 3 of 10 scans"));
}

TEST_F(ScanRangeOf, ASequenceIsAnotherInputThanTheWhole) {
  const auto fingerprints = [&](const Dataset& dataset) {
    const Sequence& sequence = *dataset.sequences.at(0);
    ContentFingerprint content;
    for (std::size_t k = 0; k < sequence.size(); ++k) content.add(sequence.read(k));
    return std::pair(content.hex(), file_stamp(sequence));
  };
  const auto whole = fingerprints(open_dataset(folder_ / "s", {}));
  const auto part = fingerprints(open(":5"));
  EXPECT_NE(part.first, whole.first);
  EXPECT_NE(part.second, whole.second);
  EXPECT_EQ(fingerprints(open("0:5")), part);
}

TEST_F(ScanRangeOf, AStampedPoseFileNeedsPosesOfTheseScansAlone) {
  folder_.write("part.tum", "0.5 5 0 0 0 0 0 1\n0.6 6 0 0 0 0 0 1\n0.7 7 0 0 0 0 0 1\n");
  const Reading reading = {.poses = PoseFile{folder_ / "part.tum"}};
  const Dataset dataset = open("5:8", reading);
  const Sequence& sequence = *dataset.sequences.at(0);
  ASSERT_THAT(stems_of(sequence), ElementsAre("000005", "000006", "000007"));
  EXPECT_EQ(sequence.map_from_sensor(2).translation().x(), 7.0);
  EXPECT_THAT(sequence.recording().left_out, IsEmpty());
  EXPECT_THAT(sequence.recording().doubts, ElementsAre(HasSubstr("only a part")));
  // Numbers are those of the scans on disk, also where some have no pose.
  const Dataset more = open("4:7", reading);
  EXPECT_THAT(stems_of(*more.sequences.at(0)), ElementsAre("000005", "000006"));
  EXPECT_EQ(more.sequences.at(0)->recording().left_out.size(), 1U);
  EXPECT_THAT(more.sequences.at(0)->recording().doubts,
              Contains(HasSubstr("1 of 3 scans are left out")));
}

TEST_F(ScanRangeOf, ASequenceIsWholeWhereAllScansAreAskedFor) {
  for (const char* range : {":", "0:", ":10", "0:99"}) {
    const Dataset all = open(range);
    EXPECT_EQ(all.sequences.at(0)->size(), 10U) << range;
    EXPECT_EQ(all.sequences.at(0)->reading().scans, "") << range;
    EXPECT_THAT(all.sequences.at(0)->recording().doubts, testing::IsEmpty()) << range;
  }
}

TEST_F(ScanRangeOf, ASequenceRefusesToBeEmpty) {
  EXPECT_THAT(message_of<UsageError>([&] { open("10:"); }),
              HasSubstr("scans 10: chooses no scan of sequence s, which has 10 scans, "
                        "expected some of 0 to 9"));
}

}  // namespace
}  // namespace mosbench
