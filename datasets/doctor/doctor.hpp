#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "datasets/doctor/misplaced_rows.hpp"
#include "datasets/doctor/pose_diagnosis.hpp"
#include "datasets/doctor/truth_check.hpp"
#include "datasets/layouts/dataset.hpp"

namespace mosbench {

/// With a warning results are doubtful, with an error there are none.
enum class Severity { kWarning, kError };

struct Symptom {
  Severity severity = Severity::kWarning;
  std::string where;  ///< sequence or file
  std::string what;   ///< a plain sentence with what was found and what was expected
};

/// What was found in one sequence, for users to compare with what they know of it.
struct SequenceCheckup {
  std::string name;
  std::size_t scans = 0, labelled_scans = 0, scans_read = 0;
  ReadingStatement reading;
  std::vector<std::string> remarks;
  std::map<std::uint32_t, std::size_t> points_of_id;  ///< label ids of the scans read
  std::vector<std::size_t> points_of_range;           ///< per bin of `range_bins_m`
  std::size_t points = 0, zero_points = 0, nonfinite_points = 0;
  bool has_poses = true;
  bool is_partly_turned = false;  ///< some scans are upside down: they do not fit one another
  /// What thresholds are compared with, see scripts/check/doctor_margins.py.
  std::map<std::string, double> measures;
  std::optional<PoseDiagnosis> poses;
  std::optional<TruthCheck> truth;  ///< none where the poses are wrong
};

/// Returns the upper ends of the bins of SequenceCheckup::points_of_range; the last is open.
const std::vector<double>& range_bins_m();

struct Checkup {
  std::optional<DatasetKind> kind;
  std::vector<SequenceCheckup> sequences;
  std::vector<Symptom> symptoms;
  bool lacks_poses = false;  ///< the only error is that there are none

  bool has(Severity severity) const;
};

/// Checks a data set. All files are listed and their sizes checked, some dozens of scans per
/// sequence are read. A reason why the data set cannot be opened is an error among the symptoms and
/// not thrown; throws UsageError as `open_dataset`. `at_each_scan` is called before a scan is read,
/// and may throw to end the check.
Checkup check_up(
    const std::filesystem::path& path, const OpenOptions& options,
    const std::function<void()>& at_each_scan = [] {});

/// Checks a sequence folder without opening it: gaps in the numbering of scans, label files without
/// scan, missing labels, files of odd sizes.
std::vector<Symptom> check_folder(const std::filesystem::path& folder, const std::string& name);

/// Checks points and labels of some of the scans, and fills in `checkup`.
std::vector<Symptom> check_content(const Sequence& sequence, DatasetKind kind,
                                   SequenceCheckup& checkup);

/// Checks the stamps of all scans: their order, unit and gaps; fills in the measures of `checkup`.
std::vector<Symptom> check_stamps(const Sequence& sequence, SequenceCheckup& checkup);

/// Checks the poses by the overlap of scans, and fills in `checkup`.
std::vector<Symptom> check_poses(const Sequence& sequence, const std::filesystem::path& folder,
                                 SequenceCheckup& checkup);

/// Checks the labels by what other scans see, where no symptom speaks against the poses, and fills
/// in `checkup`.
std::vector<Symptom> check_labels_by_scans(const Sequence& sequence, SequenceCheckup& checkup);

/// Checks the number of scans against what the data set's authors published. Fewer are an excerpt
/// and get a remark in `checkup`.
std::vector<Symptom> check_published(const Sequence& sequence, DatasetKind kind,
                                     const std::filesystem::path& folder, SequenceCheckup& checkup);

}  // namespace mosbench
