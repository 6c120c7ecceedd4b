#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>

#include "datasets/disk/files.hpp"
#include "datasets/formats/bin_file.hpp"
#include "datasets/formats/kitti_calib.hpp"
#include "datasets/formats/point_range.hpp"
#include "datasets/layouts/dataset.hpp"
#include "datasets/layouts/sequence_writer.hpp"
#include "tests/cli/program.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;

constexpr std::size_t kScans = 12, kWithoutTruth = 5;

/// What KITTI's boxes can say of a point that has a label of another layout, or none.
std::uint32_t label_in_view(const Point& point, const Frame& source, std::size_t place) {
  static const CameraView kView = written_kitti_mounting().view;
  if (!source.truth || !kView.sees(position_of(point))) return 0;
  const std::uint32_t label = (*source.truth)[place];
  if ((label & 0xFFFFU) == 0) return 0;
  return is_moving(label) ? (label & 0xFFFF0000U) + kMovingLabel : kStaticLabel;
}

class KittiDrives : public testing::TestWithParam<const char*> {
 protected:
  KittiDrives() : source_((folder_ / "source").string()), drive_((folder_ / "drive").string()) {
    EXPECT_EQ(cli::run({"simulate", "--layout", "semantickitti", "--scene", "street", "--scans",
                        std::to_string(kScans), "--seed", "3", "--out", source_})
                  .exit_code,
              0);
    std::filesystem::remove(folder_ / "source/sequences/08/labels/000005.label");
    converted_ = cli::run({"convert", source_, "--layout", GetParam(), "--out", drive_});
  }

  /// The packets of the whole drive, one after the other.
  void delay_packets() const {
    if (GetParam() == std::string("kitti-tracking")) {
      const auto file = folder_ / "drive/08/training/oxts/0000.txt";
      const std::string text = read_file(file);
      write_file_atomic(file, text.substr(0, text.find('\n') + 1) + text);
      return;
    }
    const auto packet = [&](std::size_t k) {
      const std::string number = std::to_string(k);
      return folder_ /
             ("drive/date/08/oxts/data/" + std::string(10 - number.size(), '0') + number + ".txt");
    };
    for (std::size_t k = kScans; k > 0; --k) write_file_atomic(packet(k), read_file(packet(k - 1)));
  }

  TempFolder folder_;
  std::string source_, drive_;
  cli::Answer converted_;
};

INSTANTIATE_TEST_SUITE_P(Layouts, KittiDrives, testing::Values("kitti-raw", "kitti-tracking"),
                         [](const auto& layout) {
                           return layout.param == std::string("kitti-raw") ? "raw" : "tracking";
                         });

TEST_P(KittiDrives, KeepTruthInTheCamerasViewAndAllElse) {
  ASSERT_EQ(converted_.exit_code, 0) << converted_.err;
  EXPECT_THAT(converted_.err, HasSubstr("points beyond the view of camera 2 lose their labels"));
  const Dataset source = open_dataset(source_, {}), drive = open_dataset(drive_, {});
  EXPECT_EQ(to_string(drive.kind), GetParam());
  ASSERT_EQ(drive.sequences.at(0)->size(), kScans);
  std::size_t moving = 0, fixed = 0;
  std::set<std::uint32_t> objects;
  for (std::size_t k = 0; k < kScans; ++k) {
    const Frame expected = source.sequences[0]->read(k), frame = drive.sequences[0]->read(k);
    ASSERT_EQ(expected.truth.has_value(), k != kWithoutTruth);
    ASSERT_EQ(frame.truth.has_value(), k != kWithoutTruth);
    ASSERT_EQ(frame.points.size(), expected.points.size());
    if (!frame.truth) continue;
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < frame.points.size(); ++i) {
      const std::uint32_t label = (*frame.truth)[i];
      if (label != label_in_view(expected.points[i], expected, i)) ++wrong;
      moving += (label & 0xFFFFU) == kMovingLabel ? 1 : 0;
      if (label >> 16U != 0) objects.insert(label >> 16U);
      fixed += label == kStaticLabel ? 1 : 0;
    }
    EXPECT_EQ(wrong, 0U) << "scan " << k;
    EXPECT_LT((frame.map_from_sensor.matrix() - expected.map_from_sensor.matrix()).norm(), 1e-9);
    if (GetParam() == std::string("kitti-raw")) {
      EXPECT_EQ(frame.stamp_ns, expected.stamp_ns);
    }
  }
  EXPECT_GT(moving, 1000U);
  EXPECT_GT(objects.size(), 2U);
  EXPECT_GT(fixed, 20000U);
}

TEST_P(KittiDrives, AreGoodToTheDoctorUntilTheirPacketsAreLate) {
  ASSERT_EQ(converted_.exit_code, 0) << converted_.err;
  const cli::Answer good = cli::run({"doctor", drive_});
  EXPECT_EQ(good.exit_code, 0) << good.out << good.err;
  delay_packets();
  const cli::Answer late = cli::run({"doctor", drive_});
  EXPECT_EQ(late.exit_code, 1);
  EXPECT_THAT(late.out + late.err, HasSubstr("the poses fit better as one row later"));
}

TEST_P(KittiDrives, RefuseWhatTheirFilesCannotSay) {
  const auto convert_again = [&] {
    return cli::run(
        {"convert", source_, "--layout", GetParam(), "--out", (folder_ / "far").string()});
  };
  const auto scan = folder_ / "source/sequences/08/velodyne/000003.bin";
  const std::string bytes = read_file(scan);
  Frame frame = open_dataset(source_, {}).sequences[0]->read(3);
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    if (label_in_view(frame.points[i], frame, i) % 65536 != kMovingLabel) continue;
    Point& point = frame.points[i];
    point = {point.x * 2e4F, point.y * 2e4F, point.z * 2e4F, point.intensity};
    break;
  }
  write_file_atomic(scan, std::string(format_bin(frame.points)));
  const cli::Answer far_point = convert_again();
  EXPECT_EQ(far_point.exit_code, 3);
  EXPECT_THAT(far_point.err,
              HasSubstr("scan 000003 has a point to be in a box more than 100 km away"));
  write_file_atomic(scan, bytes);

  const auto poses = folder_ / "source/sequences/08/poses.txt";
  std::string rows;
  for (std::size_t k = 0; k < kScans; ++k) {
    rows += k == 4 ? "1 0 0 0 0 1 0 4e7 0 0 1 0\n" : "1 0 0 0 0 1 0 0 0 0 1 0\n";
  }
  std::filesystem::remove(folder_ / "source/sequences/08/calib.txt");
  write_file_atomic(poses, rows);
  const cli::Answer far_pose = convert_again();
  EXPECT_EQ(far_pose.exit_code, 3);
  EXPECT_THAT(far_pose.err, HasSubstr("poses.txt:5: is 4e+07 m from the first pose"));
}

/// A drive has no labels beyond the view; once written, none are lost any more.
TEST_P(KittiDrives, TellWhatIsBeyondTheViewOnlyWhereThereIsSome) {
  ASSERT_EQ(converted_.exit_code, 0) << converted_.err;
  EXPECT_THAT(converted_.err, testing::ContainsRegex("[1-9][0-9]* points beyond the view"));
  const cli::Answer again =
      cli::run({"convert", drive_, "--layout", GetParam(), "--out", (folder_ / "again").string()});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(again.err, testing::Not(HasSubstr("beyond the view")));
}

TEST_P(KittiDrives, MadeOfLabelsHaveNoSpeedToChoose) {
  ASSERT_EQ(converted_.exit_code, 0) << converted_.err;
  const cli::Answer fast = cli::run(
      {"run", drive_, "--moving-speed-m-s", "1000000", "--out", (folder_ / "fast").string()});
  EXPECT_EQ(fast.exit_code, 2);
  EXPECT_THAT(fast.err, HasSubstr("--read moving_speed_m_s: the boxes of 0"));
  EXPECT_THAT(fast.err, HasSubstr("were made of labels"));
  const Dataset drive = open_dataset(drive_, {});
  EXPECT_THAT(drive.sequences.at(0)->reading().truth, HasSubstr("made of labels"));
}

}  // namespace
}  // namespace mosbench
