#include "eval/trajectory/pose_paths.hpp"

#include <map>

#include "datasets/disk/files.hpp"
#include "datasets/layouts/dataset.hpp"
#include "datasets/rosbag/open_bag.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExpected =
    "a data set, a folder of mosbench run --odometry, or files .txt, .csv or .tum";

PosePath path_of_file(std::string name, const fs::path& file, std::optional<PoseFormat> format) {
  PosePath path{std::move(name), file, false, read_pose_list(file, format)};
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

using NamedFiles = std::map<std::string, fs::path>;

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

bool do_increase(const std::vector<std::int64_t>& stamps_ns) {
  for (std::size_t k = 1; k < stamps_ns.size(); ++k) {
    if (stamps_ns[k] <= stamps_ns[k - 1]) return false;
  }
  return true;
}

PosePath path_of_sequence(const Sequence& sequence, const fs::path& root) {
  PosePath path{sequence.name(), root, true, {}};
  for (std::size_t k = 0; k < sequence.size(); ++k) {
    path.list.poses.push_back(sequence.map_from_sensor(k));
    if (const auto stamp_ns = sequence.stamp_ns(k)) path.list.stamps_ns.push_back(*stamp_ns);
  }
  std::vector<std::int64_t>& stamps_ns = path.list.stamps_ns;
  if (stamps_ns.size() != sequence.size() || !do_increase(stamps_ns)) stamps_ns.clear();
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

}  // namespace

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

}  // namespace mosbench
