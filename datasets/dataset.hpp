#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/sequence.hpp"

namespace mosbench {

enum class DatasetKind { kDoals, kSipailou, kHelimos, kSemanticKitti };

std::string_view to_string(DatasetKind kind);
/// Nothing when the name is not one of doals, sipailou, helimos, semantickitti.
std::optional<DatasetKind> dataset_kind_from_string(std::string_view name);

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
  std::vector<std::string> remarks;                  ///< what was assumed about the whole
};

struct OpenOptions {
  /// Recognised from the folders when not given.
  std::optional<DatasetKind> kind = std::nullopt;
  /// Names to keep; all when empty. DOALS takes the numbers 1 to 8 of the published ones as well.
  std::vector<std::string> sequences = {};
  /// Replaces the sequence's own poses.txt, in the same frame: calib.txt is applied to it too.
  std::optional<std::filesystem::path> poses = std::nullopt;
};

/// Opens a data set's root or one sequence folder, and of it only the sequences kept. A kind that
/// is not given is recognised, in this order: folders named after HeLiMOS's sensors; indices.csv or
/// sequence_N folders (doals); "sipailou" in a folder name of the path; else semantickitti. A
/// remark says so. Throws DataError when nothing usable is there, UsageError for a sequence name
/// that does not exist or a pose file given for several sequences.
Dataset open_dataset(const std::filesystem::path& path, const OpenOptions& options);

}  // namespace mosbench
