#include "datasets/layouts/folder_search.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "datasets/disk/files.hpp"
#include "datasets/disk/folder_listing.hpp"
#include "datasets/formats/scan_file.hpp"
#include "datasets/layouts/kitti_sequence.hpp"
#include "datasets/rosbag/bag_reader.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {

std::filesystem::path without_slash(const std::filesystem::path& path) {
  const auto normal = std::filesystem::absolute(path).lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

std::string folder_name(const std::filesystem::path& path) {
  return without_slash(path).filename().string();
}

bool is_scan(const std::filesystem::path& path) {
  std::error_code ignored;
  return is_named_as_scan(path) && std::filesystem::is_regular_file(path, ignored);
}

std::filesystem::path parent_folder(const std::filesystem::path& path) {
  return without_slash(path).parent_path();
}

std::optional<std::string> folder_with_word(const std::filesystem::path& path,
                                            std::initializer_list<const char*> words) {
  for (const auto& part : std::filesystem::absolute(path).lexically_normal()) {
    const std::string name = lower_case(part.string());
    for (const char* word : words) {
      if (name.find(word) != std::string::npos) return part.string();
    }
  }
  return std::nullopt;
}

bool ends_with(const std::filesystem::path& path, const std::filesystem::path& end) {
  const std::filesystem::path whole = without_slash(path);
  const auto names = std::distance(whole.begin(), whole.end());
  const auto wanted = std::distance(end.begin(), end.end());
  return wanted <= names &&
         std::equal(end.begin(), end.end(), std::next(whole.begin(), names - wanted));
}

std::vector<SequenceFolder> list_with(const std::filesystem::path& path,
                                      const std::filesystem::path& mark) {
  if (is_there(path / mark)) return {{folder_name(path), path, ""}};
  const auto below = path / "sequences";
  std::vector<SequenceFolder> sequences;
  for (const auto& folder : list_folders(std::filesystem::is_directory(below) ? below : path)) {
    if (is_there(folder / mark)) sequences.push_back({folder.filename().string(), folder, ""});
  }
  return sequences;
}

std::vector<SequenceFolder> list_kitti(const std::filesystem::path& path) {
  if (scan_folder_of(path)) return {{folder_name(path), path, ""}};
  const auto below = path / "sequences";
  std::vector<SequenceFolder> sequences;
  for (const auto& folder : list_folders(std::filesystem::is_directory(below) ? below : path)) {
    const std::string name = folder.filename().string();
    if (scan_folder_of(folder) || stem_number(name)) sequences.push_back({name, folder, ""});
  }
  return sequences;
}

bool any_holds(const std::vector<SequenceFolder>& sequences, const char* file) {
  return std::ranges::any_of(sequences, [file](const SequenceFolder& sequence) {
    return is_there(sequence.folder / file);
  });
}

bool holds_lidars(const std::filesystem::path& folder, const Reading& asked) {
  if (!asked.lidars) return false;
  const std::string first = lidar_names(asked).front();
  // A topic is no folder, though one of its name may be at the root of the disk.
  return !first.starts_with('/') && std::filesystem::is_directory(folder / first);
}

std::string lidar_folders(const std::filesystem::path& path) {
  constexpr std::size_t kMostLidars = 6;
  std::vector<std::string> names;
  if (!std::filesystem::is_directory(path)) return "";
  for (const std::filesystem::path& folder : list_folders(path)) {
    if (!scans_in(folder).empty()) names.push_back(folder_name(folder));
  }
  return names.size() > kMostLidars ? "" : fmt::format("{}", fmt::join(names, ","));
}

std::string recording_without_times(const std::filesystem::path& recording) {
  if (is_scan(recording)) {
    return recording.string() + " is one scan, expected several to find a motion from";
  }
  const bool is_bag = is_bag_file(recording) || is_bag_folder(recording);
  if (!is_bag && scan_folder_of(recording)) return "";
  const auto bags =
      is_bag ? std::vector<StemFile>{{recording, ""}} : list_by_stem(recording, {".bag"});
  return bags.empty() ? "" : bags.front().file.string() + " is a bag, expected .bin files";
}

std::unique_ptr<Sequence> open_kitti(const SequenceFolder& sequence, const Reading& asked) {
  return std::make_unique<KittiSequence>(sequence.name, sequence.folder, asked);
}

std::set<std::uint32_t> semantickitti_label_ids() {
  return {0,  1,  9,  10, 11, 13, 15, 16, 18, 20,  30,  31,  32,  40,  44,  48,  49,  50,
          51, 52, 60, 70, 71, 72, 80, 81, 99, 251, 252, 253, 254, 255, 256, 257, 258, 259};
}

std::string flat_name(std::string name) {
  std::ranges::replace(name, '/', '_');
  return name;
}

std::filesystem::path flat_folder(const std::string& name, std::size_t) { return flat_name(name); }

std::filesystem::path kitti_folder(const std::string& name, std::size_t) {
  return std::filesystem::path("sequences") / flat_name(name);
}

std::vector<Split> splits_of_sequences(
    const std::vector<std::string_view>& names, const std::vector<SequenceFolder>& folders,
    const std::function<bool(std::string_view split, const SequenceFolder& folder)>& holds) {
  std::vector<Split> splits;
  for (const std::string_view name : names) {
    Split split{std::string(name), {}};
    for (std::size_t i = 0; i < folders.size(); ++i) {
      if (holds(name, folders[i])) split.parts.push_back({i, std::nullopt});
    }
    if (!split.parts.empty()) splits.push_back(std::move(split));
  }
  return splits;
}

}  // namespace mosbench
