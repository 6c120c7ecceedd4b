#include "datasets/doctor/doctor.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "datasets/disk/files.hpp"
#include "datasets/formats/bin_file.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/formats/times_file.hpp"
#include "datasets/sequence/simulated_origin.hpp"
#include "datasets/simulator/simulate.hpp"
#include "tests/sanitizers.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr std::size_t kScansExamined = 40;

struct Layout {
  DatasetKind kind;
  const char* scene;
};

/// Simulated once per layout; tests that spoil it take a copy.
fs::path good_copy(const Layout& layout) {
  static std::map<std::pair<DatasetKind, std::string>, std::unique_ptr<TempFolder>> folders;
  auto& folder = folders[{layout.kind, layout.scene}];
  if (!folder) {
    folder = std::make_unique<TempFolder>();
    simulate({.layout = layout.kind,
              .scene = layout.scene,
              .scans = kScansExamined,
              .seed = 3,
              .out = *folder / "data",
              .threads = 2});
  }
  return *folder / "data";
}

std::string all_symptoms(const Checkup& checkup) {
  std::string text;
  for (const Symptom& symptom : checkup.symptoms)
    text += symptom.where + ": " + symptom.what + "\n";
  return text;
}

class DoctorOnWhatIsGood : public testing::TestWithParam<Layout> {};

TEST_P(DoctorOnWhatIsGood, IsQuiet) {
  if (kSanitized && GetParam().kind == DatasetKind::kHelimos) {
    GTEST_SKIP() << "takes minutes in sanitized builds";
  }
  const fs::path root = good_copy(GetParam());
  const Checkup checkup = check_up(root, {});
  EXPECT_EQ(all_symptoms(checkup), "");
  EXPECT_EQ(checkup.kind, GetParam().kind);
  ASSERT_FALSE(checkup.sequences.empty());
  for (const SequenceCheckup& sequence : checkup.sequences) {
    EXPECT_EQ(sequence.scans, kScansExamined);
    EXPECT_TRUE(sequence.poses) << sequence.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Layouts, DoctorOnWhatIsGood,
                         testing::Values(Layout{DatasetKind::kDoals, "mall"},
                                         Layout{DatasetKind::kSipailou, "campus"},
                                         Layout{DatasetKind::kHelimos, "street"},
                                         Layout{DatasetKind::kSemanticKitti, "street"},
                                         Layout{DatasetKind::kSemanticKitti, "highway"},
                                         Layout{DatasetKind::kHelimos, "campus"},
                                         Layout{DatasetKind::kHelimos, "highway"}),
                         [](const auto& layout) {
                           return std::string(to_string(layout.param.kind)) + "_" +
                                  layout.param.scene;
                         });

/// A fault and words of the symptom that has to name it.
struct Fault {
  const char* name;
  Layout layout;
  std::function<void(const fs::path& root)> plant;
  const char* symptom;
  Severity severity = Severity::kWarning;
};

void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.name; }

constexpr Layout kKitti = {DatasetKind::kSemanticKitti, "street"};
constexpr Layout kHighway = {DatasetKind::kSemanticKitti, "highway"};
constexpr Layout kRoom = {DatasetKind::kSipailou, "room"};
constexpr Layout kCampus = {DatasetKind::kSipailou, "campus"};
constexpr Layout kSensors = {DatasetKind::kHelimos, "street"};
const fs::path kKittiSequence = "sequences/08";
const fs::path kCampusSequence = "sequences/06";

void change_poses(const fs::path& file, const std::function<void(std::vector<Pose>&)>& change) {
  auto poses = read_poses(file);
  ASSERT_EQ(poses.size(), kScansExamined);
  change(poses);
  write_poses(file, poses);
}

void invert_poses(const fs::path& root) {
  change_poses(root / kKittiSequence / "poses.txt", [](std::vector<Pose>& poses) {
    for (Pose& pose : poses) pose = pose.inverse();
  });
}

void delay_poses_by_one_scan(const fs::path& root) {
  change_poses(root / kKittiSequence / "poses.txt", [](std::vector<Pose>& poses) {
    poses.insert(poses.begin(), poses.front());
    poses.pop_back();
  });
}

/// Changes the poses of the lidar, which are stored as the camera's.
void change_lidar_poses(const fs::path& root,
                        const std::function<void(std::size_t row, Pose& pose)>& change) {
  const Pose tr = read_calib(root / kKittiSequence / "calib.txt");
  change_poses(root / kKittiSequence / "poses.txt", [&](std::vector<Pose>& poses) {
    for (std::size_t row = 0; row < poses.size(); ++row) {
      Pose pose = lidar_pose(poses[row], tr);
      change(row, pose);
      poses[row] = tr * pose * tr.inverse();
    }
  });
}

void exchange_rows(const fs::path& sequence, std::size_t a, std::size_t b) {
  change_poses(sequence / "poses.txt",
               [=](std::vector<Pose>& poses) { std::swap(poses.at(a), poses.at(b)); });
}

void change_points(const fs::path& folder, const std::function<void(Point&)>& change) {
  for (const auto& entry : fs::directory_iterator(folder)) {
    auto points = read_bin(entry.path());
    for (Point& point : points) change(point);
    write_bin(entry.path(), points);
  }
}

void change_labels(const fs::path& sequence,
                   const std::function<std::uint32_t(std::uint32_t, const Point&)>& change) {
  for (const auto& entry : fs::directory_iterator(sequence / "labels")) {
    const auto points = read_bin(sequence / "velodyne" / (entry.path().stem().string() + ".bin"));
    auto labels = read_labels(entry.path(), points.size());
    for (std::size_t i = 0; i < points.size(); ++i) labels[i] = change(labels[i], points[i]);
    write_labels(entry.path(), labels);
  }
}

const std::vector<Fault>& faults() {
  static const std::vector<Fault> all = {
      {"camera_poses_without_tr", kKitti,
       [](const fs::path& root) {
         write_file_atomic(root / kKittiSequence / "calib.txt", format_calib(Pose::Identity()));
       },
       "the poses fit better as the camera's, Tr is missing"},
      {"inverse_poses", kKitti, invert_poses, "the poses fit better as sensor_from_map (inverse)"},
      {"transposed_rotations", kKitti,
       [](const fs::path& root) {
         change_poses(root / kKittiSequence / "poses.txt", [](std::vector<Pose>& poses) {
           for (Pose& pose : poses) pose.linear().transposeInPlace();
         });
       },
       "the poses fit better with transposed rotations"},
      {"poses_shifted_by_one_scan", kKitti, delay_poses_by_one_scan,
       "the poses fit better as one row later"},
      {"poses_shifted_by_one_scan_the_other_way", kKitti,
       [](const fs::path& root) {
         change_poses(root / kKittiSequence / "poses.txt", [](std::vector<Pose>& poses) {
           poses.erase(poses.begin());
           poses.push_back(poses.back());
         });
       },
       "the poses fit better as one row earlier"},
      {"poses_shifted_by_one_scan_on_a_straight_road", kHighway, delay_poses_by_one_scan,
       "the poses fit better as one row later:"},
      {"inverse_poses_on_a_straight_road", kHighway, invert_poses,
       "the poses fit better as sensor_from_map (inverse):"},
      {"rows_of_neighbours_exchanged", kKitti,
       [](const fs::path& root) { exchange_rows(root / kKittiSequence, 17, 18); },
       "the poses of scans 000017 and 000018 (rows 18 and 19) are exchanged"},
      {"rows_far_apart_exchanged", kKitti,
       [](const fs::path& root) { exchange_rows(root / kKittiSequence, 5, 31); },
       "the poses of scans 000005 and 000031 (rows 6 and 32) are exchanged"},
      {"first_two_rows_exchanged", kKitti,
       [](const fs::path& root) { exchange_rows(root / kKittiSequence, 0, 1); },
       "the poses of scans 000000 and 000001 (rows 1 and 2) are exchanged"},
      {"rows_exchanged_on_a_straight_road", kHighway,
       [](const fs::path& root) { exchange_rows(root / kKittiSequence, 20, 22); },
       "the poses of scans 000020 and 000022 (rows 21 and 23) are exchanged"},
      {"rows_exchanged_at_a_slow_walk", kRoom,
       [](const fs::path& root) { exchange_rows(root / kCampusSequence, 9, 10); },
       "(rows 10 and 11) are exchanged"},
      {"one_row_off_the_way", kKitti,
       [](const fs::path& root) {
         change_poses(root / kKittiSequence / "poses.txt",
                      [](std::vector<Pose>& poses) { poses[12].translation().z() += 3.0; });
       },
       "the pose of scan 000012 (row 13) does not fit between its neighbours"},
      {"poses_of_another_sequence", kKitti,
       [](const fs::path& root) {
         change_poses(root / kKittiSequence / "poses.txt", [](std::vector<Pose>& poses) {
           for (std::size_t i = 0; i < poses.size(); ++i) {
             const double angle = 0.05 * static_cast<double>(i);
             poses[i] = Pose::Identity();
             poses[i].rotate(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()));
             poses[i].translation() = Eigen::Vector3d(20.0 * std::sin(angle), 0, angle);
           }
         });
       },
       "the poses do not fit the scans in any convention"},
      {"all_poses_equal", kKitti,
       [](const fs::path& root) {
         change_lidar_poses(root, [](std::size_t, Pose& pose) { pose = Pose::Identity(); });
       },
       "all poses are equal, but the scans show that the sensor moves"},
      {"frozen_rows", kKitti,
       [](const fs::path& root) {
         change_poses(root / kKittiSequence / "poses.txt", [](std::vector<Pose>& poses) {
           for (std::size_t i = 21; i < 27; ++i) poses[i] = poses[20];
         });
       },
       "the poses are frozen: rows 21 to 27"},
      {"sensor_turned", kKitti,
       [](const fs::path& root) {
         change_lidar_poses(root, [](std::size_t, Pose& pose) {
           pose.rotate(Eigen::AngleAxisd(0.0873, Eigen::Vector3d::UnitZ()));
         });
       },
       "mounted with 5.0 degrees yaw:"},
      {"poses_too_long", kKitti,
       [](const fs::path& root) {
         change_lidar_poses(root, [](std::size_t, Pose& pose) { pose.translation() *= 1.1; });
       },
       "times as long:"},
      {"noisy_poses", kKitti,
       [](const fs::path& root) {
         std::mt19937 random(3);
         std::normal_distribution<double> noise_m(0.0, 0.1);
         change_lidar_poses(root, [&](std::size_t, Pose& pose) {
           pose.translation() += Eigen::Vector3d(noise_m(random), noise_m(random), noise_m(random));
         });
       },
       "the poses scatter by"},
      {"poses_that_jump", kKitti,
       [](const fs::path& root) {
         change_lidar_poses(root, [](std::size_t row, Pose& pose) {
           if (row >= 20) pose.translation() += Eigen::Vector3d(3.0, 0.0, 0.0);
         });
       },
       "between scans 000019 and 000020 the poses move by"},
      {"poses_three_rows_late", kKitti,
       [](const fs::path& root) {
         change_poses(root / kKittiSequence / "poses.txt", [](std::vector<Pose>& poses) {
           poses.insert(poses.begin(), 3, poses.front());
           poses.resize(kScansExamined);
         });
       },
       "the poses fit better as 3 rows later:"},
      {"shuffled_labels", kKitti,
       [](const fs::path& root) {
         std::mt19937 random(3);
         std::vector<std::uint32_t> before;
         change_labels(root / kKittiSequence, [&](std::uint32_t label, const Point&) {
           before.push_back(label);
           return before[random() % before.size()];
         });
       },
       "the labels do not fit the scans"},
      {"exchanged_labels", kKitti,
       [](const fs::path& root) {
         change_labels(root / kKittiSequence, [](std::uint32_t label, const Point&) {
           return (label & 0xFFFFU) > 250U ? 40U : 252U;
         });
       },
       "are static and moving exchanged?"},
      {"stamps_of_another_clock", kKitti,
       [](const fs::path& root) {
         auto stamps_ns = read_times(root / kKittiSequence / "times.txt");
         for (auto& stamp_ns : stamps_ns) stamp_ns /= 1000;
         write_times(root / kKittiSequence / "times.txt", stamps_ns);
       },
       "stamps are 0.0001 s apart (median); expected seconds"},
      {"a_gap_in_time", kKitti,
       [](const fs::path& root) {
         auto stamps_ns = read_times(root / kKittiSequence / "times.txt");
         for (std::size_t i = 20; i < stamps_ns.size(); ++i) stamps_ns[i] += 5'000'000'000;
         write_times(root / kKittiSequence / "times.txt", stamps_ns);
       },
       "scan 000020 comes 5.10 s after the one before it"},
      {"points_upside_down", kKitti,
       [](const fs::path& root) {
         change_points(root / kKittiSequence / "velodyne", [](Point& point) { point.z *= -1.0F; });
       },
       "upside down"},
      {"zeroed_points", kKitti,
       [](const fs::path& root) {
         std::mt19937 random(3);
         change_points(root / kKittiSequence / "velodyne", [&](Point& point) {
           if (random() % 10 < 3) point = {0.0F, 0.0F, 0.0F, point.intensity};
         });
       },
       "of the points between two returns are (0, 0, 0)"},
      {"one_scan_missing", kKitti,
       [](const fs::path& root) { fs::remove(root / kKittiSequence / "velodyne/000017.bin"); },
       "000017", Severity::kError},
      {"one_label_missing", kKitti,
       [](const fs::path& root) { fs::remove(root / kKittiSequence / "labels/000017.label"); },
       "1 of 40 scans have no label: 000017"},
      {"truncated_scan", kKitti,
       [](const fs::path& root) {
         const fs::path scan = root / kKittiSequence / "velodyne/000017.bin";
         fs::resize_file(scan, fs::file_size(scan) / 32 * 16);
       },
       "1 scan is far smaller than those around them: 000017", Severity::kError},
      {"labels_of_raw_classes", kCampus,
       [](const fs::path& root) {
         change_labels(root / kCampusSequence,
                       [](std::uint32_t label, const Point&) { return label == 9 ? 40U : label; });
       },
       "the labels hold the ids 40"},
      {"labels_of_a_network", kKitti,
       [](const fs::path& root) {
         change_labels(root / kKittiSequence, [](std::uint32_t label, const Point&) {
           return (label & 0xFFFFU) > 250U ? 2U : 1U;
         });
       },
       "as the classes of a network"},
      {"points_in_millimetres", kKitti,
       [](const fs::path& root) {
         change_points(root / kKittiSequence / "velodyne", [](Point& point) {
           point = {1e3F * point.x, 1e3F * point.y, 1e3F * point.z, point.intensity};
         });
       },
       "are these millimetres"},
      {"x_and_y_swapped", kKitti,
       [](const fs::path& root) {
         change_points(root / kKittiSequence / "velodyne",
                       [](Point& point) { std::swap(point.x, point.y); });
       },
       "with x and y of the points swapped"},
      {"frozen_scan", kKitti,
       [](const fs::path& root) {
         const fs::path scans = root / kKittiSequence / "velodyne";
         const fs::path labels = root / kKittiSequence / "labels";
         fs::copy_file(scans / "000016.bin", scans / "000017.bin",
                       fs::copy_options::overwrite_existing);
         fs::copy_file(labels / "000016.label", labels / "000017.label",
                       fs::copy_options::overwrite_existing);
       },
       "scans hold the same points: 000017 as 000016"},
      {"stamps_out_of_order", kKitti,
       [](const fs::path& root) {
         auto stamps_ns = read_times(root / kKittiSequence / "times.txt");
         std::swap(stamps_ns.at(20), stamps_ns.at(21));
         write_times(root / kKittiSequence / "times.txt", stamps_ns);
       },
       "1 stamps are not later than the one before, first that of scan 000021"},
      {"split_naming_absent_scans", kSensors,
       [](const fs::path& root) {
         const fs::path split = root / "KAIST05/Deskewed_LiDAR/test.txt";
         write_file_atomic(split, read_file(split) + "4711\n");
       },
       "names frame 4711", Severity::kError},
      {"labels_beyond_the_range", kCampus,
       [](const fs::path& root) {
         change_labels(root / kCampusSequence, [](std::uint32_t label, const Point& point) {
           return std::hypot(point.x, point.y, point.z) > 60.0F ? 9U : label;
         });
       },
       "labelled points lie outside of 3 to 50 m"},
      {"nan_points", kKitti,
       [](const fs::path& root) {
         change_points(root / kKittiSequence / "velodyne", [](Point& point) {
           if (point.x > 30.0F) point.x = std::numeric_limits<float>::quiet_NaN();
         });
       },
       "are NaN or infinite"},
      {"reversed_bytes", kKitti,
       [](const fs::path& root) {
         const auto reversed = [](float value) {
           return std::bit_cast<float>(__builtin_bswap32(std::bit_cast<std::uint32_t>(value)));
         };
         change_points(root / kKittiSequence / "velodyne", [&](Point& point) {
           point = {reversed(point.x), reversed(point.y), reversed(point.z),
                    reversed(point.intensity)};
         });
       },
       "expected little-endian float32", Severity::kError},
      {"radians_for_degrees", kSensors,
       [](const fs::path& root) {
         change_poses(
             root / "KAIST05/Deskewed_LiDAR/Ouster/poses.txt", [](std::vector<Pose>& poses) {
               for (Pose& pose : poses) {
                 const Eigen::AngleAxisd turn(pose.linear());
                 pose.linear() =
                     Eigen::AngleAxisd(turn.angle() * M_PI / 180.0, turn.axis()).toRotationMatrix();
               }
             });
       },
       "in radians that were taken for degrees"},
      {"four_frozen_rows", kCampus,
       [](const fs::path& root) {
         change_poses(root / kCampusSequence / "poses.txt", [](std::vector<Pose>& poses) {
           for (std::size_t row = 21; row < 24; ++row) poses[row] = poses[20];
         });
       },
       "the poses are frozen: rows 21 to 24"},
      {"a_lost_pose_made_up_for", kKitti,
       [](const fs::path& root) {
         change_poses(root / kKittiSequence / "poses.txt", [](std::vector<Pose>& poses) {
           poses.erase(poses.begin() + static_cast<std::ptrdiff_t>(kScansExamined / 2));
           poses.push_back(poses.back());
         });
       },
       "1 row earlier than before: expected one pose per scan (was a pose lost there?)"},
      {"frozen_from_half_on", kKitti,
       [](const fs::path& root) {
         change_poses(root / kKittiSequence / "poses.txt", [](std::vector<Pose>& poses) {
           for (std::size_t row = kScansExamined / 2; row < kScansExamined; ++row)
             poses[row] = poses[kScansExamined / 2];
         });
       },
       "the poses are frozen: rows"},
      {"turned_rotations", kKitti,
       [](const fs::path& root) {
         std::mt19937 bits(5);
         std::normal_distribution<double> turn_rad(0.0, 0.05);
         change_lidar_poses(root, [&](std::size_t, Pose& pose) {
           pose.rotate(Eigen::AngleAxisd(turn_rad(bits), Eigen::Vector3d::UnitZ()));
         });
       },
       "the poses do not fit the scans in any convention"},
      {"every_second_scan_upside_down", kKitti,
       [](const fs::path& root) {
         for (std::size_t scan = 0; scan < kScansExamined; scan += 2) {
           const fs::path file = root / kKittiSequence / fmt::format("velodyne/{:06}.bin", scan);
           auto points = read_bin(file);
           for (Point& point : points) point.z = -point.z;
           write_bin(file, points);
         }
       },
       "the flat surfaces within 10 m are above the sensor, in others below"},
      {"scattered_poses", kCampus,
       [](const fs::path& root) {
         std::mt19937 bits(5);
         std::normal_distribution<double> noise_m(0.0, 0.1);
         change_poses(root / kCampusSequence / "poses.txt", [&](std::vector<Pose>& poses) {
           for (Pose& pose : poses) {
             pose.translation() += Eigen::Vector3d(noise_m(bits), noise_m(bits), noise_m(bits));
           }
         });
       },
       "the poses scatter by 0."},
      {"label_without_scan", kKitti,
       [](const fs::path& root) {
         fs::copy_file(root / kKittiSequence / "labels/000003.label",
                       root / kKittiSequence / "labels/000099.label");
       },
       "1 label files have no scan: 000099", Severity::kError},
  };
  return all;
}

/// Faults that sanitized builds try, where each takes half a minute.
constexpr std::string_view kTriedSanitized[] = {"transposed_rotations",
                                                "poses_shifted_by_one_scan_on_a_straight_road",
                                                "inverse_poses_on_a_straight_road",
                                                "rows_of_neighbours_exchanged",
                                                "rows_far_apart_exchanged",
                                                "first_two_rows_exchanged",
                                                "exchanged_labels",
                                                "one_scan_missing",
                                                "four_frozen_rows",
                                                "turned_rotations"};

class Doctor : public testing::TestWithParam<Fault> {};

TEST_P(Doctor, FindsThePlantedFault) {
  const Fault& fault = GetParam();
  if (kSanitized && std::ranges::find(kTriedSanitized, fault.name) == std::end(kTriedSanitized)) {
    GTEST_SKIP() << "takes minutes in sanitized builds";
  }
  const TempFolder folder;
  fs::copy(good_copy(fault.layout), folder / "data", fs::copy_options::recursive);
  fault.plant(folder / "data");
  const Checkup checkup = check_up(folder / "data", {});
  EXPECT_THAT(all_symptoms(checkup), HasSubstr(fault.symptom));
  EXPECT_EQ(checkup.has(Severity::kError), fault.severity == Severity::kError);
}

TEST(DoctorOnStampedPoses, HasTheirClockMovedAndNotTheirRows) {
  const fs::path data = good_copy(kKitti);
  const Dataset dataset = open_dataset(data, {});
  const Sequence& sequence = *dataset.sequences.at(0);
  std::string tum;
  for (std::size_t k = 0; k < sequence.size(); ++k) {
    const Pose& pose = sequence.map_from_sensor(k);
    const Eigen::Vector3d at_m = pose.translation();
    const Eigen::Quaterniond turn(pose.linear());
    tum += fmt::format("{:.6f} {} {} {} {} {} {} {}\n",
                       1e-9 * static_cast<double>(*sequence.stamp_ns(k)) + 0.3, at_m.x(), at_m.y(),
                       at_m.z(), turn.x(), turn.y(), turn.z(), turn.w());
  }
  const TempFolder folder;
  OpenOptions options;
  options.reading.poses = PoseFile{folder.write("late.tum", tum)};
  const Checkup checkup = check_up(data, options);
  std::string said = all_symptoms(checkup);
  EXPECT_THAT(said, HasSubstr("the poses fit better as 3 rows later: "));
  for (const std::string& remark : checkup.sequences.at(0).remarks) said += remark + '\n';
  EXPECT_THAT(said, testing::Not(HasSubstr("remove the first")));
  const std::string offset = "pose_offset_s";
  std::size_t times = 0;
  for (std::size_t at = said.find(offset); at != said.npos; at = said.find(offset, at + 1)) {
    const std::string value = said.substr(at + offset.size() + 1);
    EXPECT_EQ(value.substr(0, value.find_first_of(" ;\n")), "-0.3") << said;
    ++times;
  }
  EXPECT_GE(times, 2U) << said;
  EXPECT_EQ(checkup.remedy().pose_offset_s, -0.3);
}

TEST(DoctorOnAnExcerpt, IsQuietAboutFewerScansThanPublished) {
  const TempFolder folder;
  fs::copy(good_copy(kKitti), folder / "data", fs::copy_options::recursive);
  fs::remove(folder / "data/simulated.json");
  fs::remove(folder / "data" / kKittiSequence / "simulated.json");
  const Checkup checkup = check_up(folder / "data", {});
  EXPECT_EQ(all_symptoms(checkup), "");
  ASSERT_EQ(checkup.sequences.size(), 1U);
  EXPECT_THAT(checkup.sequences.front().remarks,
              testing::Contains("has 40 of the 4071 scans that are published"));
}

TEST(DoctorOnAnExcerpt, NotesThatNothingMovesWithoutAWarning) {
  const TempFolder folder;
  fs::copy(good_copy(kKitti), folder / "data", fs::copy_options::recursive);
  change_labels(folder / "data" / kKittiSequence, [](std::uint32_t, const Point&) { return 40U; });
  const Checkup checkup = check_up(folder / "data", {});
  EXPECT_EQ(all_symptoms(checkup), "");
  ASSERT_EQ(checkup.sequences.size(), 1U);
  EXPECT_THAT(
      checkup.sequences.front().remarks,
      testing::Contains("no point of 40 labelled scans is labelled moving: the IoU of these "
                        "labels is undefined"));
}

TEST(DoctorOnAFewScansOfAStraightRoad, TellsInverseFromTransposedPoses) {
  const TempFolder folder;
  simulate({.layout = DatasetKind::kSemanticKitti,
            .scene = "highway",
            .scans = 12,
            .seed = 1,
            .out = folder / "data",
            .threads = 2});
  const fs::path file = folder / "data" / kKittiSequence / "poses.txt";
  auto poses = read_poses(file);
  for (Pose& pose : poses) pose = pose.inverse();
  write_poses(file, poses);
  const std::string symptoms = all_symptoms(check_up(folder / "data", {}));
  EXPECT_THAT(symptoms, HasSubstr("the poses fit better as sensor_from_map (inverse):"));
}

/// A wall 8 m ahead and, before it, a box that moves sideways by half a metre per scan.
std::vector<Point> wall_and_box(std::size_t scan) {
  std::vector<Point> points;
  for (int column = -60; column < 60; ++column) {
    for (int row = -10; row < 20; ++row) {
      const float y = 0.1F * static_cast<float>(column), z = 0.1F * static_cast<float>(row);
      points.push_back({8.0F, y, z, 0.0F});
      const float box_y_m = 0.5F * static_cast<float>(scan) - 5.0F;
      if (std::abs(y) < 0.4F && z < 0.8F) points.push_back({4.0F, box_y_m + y, z, 0.0F});
    }
  }
  return points;
}

TEST(DoctorBeforeAWall, IsQuietAboutASensorThatStandsWhileSomethingMoves) {
  const TempFolder folder;
  const fs::path sequence = folder / "own";
  fs::create_directories(sequence / "velodyne");
  std::vector<std::int64_t> stamps_ns;
  for (std::size_t scan = 0; scan < 20; ++scan) {
    write_bin(sequence / "velodyne" / fmt::format("{:06}.bin", scan), wall_and_box(scan));
    stamps_ns.push_back(static_cast<std::int64_t>(scan) * 100'000'000);
  }
  write_times(sequence / "times.txt", stamps_ns);
  write_poses(sequence / "poses.txt", std::vector<Pose>(20, Pose::Identity()));
  EXPECT_EQ(all_symptoms(check_up(sequence, {.kind = DatasetKind::kSemanticKitti})), "");
}

/// A corridor without doors: nothing holds a scan along it.
std::vector<Point> corridor() {
  std::vector<Point> points;
  for (int beam = -8; beam < 8; ++beam) {
    for (int step = 0; step < 720; ++step) {
      const double around = M_PI / 360.0 * step, up = M_PI / 90.0 * beam;
      const double range_m = 1.1 / std::max(std::abs(std::sin(around)), 0.03);
      points.push_back({static_cast<float>(range_m * std::cos(around)),
                        static_cast<float>(range_m * std::sin(around)),
                        static_cast<float>(range_m * std::tan(up)), 0.0F});
    }
  }
  return points;
}

TEST(DoctorInACorridor, IsQuietAboutAMotionThatScansCannotShow) {
  const TempFolder folder;
  const fs::path sequence = folder / "own";
  fs::create_directories(sequence / "velodyne");
  std::vector<Pose> poses(30, Pose::Identity());
  for (std::size_t scan = 0; scan < poses.size(); ++scan) {
    std::vector<Point> points = corridor();
    points.resize(points.size() - scan);  // no two scans are the same
    write_bin(sequence / "velodyne" / fmt::format("{:06}.bin", scan), points);
    poses[scan].translation().x() = 0.1 * static_cast<double>(scan);
  }
  write_poses(sequence / "poses.txt", poses);
  const Checkup checkup = check_up(sequence, {.kind = DatasetKind::kSemanticKitti});
  for (const Symptom& symptom : checkup.symptoms) {
    EXPECT_THAT(symptom.what, testing::Not(HasSubstr("times as long"))) << "a wrong advice";
  }
}

TEST(Checks, AreRowsAboutFacts) {
  const std::vector<Check> table = {{Subject::kPoints,
                                     "brightness",
                                     {{"bright_share", '>', 0.5}, {"points", '>', 100}},
                                     "{bright_share_percent:.0f} % of {points} points are bright"}};
  Facts facts;
  EXPECT_TRUE(judged(table, Subject::kPoints, facts, "00").empty()) << "nothing was measured";
  facts["bright_share"] = 0.75;
  facts["points"] = std::size_t{100};
  EXPECT_TRUE(judged(table, Subject::kPoints, facts, "00").empty()) << "one limit is not passed";
  facts["points"] = std::size_t{120};
  const auto symptoms = judged(table, Subject::kPoints, facts, "00");
  ASSERT_EQ(symptoms.size(), 1U);
  EXPECT_EQ(symptoms.front().where, "00");
  EXPECT_EQ(symptoms.front().what, "75 % of 120 points are bright");
}

TEST(Checks, CompareFactsThatAreMeasured) {
  const Checkup checkup = check_up(good_copy(kKitti), {});
  ASSERT_EQ(checkup.sequences.size(), 1U);
  const Facts& facts = checkup.sequences.front().facts;
  std::vector<std::string> unknown;
  for (const Check& check : checks()) {
    for (const Limit& limit : check.limits) {
      if (!facts.number(limit.fact)) unknown.emplace_back(limit.fact);
    }
  }
  // What is there only where it is found.
  EXPECT_THAT(unknown, testing::UnorderedElementsAre(
                           "turned_scans", "clock_off_s", "equal_poses", "missing_turn",
                           "missing_turn", "lost_rows_repeated", "lost_rows", "better_gain",
                           "explained_share", "scans_without_moving", "scans_without_moving",
                           "scans_left_out", "scans_too_many", "points_unlike_published"));
}

INSTANTIATE_TEST_SUITE_P(Faults, Doctor, testing::ValuesIn(faults()),
                         [](const auto& fault) { return std::string(fault.param.name); });

}  // namespace
}  // namespace mosbench
