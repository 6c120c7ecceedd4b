#pragma once

#include <compare>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/sequence/replaced_poses.hpp"
#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// A data set by its name in options, presets and results. Those that the program or its tests ask
/// for have constants; any row of `layouts()` is one.
struct DatasetKind {
  std::string_view name;

  auto operator<=>(const DatasetKind&) const = default;

  static const DatasetKind kDoals, kSipailou, kHelimos, kSemanticKitti, kApollo, kMoe, kKth,
      kMdetector, kOpenSceneFlow, kNuscenes, kHelipr, kKittiRaw, kKittiTracking;
  static const DatasetKind kRecording;  ///< a bag, a scan, or a folder of either
};

inline constexpr DatasetKind DatasetKind::kDoals{"doals"}, DatasetKind::kSipailou{"sipailou"},
    DatasetKind::kHelimos{"helimos"}, DatasetKind::kSemanticKitti{"semantickitti"},
    DatasetKind::kApollo{"apollo"}, DatasetKind::kMoe{"moe"}, DatasetKind::kKth{"kth"},
    DatasetKind::kMdetector{"mdetector"}, DatasetKind::kOpenSceneFlow{"opensceneflow"},
    DatasetKind::kNuscenes{"nuscenes"}, DatasetKind::kHelipr{"helipr"},
    DatasetKind::kKittiRaw{"kitti-raw"}, DatasetKind::kKittiTracking{"kitti-tracking"},
    DatasetKind::kRecording{"recording"};

inline std::string_view to_string(DatasetKind kind) { return kind.name; }
/// Returns nothing when the name is not one of `dataset_kind_names()`.
std::optional<DatasetKind> dataset_kind_from_string(std::string_view name);
/// Returns "doals, sipailou, ...".
std::string dataset_kind_names();

/// Part of a sequence: the scans with these stems, or all of them.
struct SplitPart {
  std::size_t sequence = 0;  ///< position in Dataset::sequences
  std::optional<std::set<std::string>> stems;
};

/// Scans that a published number is computed over: Sipailou "test" is sequences 00 and 07, HeLiMOS
/// "test" the stems of test.txt in each sensor, DOALS "ST" both station sequences.
struct Split {
  std::string name;
  std::vector<SplitPart> parts;
};

struct Dataset {
  DatasetKind kind = DatasetKind::kSemanticKitti;
  std::filesystem::path root;
  std::vector<std::unique_ptr<Sequence>> sequences;  ///< in the data set's own order
  std::vector<Split> splits;                         ///< only those with at least one scan here
  std::vector<std::string> remarks;                  ///< what was assumed about the whole data set
};

struct OpenOptions {
  /// Recognised from the folders when not given.
  std::optional<DatasetKind> kind = std::nullopt;
  /// Names to keep; all when empty. The published sequences of DOALS have the numbers 1 to 8, too.
  std::vector<std::string> sequences = {};
  Reading reading = {};
};

/// A sequence found on disk and not yet opened.
struct SequenceFolder {
  std::string name;  ///< Sequence::name
  std::filesystem::path folder;
  std::string alias;  ///< a second name for --sequences; may be empty
};

/// Lists the sequences that `open_dataset` would open, in its order, without opening them; sets
/// `kind` to what it would recognise. Throws as it does for folders that cannot be listed.
std::vector<SequenceFolder> find_sequences(const std::filesystem::path& path,
                                           const OpenOptions& options,
                                           std::optional<DatasetKind>& kind);

/// Opens a data set's root, one sequence folder, a bag or a scan, and of it only the sequences
/// kept. A kind that is not given is recognised, in this order: indices.csv or sequence_N folders
/// (doals); folders named after HeLiMOS's sensors; velodyne_poses_kitti.txt (apollo); .h5 files
/// (opensceneflow); pcd/ next to gt_poses.txt (moe) or gt_cloud.pcd (kth); tables of
/// v1.0-* (nuscenes); LiDAR/ with its sensors (helipr); velodyne_points/data (kitti-raw);
/// velodyne/NNNN with scans (kitti-tracking); "sipailou" or "M-detector" in a
/// folder name of the path; folders as those of semantickitti; any bags or scans (recording);
/// part of the files of kitti-tracking, nuscenes, opensceneflow or semantickitti, where opening
/// says what is missing. A remark says so. Throws DataError when nothing usable is there,
/// UsageError for a sequence name that does not exist or a pose file given for several sequences.
/// For poses in a folder each sequence takes NAME.txt, NAME.tum or NAME/poses.txt.
/// `refined` is called for each scan while poses are refined.
Dataset open_dataset(const std::filesystem::path& path, const OpenOptions& options,
                     const ScanCount& refined = {});

}  // namespace mosbench
