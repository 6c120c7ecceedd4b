#include "datasets/simulator/simulated_layouts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>

#include "datasets/formats/kitti_calib.hpp"
#include "datasets/formats/point_range.hpp"
#include "datasets/layouts/helimos_layout.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

constexpr std::array kSimulatedLayouts = {
    DatasetKind::kDoals,         DatasetKind::kSipailou,      DatasetKind::kHelimos,
    DatasetKind::kSemanticKitti, DatasetKind::kOpenSceneFlow, DatasetKind::kNuscenes,
    DatasetKind::kHelipr,        DatasetKind::kKittiRaw,      DatasetKind::kKittiTracking};

bool is_vehicle(const OwnerState& owner) {
  return owner.substance == Substance::kMoverBody &&
         (owner.mover == MoverKind::kCar || owner.mover == MoverKind::kTruck);
}

std::uint32_t sipailou_label(const OwnerState& owner, double range_m) {
  constexpr double kNearest_m = 3.0, kFarthest_m = 50.0;
  constexpr std::uint32_t kMovingVehicle = 252;
  if (!owner.labelled || range_m < kNearest_m || range_m > kFarthest_m) return 0;
  if (!owner.moving) return kStaticLabel;
  return is_vehicle(owner) ? kMovingVehicle : kMovingLabel;
}

std::uint32_t helimos_label(const OwnerState& owner, double range_m) {
  constexpr double kFarthest_m = 80.0;
  if (!owner.labelled || range_m > kFarthest_m) return 0;
  return owner.moving ? kMovingLabel : kStaticLabel;
}

// The class ids of semantic-kitti.yaml.
std::uint32_t kitti_mover_class(const OwnerState& owner) {
  switch (owner.mover) {
    case MoverKind::kPedestrian:
      return owner.moving ? 254 : 30;
    case MoverKind::kCyclist:
      return owner.moving ? 253 : 31;
    case MoverKind::kCar:
      return owner.moving ? 252 : 10;
    case MoverKind::kTruck:
      return owner.moving ? 258 : 18;
  }
  return 0;
}

std::uint32_t kitti_class(const OwnerState& owner) {
  if (!owner.labelled) return 0;
  switch (owner.substance) {
    case Substance::kGround:
      return 40;
    case Substance::kBuilding:
      return 50;
    case Substance::kPole:
      return 80;
    case Substance::kVegetation:
      return 70;
    case Substance::kMoverBody:
      return kitti_mover_class(owner);
    case Substance::kDoor:
    case Substance::kBall:
      return owner.moving ? 259 : 99;
  }
  return 0;
}

std::uint32_t kitti_label(const OwnerState& owner, std::uint32_t owner_number) {
  constexpr std::uint32_t kInstanceBits = 16, kInstances = 65536;
  const bool movable = owner.substance >= Substance::kMoverBody;
  return kitti_class(owner) | (movable ? (owner_number % kInstances) << kInstanceBits : 0U);
}

/// The owner of movable things is their instance, an int16 there.
std::uint32_t scene_flow_label(const SimulatedScan& scan, std::size_t point) {
  constexpr std::uint32_t kInstanceBits = 16, kInstances = 32768;
  const std::uint32_t label = moving_label(scan, point), owner = scan.owners[point];
  const bool movable = scan.scene.owners[owner].substance >= Substance::kMoverBody;
  return label == 0 || !movable ? label : label | (owner % kInstances) << kInstanceBits;
}

/// The owner of a moving point is its instance, as that of a box.
std::uint32_t box_label(std::uint32_t label, std::uint32_t owner) {
  constexpr std::uint32_t kInstanceBits = 16, kInstances = 65536;
  return label == kMovingLabel ? label | (owner % kInstances) << kInstanceBits : label;
}

std::uint32_t label_in_view(const SimulatedScan& scan, std::size_t point) {
  static const CameraView kView = written_kitti_mounting().view;
  if (!kView.sees(position_of(scan.points[point]))) return 0;
  return box_label(moving_label(scan, point), scan.owners[point]);
}

SensorKind sensor_of(const Scene& scene, SensorKind usual) {
  return scene.sensor ? sensor_kind_from_string(*scene.sensor).value_or(usual) : usual;
}

std::vector<SimulatedRecording> helimos_recordings() {
  constexpr std::array<SensorKind, kHelimosSensors.size()> kModels = {
      SensorKind::kAeva, SensorKind::kAvia, SensorKind::kOs2_128, SensorKind::kVlp16};
  std::vector<SimulatedRecording> recordings;
  for (std::size_t i = 0; i < kModels.size(); ++i) {
    recordings.push_back({helimos_folder() / kHelimosSensors[i], kModels[i]});
  }
  return recordings;
}

[[noreturn]] void refuse_sensor(const Scene& scene, const std::string& why) {
  throw UsageError("scene '" + scene.name + "' asks for sensor '" + *scene.sensor + "', but " +
                   why);
}

void refuse_sensors(const Scene& scene, DatasetKind layout, const char* count) {
  if (!scene.sensor && !scene.columns) return;
  throw UsageError(
      fmt::format("scene '{}' sets \"sensor\" or \"columns\", but layout {} has {} sensors of its "
                  "own; leave these keys out",
                  scene.name, to_string(layout), count));
}

}  // namespace

std::optional<DatasetKind> simulated_layout_from_string(std::string_view name) {
  for (const DatasetKind kind : kSimulatedLayouts) {
    if (to_string(kind) == name) return kind;
  }
  return std::nullopt;
}

std::string simulated_layout_names() {
  std::vector<std::string_view> names;
  for (const DatasetKind kind : kSimulatedLayouts) names.push_back(to_string(kind));
  const std::string_view last = names.back();
  names.pop_back();
  return fmt::format("{} or {}", fmt::join(names, ", "), last);
}

std::vector<SimulatedRecording> recordings_of(DatasetKind layout, const Scene& scene) {
  switch (layout) {
    case DatasetKind::kDoals:
      if (sensor_of(scene, SensorKind::kOs1_64) == SensorKind::kAvia) {
        refuse_sensor(scene, "layout doals needs one with rings; expected e.g. os1-64");
      }
      return {{std::filesystem::path(scene.name) / "sequence_1",
               sensor_of(scene, SensorKind::kOs1_64)}};
    case DatasetKind::kSipailou:
      return {{"sequences/06", sensor_of(scene, SensorKind::kAvia)}};
    case DatasetKind::kHelimos:
      refuse_sensors(scene, layout, "four");
      return helimos_recordings();
    case DatasetKind::kSemanticKitti:
      return {{"sequences/08", sensor_of(scene, SensorKind::kHdl64e)}};
    case DatasetKind::kOpenSceneFlow:
      return {{scene.name + ".h5", sensor_of(scene, SensorKind::kHdl64e)}};
    case DatasetKind::kNuscenes:
      return {{scene.name, sensor_of(scene, SensorKind::kHdl32e)}};
    case DatasetKind::kHelipr:
      refuse_sensors(scene, layout, "two");
      return {{scene.name, SensorKind::kAeva}, {scene.name, SensorKind::kOs2_128}};
    case DatasetKind::kKittiRaw:
      return {{std::filesystem::path("date") / scene.name, sensor_of(scene, SensorKind::kHdl64e)}};
    case DatasetKind::kKittiTracking:
      return {{scene.name, sensor_of(scene, SensorKind::kHdl64e)}};
    default:
      throw UsageError("layout " + std::string(to_string(layout)) + " is not simulated");
  }
}

std::set<std::size_t> labelled_scans(DatasetKind layout, std::size_t scans) {
  // The method detects nothing in the first scans; labels there would measure nothing.
  constexpr std::size_t kFirst = 4, kDoalsScans = 10, kHelimosStep = 4, kNuscenesStep = 5;
  std::set<std::size_t> labelled;
  if (layout == DatasetKind::kHelipr) return labelled;
  if (layout == DatasetKind::kDoals) {
    for (std::size_t i = 1; i <= kDoalsScans; ++i) {
      const std::size_t end = i * scans / kDoalsScans;
      if (end > kFirst) labelled.insert(end - 1);
    }
  } else if (layout == DatasetKind::kHelimos || layout == DatasetKind::kNuscenes) {
    const std::size_t step = layout == DatasetKind::kHelimos ? kHelimosStep : kNuscenesStep;
    for (std::size_t i = kFirst; i < scans; i += step) labelled.insert(i);
  } else {
    for (std::size_t i = 0; i < scans; ++i) labelled.insert(i);
  }
  if (labelled.empty() && scans > 0) labelled.insert(scans - 1);
  return labelled;
}

HelimosSplits simulated_splits(const std::set<std::size_t>& labelled) {
  const std::size_t block = std::max<std::size_t>(1, labelled.size() * 16 / 100);
  HelimosSplits splits;
  std::size_t position = 0;
  for (const std::size_t number : labelled) {
    const std::size_t from_end = labelled.size() - position++;
    const char* split = from_end <= block ? "test" : from_end <= 2 * block ? "val" : "train";
    splits[split].insert(number);
  }
  return splits;
}

std::uint32_t layout_label(DatasetKind layout, const SimulatedScan& scan, std::size_t point) {
  const std::uint32_t owner_number = scan.owners[point];
  const OwnerState& owner = scan.scene.owners[owner_number];
  switch (layout) {
    case DatasetKind::kSipailou:
      return sipailou_label(owner, range_m(scan.points[point]));
    case DatasetKind::kHelimos:
      return helimos_label(owner, range_m(scan.points[point]));
    case DatasetKind::kSemanticKitti:
      return kitti_label(owner, owner_number);
    case DatasetKind::kOpenSceneFlow:
      return scene_flow_label(scan, point);
    case DatasetKind::kNuscenes:
      return box_label(owner.moving ? kMovingLabel : kStaticLabel, owner_number);
    case DatasetKind::kKittiRaw:
    case DatasetKind::kKittiTracking:
      return label_in_view(scan, point);
    default:
      break;
  }
  return moving_label(scan, point);
}

std::vector<std::uint32_t> doals_truth(const SimulatedScan& scan) {
  std::vector<std::uint32_t> truth(scan.points.size(), kStaticLabel);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (scan.owners[i] == SimulatedScan::kNoReturn) continue;
    const OwnerState& owner = scan.scene.owners[scan.owners[i]];
    if (owner.moving || owner.dynamic_by_appearance) truth[i] = kMovingLabel;
  }
  return truth;
}

}  // namespace mosbench
