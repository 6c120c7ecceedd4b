#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "datasets/disk/files.hpp"
#include "datasets/layouts/dataset.hpp"
#include "datasets/text/errors.hpp"
#include "tests/shared_folder.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::Contains;
using testing::HasSubstr;

/// A recording as people have it, and what has to become of it.
struct SharedRecording {
  const char* id;
  const char* poses;  ///< file beside it, or nothing
  const char* map;    ///< frame, or nothing
  std::size_t scans;  ///< 0: an error
  const char* said;   ///< part of a remark, a doubt or the error
};

const std::vector<SharedRecording> kSharedRecordings = {
    {"S02", "S02_poses.txt", "", 12, "are not later than the one before"},
    {"S03", "S03_poses.txt", "", 12, "are not later than the one before"},
    {"X20", "", "", 12, "/odom, /tf, odom from lidar"},
    {"X08", "", "", 11, "holes of more than 0.5 s"},
    {"X01", "", "", 12, ""},
    {"X02", "", "map", 12, ""},
    {"X02", "", "", 0, "has the parents map and odom"},
    {"X03", "", "", 12, "ignored, as tf2 does"},
    {"X04", "", "", 12, "ignored, as tf2 does"},
    {"X13", "", "", 12, "2 transforms of lidar are ignored"},
    {"X21", "", "", 11, "they name no frame"},
    {"X15", "", "", 0, "map from odom is known at"},
    {"X15", "", "odom", 12, ""},
    {"B01", "", "", 12, ""},
    {"B04", "", "", 12, "2 files are read as one drive"},
    {"B05", "", "", 12, "2 files are read as one drive"},
    {"P01", "P01_poses_tum.txt", "", 12, ""},
    {"P02", "P02_poses_tum.txt", "", 11, "80.0 ms after"},
    {"P03", "P03_gt.txt", "", 6, "before or after the poses"},
    {"P04", "P04_gt.txt", "", 12, "the stamp of the row before"}};

TEST(SharedRecordings, GivePosesOrSayWhatIsWrong) {
  const auto inputs = shared_folder() / "recordings/inputs";
  if (!is_there(inputs)) GTEST_SKIP() << inputs << " is not there";
  for (const SharedRecording& recording : kSharedRecordings) {
    SCOPED_TRACE(std::string(recording.id) + " " + recording.map);
    Reading asked;
    if (*recording.poses != '\0') asked.poses = PoseFile{inputs / recording.poses};
    if (*recording.map != '\0') asked.map_frame = recording.map;
    const auto open = [&] { return open_dataset(inputs / recording.id, {.reading = asked}); };
    if (recording.scans == 0) {
      EXPECT_THAT(message_of<DataError>(open), HasSubstr(recording.said));
      continue;
    }
    const Dataset dataset = open();
    ASSERT_EQ(dataset.sequences.size(), 1U);
    const Sequence& sequence = *dataset.sequences.front();
    EXPECT_EQ(sequence.size(), recording.scans);
    std::vector<std::string> said = sequence.remarks();
    const std::vector<std::string>& doubts = sequence.recording().doubts;
    said.insert(said.end(), doubts.begin(), doubts.end());
    EXPECT_THAT(said, Contains(HasSubstr(recording.said)));
    // The drives go 1 m in 1 s from x = -8 m on; X08 goes in a circle.
    if (recording.id == std::string("X08")) continue;
    for (std::size_t k = 0; k < sequence.size(); ++k) {
      const double late_m = recording.id == std::string("P02") ? 0.08 : 0.0;
      const double x_m = -8.0 + 0.1 * std::stod(sequence.stem(k)) - late_m;
      EXPECT_NEAR(sequence.map_from_sensor(k).translation().x(), x_m, 1e-3);
    }
  }
}

}  // namespace
}  // namespace mosbench
