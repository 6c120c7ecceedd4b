#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <mosbench/method.hpp>
#include <optional>
#include <string>
#include <vector>

#include "datasets/sequence/sequence.hpp"
#include "eval/protocols/protocol.hpp"
#include "eval/result/result.hpp"
#include "eval/store/store.hpp"

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
  bool keeps_objects = false;      ///< with the scores also each point's object
  bool is_one_of_several = false;  ///< progress then names the method

  /// Reasons come with the scores of a method that gives some.
  PointFiles point_files() const {
    return {keeps_scores, keeps_scores && method->gives_reasons, keeps_objects};
  }
};

/// Returns what messages call a run over a sequence: its name, and with `is_one_of_several` also
/// the method's.
std::string title_of(const Sequence& sequence, const RunSettings& settings);

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

/// Wall and process CPU time, milliseconds.
struct Cost {
  double wall_ms = 0, cpu_ms = 0;
};

/// What one scan cost from reading its file to its labels. Nothing is written or scored.
struct ScanProfile {
  std::string stem;
  std::size_t points = 0;
  std::chrono::steady_clock::time_point start, end;  ///< of reading, and of the method
  Cost read;
  Cost method;  ///< the whole push: all stages and what is between them
  std::vector<StageTime> stages;
  double resident_mib = 0;          ///< of the process
  std::optional<MemoryUse> memory;  ///< of the method; nothing when it does not measure it
};

struct SequenceProfile {
  std::string name;
  unsigned threads = 1;
  std::optional<double> period_ms;  ///< median distance of the stamps; nothing without stamps
  std::vector<ScanProfile> scans;
  std::vector<std::string_view> stages;  ///< in the order in which they first ran
  double program_mib = 0;                ///< the most that a program of the user's held
  double program_cpu_s = 0;              ///< that it took; other CPU times are without it
};

/// Segments the first `most_scans` scans of a sequence, one after the other, and measures. Throws
/// DataError.
SequenceProfile profile_sequence(const Sequence& sequence, const RunSettings& settings,
                                 std::size_t most_scans = std::numeric_limits<std::size_t>::max());

}  // namespace mosbench
