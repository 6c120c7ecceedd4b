#include "datasets/simulator/simulate.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <system_error>
#include <vector>

#include "core/base/thread_pool.hpp"
#include "datasets/disk/files.hpp"
#include "datasets/disk/partial_file.hpp"
#include "datasets/layouts/layout.hpp"
#include "datasets/layouts/simulated_origin.hpp"
#include "datasets/sequence/portable_math.hpp"
#include "datasets/simulator/built_in_scenes.hpp"
#include "datasets/simulator/scene_json.hpp"
#include "datasets/simulator/simulated_sequence.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostScans = 1'000'000;

SimulatedOrigin origin_of(const SimulateOptions& options, const Scene& scene) {
  const std::string text = format_scene(scene);
  return {.layout = options.layout,
          .scene = scene.name,
          .scene_fingerprint = fmt::format("{:016x}", XXH3_64bits(text.data(), text.size())),
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

std::string readme(const SimulatedOrigin& origin) {
  return fmt::format(
      "These scans are simulated. Nothing in this folder was recorded by a sensor, and no number\n"
      "computed from it may be shown next to those published for the real data set.\n\n"
      "Scene \"{}\" is in scene.json. To make the same files again:\n"
      "mosbench simulate --layout {} --scene scene.json --scans {} --seed {}{} --out DIR\n"
      "{}\n",
      origin.scene, to_string(origin.layout), origin.scans, origin.seed,
      origin.perturb ? " --perturb " + shell_word(*origin.perturb) : "",
      layout_of(origin.layout).simulation->truth);
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
                             .radial_velocities = sequence->recording().has_radial_velocities});
    writers.push_back({std::move(sequence), std::move(files)});
  }
  claim_folder(options.out, origin);
  write_file_atomic(options.out / "README.txt", readme(origin));
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
