#include "datasets/simulator/simulated_sequence.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "datasets/formats/label_file.hpp"
#include "datasets/perturb/perturbation.hpp"
#include "datasets/sequence/portable_math.hpp"
#include "datasets/simulator/simulated_motion.hpp"
#include "datasets/simulator/simulator.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

class SimulatedSequence : public Sequence {
 public:
  SimulatedSequence(const SimulateOptions& options, const Scene& scene,
                    const SimulatedRecording& simulated)
      : layout_(*layout_of(options.layout).simulation),
        simulator_(scene, sensor_model(simulated.sensor), options.seed) {
    const std::set<std::size_t> labelled = labelled_scans(options.layout, options.scans);
    const LayoutWriter& writer = *layout_of(options.layout).writer;
    Recording& recording = mutable_recording();
    recording.name = SequenceName(simulated.name, simulated.folder);
    recording.has_radial_velocities =
        writer.keeps_radial_velocities && simulated.sensor == SensorKind::kAeva;
    for (std::size_t k = 0; k < options.scans; ++k) {
      const std::int64_t stamp_ns = simulator_.stamp_ns(k);
      recording.scans.push_back(
          {.stem = layout_.stem ? layout_.stem(k, stamp_ns) : fmt::format("{:06}", k),
           .file = std::nullopt,
           .stamp_ns = layout_.stamp_ns ? layout_.stamp_ns(stamp_ns, simulator_.stamp_ns(0))
                                        : std::optional(stamp_ns),
           .map_from_sensor = stored_pose(simulator_.map_from_sensor(k)),
           .points = layout_.keeps_lost ? simulator_.sensor().slots() : 0,
           .has_truth = labelled.contains(k)});
    }
  }

  using Sequence::read;
  void read(std::size_t scan_index, Frame& frame) const override {
    const SimulatedScan scan = simulator_.scan(scan_index);
    describe(scan_index, frame);
    frame.points.clear();
    frame.truth.reset();
    if (has_truth(scan_index)) frame.truth.emplace();
    SceneSnapshot later;
    if (layout_.has_flow) {
      later = simulator_.scene_at(scan_index + 1);
      frame.motions.emplace();
    }
    std::optional<SimulatedDoppler> doppler;
    if (recording().has_radial_velocities) doppler.emplace(simulator_, scan_index);
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      const bool is_lost = scan.owners[i] == SimulatedScan::kNoReturn;
      if (is_lost && !layout_.keeps_lost) continue;
      frame.points.push_back(scan.points[i]);
      if (frame.truth) frame.truth->push_back(is_lost ? kStaticLabel : layout_.label(scan.at(i)));
      if (frame.motions) add_motion(scan, i, later, period_s(scan_index), *frame.motions);
      if (doppler) frame.radial_velocity_m_s.push_back(doppler->radial_velocity_m_s(scan, i));
    }
  }

 private:
  double period_s(std::size_t scan_index) const {
    return static_cast<double>(simulator_.stamp_ns(scan_index + 1) -
                               simulator_.stamp_ns(scan_index)) *
           1e-9;
  }

  Pose stored_pose(const Pose& pose) const {
    if (layout_.is_global) return pose;
    return compose(inverse_of(simulator_.map_from_sensor(0)), pose);
  }

  const LayoutSimulation& layout_;
  Simulator simulator_;
};

/// Throws where the scene asks for another sensor than its layout can have.
void check_sensor(const Layout& layout, const Scene& scene) {
  constexpr std::array<const char*, 5> kCounts = {"no", "one", "two", "three", "four"};
  const std::size_t sensors = layout.simulation->recordings.size();
  if (sensors > 1 && (scene.sensor || scene.columns)) {
    throw UsageError(fmt::format(
        "scene '{}' sets \"sensor\" or \"columns\", but layout {} has {} sensors of its "
        "own; leave these keys out",
        scene.name, layout.name, kCounts.at(sensors)));
  }
  if (layout.simulation->keeps_lost && scene.sensor == to_string(SensorKind::kAvia)) {
    throw UsageError(
        fmt::format("scene '{}' asks for sensor '{}', but layout {} needs one with "
                    "rings; expected e.g. os1-64",
                    scene.name, *scene.sensor, layout.name));
  }
}

}  // namespace

std::optional<DatasetKind> simulated_layout_from_string(std::string_view name) {
  const auto kind = dataset_kind_from_string(name);
  return kind && layout_of(*kind).simulation ? kind : std::nullopt;
}

std::string simulated_layout_names() {
  std::vector<std::string_view> names;
  for (const Layout* row : layouts()) {
    if (row->simulation) names.push_back(row->name);
  }
  const std::string_view last = names.back();
  names.pop_back();
  return fmt::format("{} or {}", fmt::join(names, ", "), last);
}

std::vector<SimulatedRecording> recordings_of(DatasetKind kind, const Scene& scene) {
  const Layout& layout = layout_of(kind);
  if (!layout.simulation) throw UsageError(fmt::format("layout {} is not simulated", layout.name));
  check_sensor(layout, scene);
  std::vector<SimulatedRecording> recordings = layout.simulation->recordings;
  for (SimulatedRecording& recording : recordings) {
    recording.folder = fmt::format(fmt::runtime(recording.folder), scene.name);
    recording.name = fmt::format(fmt::runtime(recording.name), scene.name);
    if (scene.sensor) {
      recording.sensor = sensor_kind_from_string(*scene.sensor).value_or(recording.sensor);
    }
  }
  return recordings;
}

std::set<std::size_t> labelled_scans(DatasetKind kind, std::size_t scans) {
  const Layout& layout = layout_of(kind);
  std::set<std::size_t> labelled;
  if (layout.writer->keeps == KeptTruth::kNone) return labelled;
  const auto choose = layout.simulation->labelled;
  if (choose != nullptr) labelled = choose(scans);
  for (std::size_t i = 0; i < scans && choose == nullptr; ++i) labelled.insert(i);
  if (labelled.empty() && scans > 0) labelled.insert(scans - 1);
  return labelled;
}

SplitNumbers simulated_splits(const std::set<std::size_t>& labelled) {
  const std::size_t block = std::max<std::size_t>(1, labelled.size() * 16 / 100);
  SplitNumbers splits;
  std::size_t position = 0;
  for (const std::size_t number : labelled) {
    const std::size_t from_end = labelled.size() - position++;
    const char* split = from_end <= block ? "test" : from_end <= 2 * block ? "val" : "train";
    splits[split].insert(number);
  }
  return splits;
}

std::unique_ptr<Sequence> simulated_sequence(const SimulateOptions& options, const Scene& scene,
                                             const SimulatedRecording& simulated) {
  std::unique_ptr<Sequence> sequence =
      std::make_unique<SimulatedSequence>(options, scene, simulated);
  if (!options.perturb) return sequence;
  return perturbed(std::move(sequence), *options.perturb);
}

}  // namespace mosbench
