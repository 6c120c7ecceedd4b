#pragma once

#include <filesystem>
#include <mosbench/method.hpp>
#include <string>
#include <vector>

#include "datasets/sequence/sequence.hpp"
#include "eval/protocols/protocol.hpp"
#include "eval/result/result.hpp"
#include "eval/store/result_folder.hpp"

namespace mosbench {

/// How every sequence of one `mosbench run` is segmented and scored.
struct RunSettings {
  const MethodKind* method = nullptr;
  Settings method_settings;
  const Protocol* protocol = nullptr;
  RangeGate range;
  unsigned threads = 1;
  bool keeps_labels = true;        ///< writes a file per scan
  bool keeps_scores = false;       ///< also writes every point's score
  bool is_one_of_several = false;  ///< progress then names the method

  /// Reasons come with the scores of a method that gives some.
  PointFiles point_files() const { return {keeps_scores, keeps_scores && method->gives_reasons}; }
};

/// Returns what messages call a run over a sequence: its name, and with `is_one_of_several` also
/// the method's.
std::string title_of(const Sequence& sequence, const RunSettings& settings);

/// Returns the conditions under which the method of `settings` runs on a sequence.
RunContext context_of(const Sequence& sequence, const RunSettings& settings);

/// Segments a sequence and scores the scans with truth. Where there is a folder, writes
/// `folder`/labels/<stem>.label for every scan, also what `point_files` asks for. With more than
/// one thread the next scan is read and observed and the last one scored and written while a scan
/// enters the map; what a whole run writes and which error is thrown do not depend on it. Holds up
/// to three scans at a time, and the truth of those whose labels are still delayed. Throws
/// DataError.
Result run_sequence(const Sequence& sequence, const RunSettings& settings,
                    const std::optional<std::filesystem::path>& folder);

/// Pushes one scan of `sequence`. Throws DataError naming the scan's file, or where it has none of
/// its own the scan, for points and poses beyond the voxel grid.
std::vector<LabelledScan> push_scan(Method& method, const Sequence& sequence,
                                    std::size_t scan_index, const Frame& frame);

}  // namespace mosbench
