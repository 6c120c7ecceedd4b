#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "datasets/layouts/dataset.hpp"
#include "tests/unit/datasets/drive_bags.hpp"

namespace mosbench {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

class BagParts : public BagPoses {};

INSTANTIATE_TEST_SUITE_P(Of, BagParts,
                         testing::Values(DriveBag::kRos1, DriveBag::kMcap,
                                         DriveBag::kMcapWithoutChunks, DriveBag::kDb3));

TEST_P(BagParts, OfADriveAreOneDrive) {
  const bool is_ros1 = GetParam() == DriveBag::kRos1;
  const std::vector<std::string> names =
      is_ros1 ? std::vector<std::string>{"a_2024-01-01-12-00-00_0", "a_2024-01-01-12-00-30_1",
                                         "a_2024-01-01-12-01-00_2"}
              : std::vector<std::string>{"a_9", "a_10", "a_11"};
  const auto part = [](int from) {
    Drive drive;
    if (from == 0) add_tf(drive, {at(0), "base", "lidar", pose_at_x(10.0)}, "/tf_static");
    for (int k = from; k < from + 4; ++k) {
      add_cloud(drive, at(k));
      add_tf(drive, {at(k), "map", "base", pose_at_x(k)});
    }
    return drive;
  };
  for (int i = 0; i < 3; ++i) {
    const auto file = write(part(4 * i), names[static_cast<std::size_t>(i)]);
    std::filesystem::create_directories(folder_ / "drive");
    std::filesystem::rename(file, folder_ / "drive" / file.filename());
  }
  const Dataset dataset = open_dataset(folder_ / "drive", {});
  ASSERT_EQ(dataset.sequences.size(), 1U);
  EXPECT_EQ(dataset.sequences[0]->name(), "drive");
  EXPECT_EQ(dataset.sequences[0]->size(), 12U);
  EXPECT_EQ(xs_of(*dataset.sequences[0]).back(), 21.0);
  EXPECT_EQ(dataset.sequences[0]->recording().files.size(), 3U);
  EXPECT_THAT(dataset.sequences[0]->remarks(),
              Contains(HasSubstr("3 files are read as one drive")));
}

TEST_P(BagParts, AreNoneWhereTheirTimesAreApart) {
  std::filesystem::create_directories(folder_ / "drives");
  const auto add_part = [&](const std::string& name, double from) {
    Drive drive;
    for (int k = 0; k < 3; ++k) {
      add_cloud(drive, at(from + k));
      add_tf(drive, {at(from + k), "map", "lidar", pose_at_x(k)});
    }
    const auto file = write(drive, name);
    std::filesystem::rename(file, folder_ / "drives" / file.filename());
  };
  add_part("run_0", 0);
  add_part("run_1", 0);
  add_part("run_2", 100);
  add_part("other_3", 103);
  add_part("run_9", 2000);
  const Dataset dataset = open_dataset(folder_ / "drives", {});
  EXPECT_EQ(dataset.sequences.size(), 5U);
  EXPECT_EQ(dataset.sequences[0]->name(), "other_3");
  for (const auto& sequence : dataset.sequences) {
    EXPECT_THAT(sequence->recording().doubts, Not(Contains(HasSubstr("not there"))));
  }
}

TEST_P(BagParts, ThatARecorderDidNotCloseAreSaid) {
  std::filesystem::create_directories(folder_ / "killed");
  for (const int number : {0, 1, 2}) {
    Drive drive;
    for (int k = 4 * number; k < 4 * number + 4; ++k) {
      add_cloud(drive, at(k));
      add_tf(drive, {at(k), "map", "lidar", pose_at_x(k)});
    }
    const auto file = write(drive, "d_" + std::to_string(number));
    const std::string name = file.filename().string() + (number == 2 ? ".active" : "");
    std::filesystem::rename(file, folder_ / "killed" / name);
  }
  const auto doubts = [&] {
    const Dataset dataset = open_dataset(folder_ / "killed", {});
    EXPECT_EQ(dataset.sequences.size(), 1U);
    EXPECT_EQ(dataset.sequences[0]->size(), 8U);
    return dataset.sequences[0]->recording().doubts;
  };
  const auto active = testing::ContainsRegex("d_2.*active was not closed by its recorder");
  EXPECT_THAT(doubts(), Contains(active));
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "killed")) {
    if (entry.path().extension() != ".active") continue;
    std::filesystem::rename(entry.path(), folder_ / "killed/other_2.bag.active");
    break;
  }
  EXPECT_THAT(doubts(), Not(Contains(HasSubstr("not closed")))) << "of another drive";
}

TEST_P(BagParts, ThatAreNotThereAreNamedWithTheTimeThatIsMissing) {
  std::filesystem::create_directories(folder_ / "split");
  for (const int number : {8, 9, 11, 12}) {
    Drive drive;
    for (int k = 50 * (number - 8); k < 50 * (number - 7); ++k) {
      add_cloud(drive, at(k));
      add_tf(drive, {at(k), "map", "lidar", pose_at_x(k)});
    }
    const auto file = write(drive, "a_" + std::to_string(number));
    std::filesystem::rename(file, folder_ / "split" / file.filename());
  }
  const Dataset dataset = open_dataset(folder_ / "split", {});
  ASSERT_EQ(dataset.sequences.size(), 2U);
  EXPECT_EQ(dataset.sequences[0]->name(), "a_8");
  EXPECT_EQ(dataset.sequences[1]->name(), "a_11");
  for (const auto& sequence : dataset.sequences) {
    EXPECT_EQ(sequence->size(), 100U);
    EXPECT_THAT(sequence->recording().doubts,
                Contains(testing::AllOf(HasSubstr("part 10 of a."),
                                        HasSubstr("5.1 s are missing between parts 9 and 11"))));
  }
  // A single part after the hole says so, too; drives that are far apart do not.
  std::filesystem::remove(dataset.sequences[1]->recording().files.back());
  EXPECT_THAT(open_dataset(folder_ / "split", {}).sequences[1]->recording().doubts,
              Contains(HasSubstr("part 10 of a.")));
}

}  // namespace
}  // namespace mosbench
