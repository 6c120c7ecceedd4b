#include "datasets/simulator/simulate.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <mutex>
#include <system_error>
#include <utility>

#include "datasets/disk/files.hpp"
#include "datasets/disk/partial_file.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/perturb/perturbation.hpp"
#include "datasets/sequence/portable_math.hpp"
#include "datasets/sequence/simulated_origin.hpp"
#include "datasets/simulator/simulated_motion.hpp"
#include "datasets/simulator/simulator.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

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
  const auto sensor = sensor_kind_from_string(scene.sensor.value_or(""));
  if (layout.simulation->keeps_lost && sensor && !repeats_every_scan(sensor_model(*sensor))) {
    throw UsageError(
        fmt::format("scene '{}' asks for sensor '{}', but layout {} needs one with "
                    "rings; expected e.g. os1-64",
                    scene.name, *scene.sensor, layout.name));
  }
}

constexpr std::size_t kMostScans = 1'000'000;

SimulatedOrigin origin_of(const SimulateOptions& options, const Scene& scene) {
  return {.layout = std::string(to_string(options.layout)),
          .scene = scene.name,
          .scene_fingerprint = fingerprint_of(scene),
          .scans = options.scans,
          .seed = options.seed,
          .perturb = options.perturb ? std::optional(to_string(*options.perturb)) : std::nullopt};
}

/// Returns whether a folder is empty but for the first bytes of the marker, which a killed run may
/// have left.
bool holds_nothing(const fs::path& folder) {
  std::error_code error;
  fs::directory_iterator entries(folder, error);
  if (error == std::errc::no_such_file_or_directory) return true;
  if (error) throw DataError(folder, "cannot be listed", "a folder for the simulation");
  return std::all_of(fs::begin(entries), fs::end(entries), [&](const fs::directory_entry& entry) {
    return is_partial_of(entry.path().filename(), std::string(kSimulatedMarker));
  });
}

void claim_folder(const fs::path& out, const SimulatedOrigin& origin) {
  const fs::path marker = out / kSimulatedMarker;
  if (holds_nothing(out)) {
    write_file_atomic(marker, format_simulated_origin(origin));
    return;
  }
  const std::string way_out = "; choose another " + option("out") + " or remove it";
  if (!fs::exists(marker)) {
    throw UsageError(out.string() + ": holds files that are no simulation" + way_out);
  }
  if (parse_simulated_origin(read_file(marker), marker) != origin) {
    throw UsageError(out.string() + ": holds a simulation with other parameters (see " +
                     std::string(kSimulatedMarker) + ")" + way_out);
  }
}

std::string readme(const SimulatedOrigin& origin, const Layout& layout) {
  return fmt::format(
      "These scans are simulated. Nothing in this folder was recorded by a sensor, and no number\n"
      "computed from it may be shown next to those published for the real data set.\n\n"
      "Scene \"{}\" is in scene.json. To make the same files again:\n"
      "mosbench simulate --layout {} --scene scene.json --scans {} --seed {}{} --out DIR\n"
      "{}\n",
      origin.scene, origin.layout, origin.scans, origin.seed,
      origin.perturb ? " --perturb " + shell_word(*origin.perturb) : "", layout.simulation->truth);
}

/// A recording and what writes it.
struct RecordingWriter {
  std::unique_ptr<Sequence> sequence;
  std::unique_ptr<SequenceWriter> files;
};

/// Writes a scan with the pose of what the layout keeps poses of.
void write_scan(const RecordingWriter& writer, std::size_t scan_index, const Pose& tr) {
  Frame frame = writer.sequence->read(scan_index);
  if (tr.matrix() != Pose::Identity().matrix()) {
    frame.map_from_sensor = compose(compose(tr, frame.map_from_sensor), inverse_of(tr));
  }
  writer.files->write(scan_index, frame);
}

/// Tells that a scene's own time per scan is lost where the data set has no stamps.
std::vector<std::string> remarks_of(const std::vector<RecordingWriter>& writers, const Scene& scene,
                                    const Layout& layout) {
  if (scene.scan_period_s == Scene{}.scan_period_s) return {};
  std::size_t unstamped = 0;
  for (const RecordingWriter& writer : writers) {
    if (!writer.sequence->stamp_ns(0)) unstamped += writer.sequence->size();
  }
  if (unstamped == 0) return {};
  return {lost_stamps_text(unstamped, layout)};
}

void check(const SimulateOptions& options) {
  if (options.scans < 1 || options.scans > kMostScans) {
    throw UsageError(
        fmt::format("cannot simulate {} scans, expected 1 to {}", options.scans, kMostScans));
  }
  if (options.out.empty())
    throw UsageError("no folder to write to, expected " + option("out", "DIR"));
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

std::string fingerprint_of(const Scene& scene) {
  const std::string text = format_scene(scene);
  return fmt::format("{:016x}", XXH3_64bits(text.data(), text.size()));
}

bool simulates_several(DatasetKind kind) {
  const Layout& layout = layout_of(kind);
  return layout.simulation && layout.simulation->recordings.size() > 1;
}

std::vector<std::string> simulated_names(DatasetKind layout, const Scene& scene) {
  std::vector<std::string> names;
  for (const SimulatedRecording& recording : recordings_of(layout, scene)) {
    names.push_back(recording.name);
  }
  return names;
}

Scene load_scene(const std::string& name_or_file) {
  const bool is_file =
      name_or_file.ends_with(".json") || name_or_file.find('/') != std::string::npos;
  return is_file ? read_scene(name_or_file) : built_in_scene(name_or_file);
}

std::vector<std::string> simulate(
    const SimulateOptions& options,
    const std::function<void(std::size_t done, std::size_t total)>& progress) {
  check(options);
  const Scene scene = load_scene(options.scene);
  const SimulatedOrigin origin = origin_of(options, scene);
  std::vector<RecordingWriter> writers;
  std::vector<std::pair<std::size_t, std::size_t>> scans;  // of which writer, and which
  const auto recordings = recordings_of(options.layout, scene);
  const Layout& layout = layout_of(options.layout);
  const Pose& tr = layout.simulation->camera_from_lidar;
  for (const SimulatedRecording& recording : recordings) {
    auto sequence = simulated_sequence(options, scene, recording);
    for (std::size_t k = 0; k < sequence->size(); ++k) scans.emplace_back(writers.size(), k);
    auto files =
        layout.writer->open(options.out / recording.folder,
                            {.scans = sequence->size(),
                             .camera_from_lidar = tr,
                             .radial_velocities = sequence->recording().has_radial_velocities,
                             .mark = format_simulated_origin(origin)});
    writers.push_back({std::move(sequence), std::move(files)});
  }
  claim_folder(options.out, origin);
  for (const SimulatedRecording& recording : recordings) {
    const auto folder = mark_folder_of(*layout.writer, recording.folder);
    if (!folder) continue;
    write_file_atomic(options.out / *folder / kSimulatedMarker, format_simulated_origin(origin));
  }
  write_file_atomic(options.out / "README.txt", readme(origin, layout));
  write_file_atomic(options.out / "scene.json", format_scene(scene));

  std::size_t done = 0;
  std::mutex progress_mutex;
  ThreadPool pool(options.threads);
  pool.for_ranges(scans.size(), 1, [&](std::size_t i, std::size_t, unsigned) {
    write_scan(writers[scans[i].first], scans[i].second, tr);
    if (!progress) return;
    const std::lock_guard lock(progress_mutex);
    progress(++done, scans.size());
  });
  if (const auto write_splits = layout.writer->write_splits) {
    write_splits(options.out, simulated_splits(labelled_scans(options.layout, options.scans)));
  }
  for (const RecordingWriter& writer : writers) writer.files->finish();
  return remarks_of(writers, scene, layout);
}

}  // namespace mosbench
