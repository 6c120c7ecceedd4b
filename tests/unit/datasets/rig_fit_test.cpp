#include "datasets/sequence/rig_fit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "datasets/formats/point_range.hpp"
#include "datasets/sequence/rig_sequence.hpp"
#include "datasets/simulator/sensor_model.hpp"
#include "datasets/simulator/simulate.hpp"

/// LiDARs of a simulated vehicle among things that move, with mounts and clocks right and wrong.
namespace mosbench {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// How a LiDAR is mounted and stamped otherwise than it says, and which points it sees.
struct Fault {
  Pose moved = Pose::Identity();
  double later_s = 0.0;
  std::function<bool(const Eigen::Vector3d&)> sees = nullptr;
};

class FaultySequence : public SequenceAround {
 public:
  FaultySequence(std::unique_ptr<Sequence> inner, Fault fault)
      : SequenceAround(std::move(inner)), fault_(std::move(fault)) {
    double at_s = 10.0 - fault_.later_s;
    for (ScanEntry& scan : mutable_recording().scans) {
      scan.stamp_ns = std::llround(1e9 * at_s);
      at_s += 0.1;
    }
  }
  using Sequence::read;
  void read(std::size_t scan_index, Frame& frame) const override {
    SequenceAround::read(scan_index, frame);
    frame.truth.reset();
    if (!fault_.sees) return;
    std::erase_if(frame.points, [&](const Point& p) { return !fault_.sees(position_of(p)); });
  }

 private:
  Fault fault_;
};

/// In the order of these names.
enum Lidar : std::uint8_t { kAeva, kAvia, kOuster, kVelodyne };

/// What is said of a rig, the second LiDAR of which has a fault.
std::vector<std::string> doubts_of_rig(const char* scene_name, const std::vector<Lidar>& chosen,
                                       const Fault& second = {}, const Fault& first = {},
                                       std::uint64_t seed = 1) {
  constexpr const char* kNames[] = {"Aeva", "Avia", "Ouster", "Velodyne"};
  const Scene scene = load_scene(scene_name);
  const SimulateOptions options{
      .layout = DatasetKind::kHelimos, .scene = scene_name, .scans = 16, .seed = seed, .out = {}};
  const std::vector<SimulatedRecording> recordings = recordings_of(options.layout, scene);
  const auto named = [&](Lidar lidar) {
    for (const SimulatedRecording& recording : recordings) {
      if (recording.folder.find(kNames[lidar]) != std::string::npos) return recording;
    }
    throw std::logic_error("no such LiDAR");
  };
  std::vector<RigLidar> lidars;
  for (const Lidar lidar : chosen) {
    const SimulatedRecording recording = named(lidar);
    Pose mount = Pose::Identity();
    mount.translation() =
        sensor_model(recording.sensor).mount_m - sensor_model(named(chosen.front()).sensor).mount_m;
    const Fault& fault = lidars.empty() ? first : lidars.size() == 1 ? second : Fault{};
    lidars.push_back(
        {kNames[lidar],
         std::make_unique<FaultySequence>(simulated_sequence(options, scene, recording), fault),
         fault.moved * mount});
  }
  return doubts_about_mounts(RigSequence(std::move(lidars)));
}

Pose moved_by(double x_m, double y_m, double z_m) {
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(x_m, y_m, z_m);
  return pose;
}

Pose turned_by(double deg, const Eigen::Vector3d& axis) {
  return Pose(Eigen::AngleAxisd(deg * M_PI / 180.0, axis));
}

TEST(RigFit, SaysNothingOfMountsThatAreRight) {
  for (const char* scene : {"street", "road", "campus", "mall", "highway", "room"}) {
    for (const std::uint64_t seed : {1U, 2U}) {
      const std::vector<Lidar> chosen =
          seed == 1 ? std::vector{kOuster, kVelodyne, kAvia} : std::vector{kAvia, kAeva, kOuster};
      EXPECT_THAT(doubts_of_rig(scene, chosen, {}, {}, seed), IsEmpty()) << scene;
    }
    // A few centimetres and half a degree beside.
    EXPECT_THAT(doubts_of_rig(scene, {kOuster, kVelodyne},
                              {moved_by(0.05, 0.05, 0.0) * turned_by(0.5, {0, 0, 1})}),
                IsEmpty())
        << scene;
  }
}

TEST(RigFit, SaysNothingWhereLidarsLookApart) {
  const auto ahead = [](const Eigen::Vector3d& p) { return p.x() > -0.1 * p.norm(); };
  const auto behind = [](const Eigen::Vector3d& p) { return p.x() < 0.1 * p.norm(); };
  const auto left = [](const Eigen::Vector3d& p) { return p.y() > 0.5 * p.norm(); };
  const auto right = [](const Eigen::Vector3d& p) { return p.y() < -0.5 * p.norm(); };
  for (const char* scene : {"street", "road", "campus", "mall", "highway"}) {
    const std::vector<Lidar> both = {kOuster, kVelodyne};
    EXPECT_THAT(doubts_of_rig(scene, both, {.sees = behind}, {.sees = ahead}), IsEmpty()) << scene;
    EXPECT_THAT(doubts_of_rig(scene, both, {.sees = right}, {.sees = left}), IsEmpty()) << scene;
  }
}

TEST(RigFit, NamesMountsThatAreWrong) {
  const auto said = [](const Pose& moved) {
    return doubts_of_rig("street", {kOuster, kVelodyne, kAvia}, {.moved = moved});
  };
  const auto off = [](const char* by) {
    return ElementsAre(AllOf(HasSubstr("Velodyne does not fit Ouster: scan matching puts it "),
                             ContainsRegex(by),
                             HasSubstr("expected vehicle_from_lidar in metres")));
  };
  EXPECT_THAT(said(moved_by(0.3, 0, 0)), off("0\\.(29|30|31) m and 0\\.[01] degrees"));
  EXPECT_THAT(said(moved_by(0, 0.3, 0)), off("0\\.(29|30|31) m and 0\\.[01] degrees"));
  EXPECT_THAT(said(moved_by(0, 0, 0.3)), off("0\\.(29|30|31) m and 0\\.[01] degrees"));
  EXPECT_THAT(said(turned_by(5, {1, 0, 0})), off(" and (4\\.9|5\\.0|5\\.1) degrees"));
  EXPECT_THAT(said(turned_by(180, {0, 0, 1})), off(" and 1(79\\.9|80\\.0) degrees"));
  // As if the rows were lidar_from_vehicle.
  EXPECT_THAT(said(turned_by(-140, {0, 0, 1}) * moved_by(1.2, 0, 0)),
              off(" and 1(39\\.9|40\\.0|40\\.1) degrees"));
  EXPECT_THAT(said(turned_by(180, {0, 0, 1})), Not(testing::Contains(HasSubstr("stamps"))));
}

TEST(RigFit, NamesClocksThatAreWrongWhereTheVehicleMoves) {
  for (const double later_s : {0.3, -0.3}) {
    EXPECT_THAT(doubts_of_rig("street", {kOuster, kVelodyne}, {.later_s = later_s}),
                ElementsAre(AllOf(
                    HasSubstr("Velodyne does not fit Ouster: "),
                    ContainsRegex(later_s > 0 ? "or its stamps 0\\.(2[789]|3[0-3]) s later"
                                              : "or its stamps 0\\.(2[789]|3[0-3]) s earlier"))));
  }
  EXPECT_THAT(doubts_of_rig("mall", {kOuster, kVelodyne}, {.later_s = 0.02}), IsEmpty());
}

}  // namespace
}  // namespace mosbench
