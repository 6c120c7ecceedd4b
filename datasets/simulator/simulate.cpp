#include "datasets/simulator/simulate.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "core/base/thread_pool.hpp"
#include "datasets/files/bin_file.hpp"
#include "datasets/files/calib_file.hpp"
#include "datasets/files/errors.hpp"
#include "datasets/files/files.hpp"
#include "datasets/files/indices_file.hpp"
#include "datasets/files/label_file.hpp"
#include "datasets/files/pose_file.hpp"
#include "datasets/files/split_file.hpp"
#include "datasets/files/times_file.hpp"
#include "datasets/layouts/helimos_layout.hpp"
#include "datasets/layouts/simulated_origin.hpp"
#include "datasets/simulator/built_in_scenes.hpp"
#include "datasets/simulator/portable_math.hpp"
#include "datasets/simulator/scene_json.hpp"
#include "datasets/simulator/simulated_layouts.hpp"
#include "datasets/simulator/simulator.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostScans = 1'000'000;

// KITTI's cameras look along the car: camera x is lidar -y, camera y lidar -z, camera z lidar x.
Pose camera_from_lidar(DatasetKind layout) {
  Pose tr = Pose::Identity();
  if (layout != DatasetKind::kSemanticKitti) return tr;
  tr.linear() << 0.0, -1.0, 0.0, 0.0, 0.0, -1.0, 1.0, 0.0, 0.0;
  tr.translation() << 0.0, -0.08, -0.27;
  return tr;
}

SimulatedOrigin origin_of(const SimulateOptions& options, const Scene& scene) {
  const std::string text = format_scene(scene);
  return {.layout = options.layout,
          .scene = scene.name,
          .scene_fingerprint = fmt::format("{:016x}", XXH3_64bits(text.data(), text.size())),
          .scans = options.scans,
          .seed = options.seed};
}

// A killed run may have got no further than the first bytes of the marker.
bool holds_nothing(const fs::path& folder) {
  const std::string partial_marker = std::string(kSimulatedMarker) + ".partial";
  std::error_code error;
  fs::directory_iterator entries(folder, error);
  if (error == std::errc::no_such_file_or_directory) return true;
  if (error) throw DataError(folder, "cannot be looked into", "a folder for the simulation");
  return std::all_of(fs::begin(entries), fs::end(entries), [&](const fs::directory_entry& entry) {
    return entry.path().filename() == partial_marker;
  });
}

void claim_folder(const fs::path& out, const SimulatedOrigin& origin) {
  const fs::path marker = out / kSimulatedMarker;
  if (holds_nothing(out)) {
    write_file_atomic(marker, format_simulated_origin(origin));
    return;
  }
  const std::string way_out = "; choose another --out or remove it";
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
      "computed from it may stand beside those published for the real data set.\n\n"
      "Scene \"{}\" is in scene.json. To make the same files again:\n"
      "mosbench simulate --layout {} --scene scene.json --scans {} --seed {} --out DIR\n"
      "{}",
      origin.scene, to_string(origin.layout), origin.scans, origin.seed,
      origin.layout == DatasetKind::kDoals
          ? "Truth is by appearance as in DOALS: a person who stands still is listed as dynamic.\n"
          : "Truth is by speed: above 0.5 m/s is moving, for vehicles above 1.0 m/s.\n");
}

// Writes one sensor's folder. Scans may be written in any order by several threads.
class RecordingWriter {
 public:
  RecordingWriter(const SimulateOptions& options, const Scene& scene,
                  const SimulatedRecording& recording)
      : layout_(options.layout),
        folder_(options.out / recording.folder),
        simulator_(scene, sensor_model(recording.sensor), options.seed),
        labelled_(labelled_scans(options.layout, options.scans)),
        poses_(options.scans, Pose::Identity()),
        stamps_ns_(options.scans),
        indices_(options.scans) {}

  void write_scan(std::size_t scan_index) {
    const SimulatedScan scan = simulator_.scan(scan_index);
    poses_[scan_index] = scan.map_from_sensor;
    stamps_ns_[scan_index] = scan.stamp_ns;
    const std::string stem = fmt::format("{:06}", scan_index);
    const fs::path bin = folder_ / "velodyne" / (stem + ".bin");
    const bool labelled = labelled_.contains(scan_index);
    if (layout_ == DatasetKind::kDoals) {
      write_bin(bin, scan.points);
      if (labelled) indices_[scan_index] = {scan.stamp_ns, doals_dynamic_indices(scan)};
      return;
    }
    std::vector<Point> points;
    std::vector<std::uint32_t> labels;
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      if (scan.owners[i] == SimulatedScan::kNoReturn) continue;
      points.push_back(scan.points[i]);
      labels.push_back(layout_label(layout_, scan, i));
    }
    write_bin(bin, points);
    if (labelled) write_labels(folder_ / "labels" / (stem + ".label"), labels);
  }

  /// Everything that comes after the scans, the poses last.
  void finish() const {
    if (layout_ == DatasetKind::kDoals) {
      std::vector<IndicesRow> rows;
      for (const std::size_t scan_index : labelled_) rows.push_back(indices_[scan_index]);
      write_indices(folder_ / "indices.csv", rows);
      write_times(folder_ / "times.txt", stamps_ns_);
    } else {
      write_calib(folder_ / "calib.txt", camera_from_lidar(layout_));
    }
    if (layout_ == DatasetKind::kSemanticKitti) {
      write_times(folder_ / "times.txt", times_since_first_ns());
    }
    write_poses(folder_ / "poses.txt", stored_poses());
  }

 private:
  std::vector<std::int64_t> times_since_first_ns() const {
    std::vector<std::int64_t> times_ns = stamps_ns_;
    for (std::int64_t& time_ns : times_ns) time_ns -= stamps_ns_.front();
    return times_ns;
  }

  // HeLiMOS's poses stand in a global frame, those of the other sets begin at the identity.
  std::vector<Pose> stored_poses() const {
    if (layout_ == DatasetKind::kHelimos) return poses_;
    const Pose tr = camera_from_lidar(layout_);
    const Pose lidar_from_camera = inverse_of(tr);
    const Pose first_from_map = inverse_of(poses_.front());
    std::vector<Pose> stored;
    for (const Pose& pose : poses_) {
      stored.push_back(compose(compose(tr, compose(first_from_map, pose)), lidar_from_camera));
    }
    return stored;
  }

  DatasetKind layout_;
  fs::path folder_;
  Simulator simulator_;
  std::set<std::size_t> labelled_;
  std::vector<Pose> poses_;
  std::vector<std::int64_t> stamps_ns_;
  std::vector<IndicesRow> indices_;
};

// Calls work(0) to work(count - 1) from several threads and passes on the first exception.
void for_each_in_parallel(std::size_t count, unsigned threads,
                          const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next = 0;
  std::exception_ptr failure;
  std::mutex failure_mutex;
  const auto take_work = [&] {
    try {
      for (std::size_t i = next++; i < count; i = next++) work(i);
    } catch (...) {
      const std::lock_guard lock(failure_mutex);
      if (!failure) failure = std::current_exception();
      next = count;
    }
  };
  {
    std::vector<std::jthread> others;
    for (unsigned i = 1; i < threads; ++i) others.emplace_back(take_work);
    take_work();
  }
  if (failure) std::rethrow_exception(failure);
}

void write_splits(const SimulateOptions& options) {
  const SplitNumbers splits = helimos_splits(labelled_scans(options.layout, options.scans));
  const fs::path folder = options.out / helimos_folder();
  if (!splits.train.empty()) write_split(folder / "train.txt", splits.train);
  if (!splits.val.empty()) write_split(folder / "val.txt", splits.val);
  write_split(folder / "test.txt", splits.test);
}

void check(const SimulateOptions& options) {
  if (options.scans < 1 || options.scans > kMostScans) {
    throw UsageError(
        fmt::format("cannot simulate {} scans, expected 1 to {}", options.scans, kMostScans));
  }
  if (options.out.empty()) throw UsageError("no folder to write to, expected --out DIR");
}

}  // namespace

Scene load_scene(const std::string& name_or_file) {
  const bool is_file =
      name_or_file.ends_with(".json") || name_or_file.find('/') != std::string::npos;
  return is_file ? read_scene(name_or_file) : built_in_scene(name_or_file);
}

void simulate(const SimulateOptions& options,
              const std::function<void(std::size_t done, std::size_t total)>& progress) {
  check(options);
  const Scene scene = load_scene(options.scene);
  const SimulatedOrigin origin = origin_of(options, scene);
  std::vector<RecordingWriter> writers;
  for (const SimulatedRecording& recording : recordings_of(options.layout, scene)) {
    writers.emplace_back(options, scene, recording);
  }
  claim_folder(options.out, origin);
  write_file_atomic(options.out / "README.txt", readme(origin));
  write_file_atomic(options.out / "scene.json", format_scene(scene));

  const std::size_t total = writers.size() * options.scans;
  std::size_t done = 0;
  std::mutex progress_mutex;
  const unsigned threads = options.threads > 0 ? options.threads : hardware_threads();
  for_each_in_parallel(total, threads, [&](std::size_t i) {
    writers[i / options.scans].write_scan(i % options.scans);
    if (!progress) return;
    const std::lock_guard lock(progress_mutex);
    progress(++done, total);
  });
  if (options.layout == DatasetKind::kHelimos) write_splits(options);
  for (const RecordingWriter& writer : writers) writer.finish();
}

}  // namespace mosbench
