#include "datasets/simulator/simulated_sequence.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "datasets/perturb/perturbation.hpp"
#include "datasets/sequence/portable_math.hpp"
#include "datasets/simulator/simulated_doppler.hpp"
#include "datasets/simulator/simulated_flow.hpp"
#include "datasets/simulator/simulator.hpp"

namespace mosbench {
namespace {

class SimulatedSequence : public Sequence {
 public:
  SimulatedSequence(const SimulateOptions& options, const Scene& scene,
                    const SimulatedRecording& simulated)
      : layout_(options.layout), simulator_(scene, sensor_model(simulated.sensor), options.seed) {
    const std::set<std::size_t> labelled = labelled_scans(layout_, options.scans);
    Recording& recording = mutable_recording();
    recording.name = SequenceName(simulated_name(layout_, simulated), simulated.folder);
    recording.has_radial_velocities =
        layout_ == DatasetKind::kHelipr && simulated.sensor == SensorKind::kAeva;
    for (std::size_t k = 0; k < options.scans; ++k) {
      recording.scans.push_back(
          {.stem = stem_of(k),
           .file = std::nullopt,
           .stamp_ns = stored_stamp_ns(simulator_.stamp_ns(k)),
           .map_from_sensor = stored_pose(simulator_.map_from_sensor(k)),
           .points = layout_ == DatasetKind::kDoals ? simulator_.sensor().slots() : 0,
           .has_truth = labelled.contains(k)});
    }
  }

  using Sequence::read;
  void read(std::size_t scan_index, Frame& frame) const override {
    SimulatedScan scan = simulator_.scan(scan_index);
    describe(scan_index, frame);
    frame.truth.reset();
    const bool labelled = has_truth(scan_index);
    if (layout_ == DatasetKind::kDoals) {
      if (labelled) frame.truth = doals_truth(scan);
      frame.points = std::move(scan.points);
      return;
    }
    frame.points.clear();
    if (labelled) frame.truth.emplace();
    SceneSnapshot later;
    if (layout_ == DatasetKind::kOpenSceneFlow) {
      later = simulator_.scene_at(scan_index + 1);
      frame.motions.emplace();
    }
    std::optional<SimulatedDoppler> doppler;
    if (recording().has_radial_velocities) doppler.emplace(simulator_, scan_index);
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      if (scan.owners[i] == SimulatedScan::kNoReturn) continue;
      frame.points.push_back(scan.points[i]);
      if (labelled) frame.truth->push_back(layout_label(layout_, scan, i));
      if (frame.motions) add_motion(scan, i, later, period_s(scan_index), *frame.motions);
      if (doppler) frame.radial_velocity_m_s.push_back(doppler->radial_velocity_m_s(scan, i));
    }
  }
  std::vector<std::uint32_t> read_truth(std::size_t scan_index) const override {
    Frame frame;
    read(scan_index, frame);
    if (!frame.truth) refuse_truth(scan_index);
    return std::move(*frame.truth);
  }

 private:
  double period_s(std::size_t scan_index) const {
    return static_cast<double>(simulator_.stamp_ns(scan_index + 1) -
                               simulator_.stamp_ns(scan_index)) *
           1e-9;
  }

  /// Scans of HeLiPR are called as their stamps, those of KITTI's raw data by ten digits.
  std::string stem_of(std::size_t scan_index) const {
    if (layout_ == DatasetKind::kHelipr) return fmt::format("{}", simulator_.stamp_ns(scan_index));
    if (layout_ == DatasetKind::kKittiRaw) return fmt::format("{:010}", scan_index);
    return fmt::format("{:06}", scan_index);
  }

  /// Sipailou, HeLiMOS and KITTI's tracking have no stamps, those of SemanticKITTI start at 0, and
  /// nuScenes counts microseconds.
  std::optional<std::int64_t> stored_stamp_ns(std::int64_t stamp_ns) const {
    constexpr std::int64_t kNsPerUs = 1000;
    switch (layout_) {
      case DatasetKind::kSipailou:
      case DatasetKind::kHelimos:
      case DatasetKind::kKittiTracking:
        return std::nullopt;
      case DatasetKind::kSemanticKitti:
        return stamp_ns - simulator_.stamp_ns(0);
      case DatasetKind::kNuscenes:
        return stamp_ns / kNsPerUs * kNsPerUs;
      default:
        return stamp_ns;
    }
  }

  /// Poses of HeLiMOS and HeLiPR are in a global frame, those of the other sets begin at the
  /// identity.
  Pose stored_pose(const Pose& pose) const {
    if (layout_ == DatasetKind::kHelimos || layout_ == DatasetKind::kHelipr) return pose;
    return compose(inverse_of(simulator_.map_from_sensor(0)), pose);
  }

  DatasetKind layout_;
  Simulator simulator_;
};

}  // namespace

std::string simulated_name(DatasetKind layout, const SimulatedRecording& recording) {
  const std::filesystem::path& folder = recording.folder;
  switch (layout) {
    case DatasetKind::kOpenSceneFlow:
      return folder.stem().string();
    case DatasetKind::kDoals:
      return folder.generic_string();
    case DatasetKind::kHelipr:
      return folder.generic_string() +
             (recording.sensor == SensorKind::kAeva ? "/Aeva" : "/Ouster");
    case DatasetKind::kKittiTracking:
      return folder.generic_string() + "/0000";
    default:
      return folder.filename().string();
  }
}

std::unique_ptr<Sequence> simulated_sequence(const SimulateOptions& options, const Scene& scene,
                                             const SimulatedRecording& simulated) {
  std::unique_ptr<Sequence> sequence =
      std::make_unique<SimulatedSequence>(options, scene, simulated);
  if (!options.perturb) return sequence;
  return perturbed(std::move(sequence), *options.perturb);
}

}  // namespace mosbench
