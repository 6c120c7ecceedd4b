#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <string>

#include "datasets/layouts/convert.hpp"
#include "datasets/rosbag/bag_sequence.hpp"
#include "tests/shared_folder.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

struct Ros2Case {
  const char* bag;
  BagKind kind;
  const char* compression;
};

class RealRos2Bag : public testing::TestWithParam<Ros2Case> {};

/// Points and stamps are the same bits. Poses are written as quaternions, which turn back into
/// matrices with other last bits.
TEST_P(RealRos2Bag, GivesThePointsOfTheRos1BagBitForBitAndItsPosesToRounding) {
  const auto bag = shared_folder() / "real/rosbag" / GetParam().bag;
  if (!std::filesystem::exists(bag)) GTEST_SKIP() << bag << " is not there";
  const OpenOptions raw{.reading = {.deskew = Deskew::kNone}};
  const Dataset dataset = open_dataset(bag, raw);
  const Sequence& expected = *dataset.sequences.at(0);
  ASSERT_GE(expected.size(), 3U);
  const TempFolder folder;
  convert(dataset, {.layout = DatasetKind::kRecording,
                    .writing = {.bag = GetParam().kind, .compression = GetParam().compression},
                    .out = folder / "ros2"});
  const Dataset converted = open_dataset(folder / "ros2", raw);
  ASSERT_EQ(converted.sequences.size(), 1U);
  const Sequence& recording = *converted.sequences[0];
  ASSERT_EQ(recording.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const Frame before = expected.read(i), after = recording.read(i);
    EXPECT_EQ(after.stamp_ns, before.stamp_ns);
    ASSERT_EQ(after.points.size(), before.points.size());
    ASSERT_GT(after.points.size(), 100'000U);
    EXPECT_EQ(std::memcmp(after.points.data(), before.points.data(),
                          before.points.size() * sizeof(Point)),
              0);
    EXPECT_LE(
        (after.map_from_sensor.matrix() - before.map_from_sensor.matrix()).cwiseAbs().maxCoeff(),
        1e-12);
  }
}

INSTANTIATE_TEST_SUITE_P(Bags, RealRos2Bag,
                         testing::Values(Ros2Case{"xyzi_none.bag", BagKind::kMcap, "none"},
                                         Ros2Case{"ouster48_lz4.bag", BagKind::kMcap, "lz4"},
                                         Ros2Case{"ouster48_bz2.bag", BagKind::kMcap, "zstd"},
                                         Ros2Case{"ouster48_lz4.bag", BagKind::kDb3, "none"},
                                         Ros2Case{"xyzi_none.bag", BagKind::kDb3, "zstd"}),
                         [](const auto& tested) {
                           const Ros2Case& of = tested.param;
                           return std::string(of.bag).substr(0, 4) +
                                  std::string(to_string(of.kind)) + of.compression;
                         });

}  // namespace
}  // namespace mosbench
