#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "datasets/doctor/pose_evidence.hpp"
#include "datasets/layouts/dataset.hpp"
#include "datasets/layouts/layout.hpp"

namespace mosbench {

/// What the points of labelled scans do, by their labels.
struct LabelEvidence {
  std::size_t moving = 0, still = 0;  ///< labelled points
  /// Share of the points labelled moving, and of those labelled static, through whose place scans
  /// half a second and a second before or after look: what moves leaves its place.
  double moving_leaves = 0.0, still_leaves = 0.0;
  /// Mean share of moving points among the labelled points around a moving one.
  double purity = 0.0;
};

/// What was found in one sequence, for users to compare with what they know of it.
struct SequenceCheckup {
  std::string name;
  std::size_t scans = 0, labelled_scans = 0, scans_read = 0;
  ReadingDone reading;
  std::vector<std::string> remarks;
  std::map<std::uint32_t, std::size_t> points_of_id;  ///< label ids of the scans read
  std::vector<std::size_t> points_of_range;           ///< per bin of `range_bins_m`
  std::size_t points = 0, zero_points = 0, nonfinite_points = 0;
  bool has_poses = true;
  bool is_partly_turned = false;  ///< some scans are upside down: they do not fit one another
  Facts facts;                    ///< that are judged
  std::optional<PoseEvidence> poses;
  std::optional<LabelEvidence> labels;  ///< none where the poses are wrong
};

/// Returns the upper ends of the bins of SequenceCheckup::points_of_range; the last is open.
const std::vector<double>& range_bins_m();

struct Checkup {
  std::optional<DatasetKind> kind;
  std::vector<SequenceCheckup> sequences;
  std::vector<Symptom> symptoms;
  bool lacks_poses = false;  ///< the only error is that there are none

  bool has(Severity severity) const;
  /// Returns how all sequences should be read; none unless they agree.
  Remedy remedy() const;
};

/// Checks a data set. All files are listed and their sizes checked, some dozens of scans per
/// sequence are read. A reason why the data set cannot be opened is an error among the symptoms and
/// not thrown; throws UsageError as `open_dataset`. `at_each_scan` is called before a scan is read,
/// and may throw to end the check.
Checkup check_up(
    const std::filesystem::path& path, const OpenOptions& options,
    const std::function<void()>& at_each_scan = [] {});

/// Returns the doubts of a recording, and what its stamps and poses show: no scan is read unless
/// all poses are equal.
std::vector<std::string> doubts_of(const Sequence& sequence);

/// Adds what some dozens of scans show to the doubts of a sequence, once: that they are in another
/// unit or repeated, that labels are not the data set's, that poses do not fit. Returns what it
/// added. Says nothing of data that were disturbed on purpose. Throws DataError.
std::vector<std::string> add_doubts_of_scans(DatasetKind kind, Sequence& sequence,
                                             bool has_given_poses = true);

/// Finds scans that were measured over longer than the time to the next one, as they are read.
class SweepWatch {
 public:
  explicit SweepWatch(const Sequence& sequence) : sequence_(sequence) {}
  void add(std::size_t scan_index, const Frame& frame);
  /// Returns a sentence; nothing where there are none.
  std::optional<std::string> doubt() const;

 private:
  const Sequence& sequence_;
  std::size_t long_sweeps_ = 0, first_ = 0;
  std::int64_t first_sweep_ns_ = 0;
};

/// A sentence for KITTI's rows that were taken for the camera's where scans overlap clearly better
/// if they are the lidar's, or the other way round. Reads some scans, at most 10. Throws DataError.
std::optional<std::string> doubt_about_pose_frame(const Sequence& sequence);

// The steps of `check_up`. Each leaves facts, and throws DataError.

/// Looks at a sequence folder without opening it: gaps in the numbering of scans, label files
/// without scan, missing labels, files of odd sizes.
void examine_folder(const std::filesystem::path& folder, Facts& facts);
/// Looks at the order, unit and gaps of all stamps.
void examine_stamps(const Sequence& sequence, Facts& facts);
/// Reads up to `most_scans`, and those that may repeat others.
void examine_content(const Sequence& sequence, const LayoutContent& expected,
                     std::size_t most_scans, SequenceCheckup& checkup);
/// Compares labels with what other scans see, in up to a dozen labelled scans.
void examine_labels(const Sequence& sequence, SequenceCheckup& checkup);

/// Whether a point stays where it is, by what other scans see there.
enum class Stay : std::uint8_t { kUnseen, kStays, kLeaves };

/// Returns up to a dozen scans whose labels are compared with what others see.
std::vector<std::size_t> scans_to_look_at(const Sequence& sequence);
/// Looks at the points of a scan from scans 5, 10 and 15 before and after.
std::vector<Stay> stays_of(const Sequence& sequence, std::size_t scan_index,
                           const std::vector<Point>& points);

/// Returns the scans with a label other than 0, which nobody gave: data sets may have labels of key
/// frames alone and files of zeros for the scans between. Reads the truth of all.
std::vector<std::size_t> scans_with_labels(const Sequence& sequence);

double share(std::size_t part, std::size_t whole);

}  // namespace mosbench
