#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <mosbench/scan.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

enum class SensorKind : std::uint8_t {
  kOs1_64,
  kOs2_128,
  kVlp16,
  kHdl64e,
  kAvia,
  kAeva,
  kHdl32e,
  kMid360
};

enum class MoverKind : std::uint8_t { kPedestrian, kCyclist, kCar, kTruck };

enum class Substance : std::uint8_t {
  kGround,
  kBuilding,
  kPole,
  kVegetation,
  kMoverBody,
  kDoor,
  kBall
};

/// The state of one part of a scene at one instant.
struct OwnerState {
  Substance substance = Substance::kGround;
  MoverKind mover = MoverKind::kPedestrian;  ///< of a kMoverBody
  bool labelled = true;
  bool moving = false;                 ///< its speed exceeds 0.5 m/s, of a vehicle 1.0 m/s
  bool dynamic_by_appearance = false;  ///< an annotator calls it dynamic although it stands
  double speed_m_s = 0.0;
  Eigen::Vector3d base_m = Eigen::Vector3d::Zero();  ///< of its bodies, which turn around it
  Eigen::Vector2d axis = Eigen::Vector2d::UnitX();   ///< unit vector, where its x points
};

/// A point of a simulated scan that has a return, and the part of the scene that it is on.
struct SimulatedReturn {
  const Point& point;
  const OwnerState& owner;
  std::uint32_t owner_number;
};

/// Returns 251, 9 or, without a label, 0.
std::uint32_t moving_label(const SimulatedReturn& seen);
/// Returns a label with the owner as instance, of which there are `instances` at most.
std::uint32_t with_instance(std::uint32_t label, std::uint32_t owner_number,
                            std::uint32_t instances = 65536);
/// Whether it is of what can move, if it stands.
bool is_movable(const OwnerState& owner);

/// One sensor's recording in a simulated data set. In both texts {} is the name of the scene.
struct SimulatedRecording {
  std::string folder;  ///< relative to the root
  std::string name;    ///< that readers give the sequence
  SensorKind sensor;   ///< unless the scene names another
};

/// How a data set is made of scenes. Several recordings are of sensors that no scene may replace.
struct LayoutSimulation {
  std::vector<SimulatedRecording> recordings;
  std::string_view truth =
      "Truth is by speed: above 0.5 m/s is moving, for vehicles above 1.0 m/s.";  ///< for people
  std::uint32_t (*label)(const SimulatedReturn& seen) = moving_label;
  /// Returns the scans with truth; null: all. If that is none, the last one has truth. Where
  /// LayoutWriter::keeps is kNone no scan has.
  std::set<std::size_t> (*labelled)(std::size_t scans) = nullptr;
  bool has_flow = false;  ///< the motions of points are kept, too
  /// Every ray is kept, and static without a return; such sets need a sensor with rings.
  bool keeps_lost = false;
  bool is_global = false;  ///< poses are in a global frame; else the first is the identity
  std::string (*stem)(std::size_t scan_index, std::int64_t stamp_ns) = nullptr;  ///< null: %06d
  /// Returns the stamp that is kept of a scan; null: the whole one.
  std::optional<std::int64_t> (*stamp_ns)(std::int64_t stamp_ns, std::int64_t first_ns) = nullptr;
  Pose camera_from_lidar = Pose::Identity();  ///< Tr of calib.txt, if poses are of the camera
};

/// Every `step`-th scan from the fifth on: the method detects nothing in the first ones, and labels
/// there would measure nothing.
std::set<std::size_t> every_labelled(std::size_t step, std::size_t scans);

/// For layouts without stamps.
std::optional<std::int64_t> no_stamp(std::int64_t stamp_ns, std::int64_t first_ns);

}  // namespace mosbench
