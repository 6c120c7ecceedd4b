#pragma once

#include <filesystem>
#include <vector>

#include "core/hmm_mos/config.hpp"
#include "core/hmm_mos/pipeline.hpp"
#include "datasets/sequence/sequence.hpp"
#include "eval/protocols/protocol.hpp"
#include "eval/results/result_file.hpp"

namespace mosbench {

/// How every sequence of one `mosbench run` is segmented and scored.
struct RunSettings {
  Config config;
  Variant variant = Variant::kPaper2024;
  const Protocol* protocol = nullptr;
  RangeGate range;
  unsigned threads = 1;
  bool keeps_scores = false;  ///< also writes every point's dynamic score
};

/// Segments a sequence, writes `folder`/labels/<stem>.label for every scan, with `keeps_scores`
/// also `folder`/scores/<stem>.score, and scores the scans with truth. With more than one thread
/// the next scan is read and observed and the last one scored and written while a scan enters the
/// map; what a whole run writes and which error is thrown do not depend on it. Holds up to three
/// scans at a time, and the truth of those whose labels are still delayed. Throws DataError.
SequenceRows run_sequence(const Sequence& sequence, const RunSettings& settings,
                          const std::filesystem::path& folder);

/// Pushes one scan of `sequence`. Throws DataError naming the scan's file, or where it has none of
/// its own the scan, for points and poses beyond the voxel grid.
std::vector<ScanResult> push_scan(Pipeline& pipeline, const Sequence& sequence,
                                  std::size_t scan_index, const Frame& frame);

/// Whether the method looks for motion in scan `scan_index` of `scan_count` (algorithm, section 4).
bool detection_runs(const Config& config, std::size_t scan_index, std::size_t scan_count);

}  // namespace mosbench
