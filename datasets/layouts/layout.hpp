#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/layouts/dataset.hpp"
#include "datasets/layouts/sequence_writer.hpp"
#include "datasets/layouts/simulation.hpp"

namespace mosbench {

/// What shows that a path is a data set, the surest first.
enum class Evidence : std::uint8_t {
  kFolders,  ///< files or folders that no other data set has
  kName,     ///< a word in the path
  kNone      ///< that it can be read, and is no other data set
};

/// Number of scans that the authors of a data set publish for one of its sequences.
struct PublishedCount {
  std::string folder;  ///< the end of the sequence folder's path: "08", "station/sequence_1"
  std::size_t scans = 0;
  std::size_t points = 0;  ///< in every scan; 0 where that varies
};

/// What the files of a data set hold, for the doctor.
struct LayoutContent {
  std::set<std::uint32_t> label_ids = {};  ///< that the truth may hold; empty: any
  double sensor_range_m = 0.0;             ///< farthest return
  /// Labelled points have this range, others id 0; no limits when both are equal.
  double label_min_m = 0.0, label_max_m = 0.0;
  std::vector<PublishedCount> published = {};
};

/// How much truth the layout can store per point: its id; whether it moves; that in a camera's view
/// only, and whether it is labelled; nothing.
enum class KeptTruth : std::uint8_t { kId, kMoving, kInView, kNone };

/// How a data set is written by `simulate` and `convert`.
struct LayoutWriter {
  std::unique_ptr<SequenceWriter> (*open)(const std::filesystem::path& folder,
                                          const WriteOptions& options);
  /// Returns the folder of a sequence below the root, or the one file that holds all of it;
  /// `position` is its place in the source, from 0.
  std::filesystem::path (*folder)(const std::string& name, std::size_t position);
  /// Returns the files that may be written of a sequence, named from its folder.
  std::vector<std::filesystem::path> (*files)(const Sequence& sequence);
  /// Returns the file in a sequence's folder that appears when all of it is on the disk; empty
  /// where the folder is that file.
  const char* (*last_file)(const WriteOptions& options) = last_file_of;
  KeptTruth keeps = KeptTruth::kId;
  bool keeps_radial_velocities = false;
  bool keeps_stamps = true;
  /// Writes which scans are of which split; null for a layout without such files.
  void (*write_splits)(const std::filesystem::path& root, const SplitNumbers& splits) = nullptr;
};

/// Returns the folder that a sequence's mark is written to; nothing where one file holds all of the
/// sequence and its mark. `place` is what LayoutWriter::folder returns.
std::optional<std::filesystem::path> mark_folder_of(const LayoutWriter& writer,
                                                    const std::filesystem::path& place);

/// The preset and the protocol that a data set is run and scored with unless the user says others.
/// A row without them does not compile.
struct UsualRule {
  std::string_view preset, protocol;
  constexpr UsualRule(std::string_view preset_name, std::string_view protocol_name)
      : preset(preset_name), protocol(protocol_name) {}
};

/// A data set that comes in the folders of another.
struct RelatedSet {
  std::string_view title, content;
  std::string_view published;  ///< where its authors publish it
  std::string_view reading;    ///< what to give mosbench for its rules
};

/// A split that consists of whole sequences.
struct NamedSplit {
  const char* name;
  std::vector<std::string> sequences;
};

/// All facts about one data set. Adding one: a file with its row, named in layouts.cpp.
struct Layout {
  std::string_view name;  ///< in --dataset, presets and results
  UsualRule usual;

  // What users have to know to get it and to arrange its folders.
  std::string_view title;
  std::string_view content;
  std::string_view size;
  std::string_view published;  ///< where its authors publish it
  std::string_view licence;
  std::vector<std::string_view> folders;  ///< lines of a listing, the first is the root

  LayoutContent files;
  std::string_view expected;  ///< what an error says was expected at a path

  /// Lists the sequences below a root, or the one of a sequence folder; empty when `path` is
  /// neither.
  std::vector<SequenceFolder> (*list)(const std::filesystem::path& path);
  std::unique_ptr<Sequence> (*open)(const SequenceFolder& sequence, const Reading& options);
  /// Returns why the points of a sequence have no times in a column or field, and what is expected
  /// instead; empty where they may have. Null where they may always.
  std::string (*no_point_times)(const std::filesystem::path& sequence) = nullptr;
  std::string_view only_own_poses = {};  ///< why poses of the user are refused; empty: they are not
  std::vector<NamedSplit> named_splits = {};
  /// Returns other splits of opened sequences; `folders` runs parallel to `sequences`. May add
  /// remarks. Null for a data set without.
  std::vector<Split> (*splits)(const std::vector<SequenceFolder>& folders,
                               const std::vector<std::unique_ptr<Sequence>>& sequences,
                               std::vector<std::string>& remarks) = nullptr;
  Evidence evidence;
  /// Returns why `path` looks like this data set, or nothing if it does not.
  std::optional<std::string> (*recognise)(const std::filesystem::path& path);
  /// The same of a data set that lacks files or has damaged ones, which opening it names; asked
  /// where nothing that can be read is there. Null where there is no such.
  std::optional<std::string> (*recognise_part)(const std::filesystem::path& path) = nullptr;
  int scan_folders = 1;                     ///< from the sequence's folder down to its scan files
  std::optional<LayoutWriter> writer = {};  ///< nothing for a data set that is only read
  bool truth_by_speed = false;              ///< Reading::moving_speed_m_s is for it
  std::vector<RelatedSet> related = {};     ///< that the same reader reads
  std::optional<LayoutSimulation> simulation = {};  ///< with a writer; nothing: is not simulated

  DatasetKind kind() const { return {name}; }
};

/// Returns all rows, in the order in which they are listed.
std::span<const Layout* const> layouts();
const Layout& layout_of(DatasetKind kind);

/// Returns what to tell who writes scans with stamps into a layout without.
std::string lost_stamps_text(std::size_t scans, const Layout& layout);

inline constexpr std::string_view kUnknownLicence =
    "not known to mosbench, see where it is published";

}  // namespace mosbench
