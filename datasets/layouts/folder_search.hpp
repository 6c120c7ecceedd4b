#pragma once

#include <filesystem>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/layouts/dataset.hpp"

namespace mosbench {

/// Returns the path from the root, without "." and ".." and a slash at the end.
std::filesystem::path without_slash(const std::filesystem::path& path);

/// Returns the last name of a path, also of "." and of one that ends with a slash.
std::string folder_name(const std::filesystem::path& path);

/// Whether a path is a file that is named as a scan.
bool is_scan(const std::filesystem::path& path);

/// Whether a folder holds that of the first of the LiDARs that were asked for.
bool holds_lidars(const std::filesystem::path& folder, const Reading& asked);
/// Returns the names of folders with scans, as `lidars` takes them; nothing where there is none.
std::string lidar_folders(const std::filesystem::path& path);

/// Returns the folder that a sequence folder is in.
std::filesystem::path parent_folder(const std::filesystem::path& path);

/// Returns the first name in the whole path that contains one of `words` in any case, or nothing.
/// `words` are in lower case.
std::optional<std::string> folder_with_word(const std::filesystem::path& path,
                                            std::initializer_list<const char*> words);

/// Returns whether the names at the end of a path are those of `end`.
bool ends_with(const std::filesystem::path& path, const std::filesystem::path& end);

/// Lists the folders that hold `mark`: `path` itself, else those below it or below its sequences/.
std::vector<SequenceFolder> list_with(const std::filesystem::path& path,
                                      const std::filesystem::path& mark);

/// Lists sequences in SemanticKITTI's folders. A numbered folder without scans is listed too, so
/// that opening it says what it lacks.
std::vector<SequenceFolder> list_kitti(const std::filesystem::path& path);

bool any_holds(const std::vector<SequenceFolder>& sequences, const char* file);

/// Returns the splits of these names that hold whole sequences, if any of those that are there.
std::vector<Split> splits_of_sequences(
    const std::vector<std::string_view>& names, const std::vector<SequenceFolder>& folders,
    const std::function<bool(std::string_view split, const SequenceFolder& folder)>& holds);

/// Returns the label ids of semantic-kitti-mos.yaml.
std::set<std::uint32_t> semantickitti_label_ids();

/// Returns why a recording has no times of points in a column: it is a bag, or one scan; empty for
/// the folder of scans.
std::string recording_without_times(const std::filesystem::path& recording);

/// Opens a KittiSequence with the default places of its files.
std::unique_ptr<Sequence> open_kitti(const SequenceFolder& sequence, const Reading& asked);

/// Returns sequences/NAME, with "_" for each slash in the name.
std::filesystem::path kitti_folder(const std::string& name, std::size_t position);

/// Returns `name` with "_" for each slash.
std::string flat_name(std::string name);
/// Returns the same as folder of a sequence.
std::filesystem::path flat_folder(const std::string& name, std::size_t position);

}  // namespace mosbench
