#include "eval/trajectory/trajectory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "datasets/disk/files.hpp"
#include "datasets/layouts/dataset.hpp"
#include "datasets/rosbag/bag_reader.hpp"
#include "datasets/sequence/pose_mark.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/result/result_file.hpp"
#include "eval/trajectory/pose_errors.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

using NamedFiles = std::map<std::string, fs::path>;

/// The poses of one sequence, map_from_sensor.
struct PosePath {
  std::string name;             ///< of the sequence, or the file's without extension
  std::filesystem::path place;  ///< the file, or the data set
  bool of_data_set = false;     ///< in the lidar's frame then, whatever its files hold
  PoseMark mark;                ///< also of the scans that the poses are of
  PoseList list;                ///< stamps also where those of the data set's scans increase
};

constexpr const char* kExpected =
    "a data set, a folder of mosbench run --odometry, or files .txt, .csv or .tum";

/// The mark of poses; of those beside an older run that found them, the mark of its data.
PoseMark mark_of_path(const fs::path& file) {
  PoseMark mark = mark_of_poses(file);
  const fs::path result = file.parent_path() / "result.json";
  try {
    if (!mark.simulated && is_there(result)) {
      PoseMark of_data = pose_mark_of(mark_of(read_result(result)));
      mark.simulated = std::move(of_data.simulated);
      if (mark.doubts.empty()) mark.doubts = std::move(of_data.doubts);
    }
  } catch (const DataError&) {  // of another program
  }
  return mark;
}

PosePath path_of_file(std::string name, const fs::path& file, std::optional<PoseFormat> format) {
  PosePath path{std::move(name), file, false, mark_of_path(file), read_pose_list(file, format)};
  if (path.list.poses.empty()) throw DataError(file, "holds no pose", "one row per scan");
  if (path.list.format == PoseFormat::kRollout) {
    for (Pose& pose : path.list.poses) pose = pose.inverse();
  }
  return path;
}

bool holds_poses(const fs::path& file) {
  const fs::path extension = file.extension();
  return extension == ".txt" || extension == ".csv" || extension == ".tum";
}

void add_file(std::string name, const fs::path& file, NamedFiles& files) {
  if (files.emplace(std::move(name), file).second) return;
  throw DataError(file, "another file has the same name but for its extension",
                  "one file of poses per sequence");
}

/// The poses that odometry found for runs, by the names of their sequences.
NamedFiles files_of_runs(const fs::path& folder) {
  NamedFiles files;
  const auto add = [&](const fs::path& run) {
    const fs::path poses = run / "poses.txt";
    if (!is_there(run / "result.json") || !is_there(poses)) return;
    const fs::path name =
        run == folder ? fs::absolute(run / "").parent_path().filename() : fs::relative(run, folder);
    add_file(name.string(), poses, files);
  };
  add(folder);
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_directory()) add(entry.path());
  }
  return files;
}

NamedFiles files_below(const fs::path& folder) {
  NamedFiles files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file() || !holds_poses(entry.path())) continue;
    add_file(fs::relative(entry.path(), folder).replace_extension().string(), entry.path(), files);
  }
  return files;
}

bool is_data_set(const fs::path& folder) {
  try {
    std::optional<DatasetKind> kind;
    return !find_sequences(folder, {}, kind).empty();
  } catch (const DataError&) {
    return false;
  }
}

PosePath path_of_sequence(const Sequence& sequence, const fs::path& root) {
  PosePath path{sequence.name(), root, true, pose_mark_of(mark_as_read(sequence)), {}};
  std::ranges::copy(sequence.recording().doubts, std::back_inserter(path.mark.doubts));
  for (std::size_t k = 0; k < sequence.size(); ++k) {
    path.list.poses.push_back(sequence.map_from_sensor(k));
    if (const auto stamp_ns = sequence.stamp_ns(k)) path.list.stamps_ns.push_back(*stamp_ns);
  }
  std::vector<std::int64_t>& stamps_ns = path.list.stamps_ns;
  const auto fall = std::ranges::adjacent_find(stamps_ns, std::ranges::greater_equal());
  if (stamps_ns.size() != sequence.size() || fall != stamps_ns.end()) stamps_ns.clear();
  return path;
}

std::vector<PosePath> paths_of_data_set(const fs::path& root) {
  std::vector<PosePath> paths;
  const Dataset dataset = open_dataset(root, {});
  for (const auto& sequence : dataset.sequences) {
    paths.push_back(path_of_sequence(*sequence, root));
  }
  return paths;
}

/// Reads the poses of a file; of a folder of `mosbench run --odometry`, which has poses.txt beside
/// the results; of a data set's sequences; or of all files .txt, .csv and .tum in and below another
/// folder. They are ordered by name, or as the data set orders its sequences. Poses of Dynablox's
/// rollouts are inverted. Throws DataError if there are none, and for two files of one name.
std::vector<PosePath> read_pose_paths(const fs::path& path, std::optional<PoseFormat> format) {
  if (is_bag_file(path)) return paths_of_data_set(path);
  if (!fs::is_directory(path)) return {path_of_file(path.stem().string(), path, format)};
  NamedFiles files = files_of_runs(path);
  if (files.empty() && is_data_set(path)) return paths_of_data_set(path);
  if (files.empty()) files = files_below(path);
  if (files.empty()) throw DataError(path, "holds no poses", kExpected);
  std::vector<PosePath> paths;
  for (const auto& [name, file] : files) paths.push_back(path_of_file(name, file, format));
  return paths;
}

std::vector<Pose> turned(std::vector<Pose> poses, const Pose& other_from_own) {
  const Pose own_from_other = other_from_own.inverse();
  for (Pose& pose : poses) pose = other_from_own * pose * own_from_other;
  return poses;
}

std::size_t nearest_stamp(const std::vector<std::int64_t>& stamps_ns, std::int64_t stamp_ns) {
  const auto behind = std::ranges::lower_bound(stamps_ns, stamp_ns);
  const auto i = static_cast<std::size_t>(behind - stamps_ns.begin());
  if (i == stamps_ns.size()) return i - 1;
  return i > 0 && stamp_ns - stamps_ns[i - 1] <= stamps_ns[i] - stamp_ns ? i - 1 : i;
}

void pair_by_time(const PoseList& estimate, const PoseList& truth,
                  const std::filesystem::path& file, double max_difference_s,
                  TrajectoryPair& pair) {
  const bool estimate_shorter = estimate.poses.size() <= truth.poses.size();
  const PoseList& shorter = estimate_shorter ? estimate : truth;
  const PoseList& longer = estimate_shorter ? truth : estimate;
  for (std::size_t i = 0; i < shorter.poses.size(); ++i) {
    const std::int64_t stamp_ns = shorter.stamps_ns[i];
    const std::size_t j = nearest_stamp(longer.stamps_ns, stamp_ns);
    const double apart_s = std::abs(static_cast<double>(longer.stamps_ns[j] - stamp_ns)) * 1e-9;
    if (apart_s > max_difference_s) continue;
    pair.estimate.push_back(estimate.poses[estimate_shorter ? i : j]);
    pair.truth.push_back(truth.poses[estimate_shorter ? j : i]);
  }
  if (pair.estimate.empty()) {
    throw DataError(file, "has no stamp near one of the truth",
                    fmt::format("stamps at most {} s apart", max_difference_s));
  }
  pair.remarks.push_back(fmt::format("{} of {} estimated and {} true poses are paired by stamps",
                                     pair.estimate.size(), estimate.poses.size(),
                                     truth.poses.size()));
}

void check_camera(const PosePath& path, bool is_camera, const char* flag) {
  if (!is_camera || !path.of_data_set) return;
  throw UsageError(fmt::format(
      "--camera {}: the poses of {} are read as the lidar's, expected this of files only", flag,
      path.place.string()));
}

TrajectoryPair paired(PosePath estimate, PosePath truth, const TrajectoryOptions& options) {
  check_camera(estimate, options.camera == CameraFrame::kEstimate, "estimate");
  check_camera(truth, options.camera == CameraFrame::kTruth, "truth");
  TrajectoryPair pair{.name = estimate.name, .estimate = {}, .truth = {}, .remarks = {}};
  for (const PosePath* path : {&estimate, &truth}) {
    pair.marks.push_back({path->place.string(), path->mark});
    for (std::string& remark : path->list.remarks(path->place)) {
      pair.remarks.push_back(std::move(remark));
    }
  }
  if (!estimate.list.stamps_ns.empty() && !truth.list.stamps_ns.empty()) {
    pair_by_time(estimate.list, truth.list, estimate.place, options.max_time_difference_s, pair);
  } else if (estimate.list.poses.size() != truth.list.poses.size()) {
    throw DataError(estimate.place, "holds " + counted(estimate.list.poses.size(), "pose"),
                    fmt::format("{} as in {}, or stamps in both as in .tum files",
                                truth.list.poses.size(), truth.place.string()));
  } else {
    pair.estimate = std::move(estimate.list.poses);
    pair.truth = std::move(truth.list.poses);
    pair.remarks.emplace_back("poses are paired row by row");
  }
  if (options.camera == CameraFrame::kEstimate) {
    pair.truth = turned(std::move(pair.truth), *options.camera_from_lidar);
  }
  if (options.camera == CameraFrame::kTruth) {
    pair.estimate = turned(std::move(pair.estimate), *options.camera_from_lidar);
  }
  if (auto remark = frame_remark(pair, options)) pair.remarks.push_back(std::move(*remark));
  return pair;
}

// Axes that are mistaken for others make errors as large as the motion.
constexpr double kFarBetter = 3.0;
constexpr double kLeastError_m = 0.01;

Pose kitti_camera_from_lidar() {
  Pose pose = Pose::Identity();
  pose.linear() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  return pose;
}

double mean_motion_error_m(const TrajectoryPair& pair, const std::vector<Pose>& estimate) {
  const auto summary = summary_of(relative_errors(pair.truth, estimate, {}).translation_m);
  return summary ? summary->mean : 0;
}

}  // namespace

std::vector<double> path_lengths_m(const std::vector<Pose>& poses) {
  std::vector<double> lengths_m(poses.size(), 0.0);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    lengths_m[i] = lengths_m[i - 1] + (poses[i].translation() - poses[i - 1].translation()).norm();
  }
  return lengths_m;
}

std::vector<TrajectoryPair> read_trajectory_pairs(const std::filesystem::path& estimates,
                                                  const std::filesystem::path& truths,
                                                  const TrajectoryOptions& options) {
  std::vector<PosePath> estimated = read_pose_paths(estimates, options.format);
  std::vector<PosePath> known = read_pose_paths(truths, options.format);
  if (estimated.size() == 1 && known.size() == 1) {
    return {paired(std::move(estimated.front()), std::move(known.front()), options)};
  }
  std::vector<TrajectoryPair> pairs;
  for (PosePath& estimate : estimated) {
    const auto truth = std::ranges::find(known, estimate.name, &PosePath::name);
    if (truth == known.end()) {
      throw DataError(
          estimate.place,
          fmt::format("\"{}\" has no truth of its name in {}", estimate.name, truths.string()),
          "poses of the same name there");
    }
    pairs.push_back(paired(std::move(estimate), std::move(*truth), options));
  }
  return pairs;
}

std::optional<std::string> frame_remark(const TrajectoryPair& pair,
                                        const TrajectoryOptions& options) {
  const double as_given_m = mean_motion_error_m(pair, pair.estimate);
  if (!(as_given_m > kLeastError_m)) return std::nullopt;
  const Pose camera_from_lidar = options.camera_from_lidar.value_or(kitti_camera_from_lidar());
  const bool given = options.camera != CameraFrame::kNeither;
  const auto better = [&](const Pose& turn, const char* what) -> std::optional<std::string> {
    const double error_m = mean_motion_error_m(pair, turned(pair.estimate, turn));
    if (!(kFarBetter * error_m < as_given_m)) return std::nullopt;
    return fmt::format("motions from pose to pose are {:.3f} m off, and {:.3f} m {}", as_given_m,
                       error_m, what);
  };
  const char* undo = "without --camera";
  if (auto remark = better(camera_from_lidar,
                           given ? undo : "if the truth is the camera's: --camera truth:CALIB")) {
    return remark;
  }
  return better(camera_from_lidar.inverse(),
                given ? undo : "if the estimate is the camera's: --camera estimate:CALIB");
}

}  // namespace mosbench
