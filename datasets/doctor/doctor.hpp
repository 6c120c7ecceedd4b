#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "datasets/doctor/misplaced_rows.hpp"
#include "datasets/doctor/pose_conventions.hpp"
#include "datasets/doctor/pose_measurement.hpp"
#include "datasets/layouts/dataset.hpp"

namespace mosbench {

/// A warning leaves numbers doubtful; with an error there are none.
enum class Severity { kWarning, kError };

struct Symptom {
  Severity severity = Severity::kWarning;
  std::string where;  ///< sequence or file
  std::string what;   ///< a plain sentence with what was found and what was expected
};

/// What was seen of one sequence, for the user to compare with what he knows of it.
struct SequenceCheckup {
  std::string name;
  std::size_t scans = 0, labelled_scans = 0, scans_read = 0;
  ReadingStatement reading;
  std::vector<std::string> remarks;
  std::map<std::uint32_t, std::size_t> points_of_id;  ///< label ids of the scans read
  std::vector<std::size_t> points_of_range;           ///< per bin of `range_bins_m`
  std::size_t points = 0, zero_points = 0, nonfinite_points = 0;
  std::vector<PoseConvention> conventions;
  std::optional<PoseMeasurement> poses;
};

/// Upper ends of the bins of SequenceCheckup::points_of_range, the last without end.
const std::vector<double>& range_bins_m();

struct Checkup {
  std::optional<DatasetKind> kind;
  std::vector<SequenceCheckup> sequences;
  std::vector<Symptom> symptoms;

  bool has(Severity severity) const;
};

/// Looks for what is wrong with a data set. Files are listed and measured all, read in part: some
/// dozens of scans per sequence. What keeps the data set from being opened is an error among the
/// symptoms, nothing is thrown for it; throws UsageError as `open_dataset`.
Checkup check_up(const std::filesystem::path& path, const OpenOptions& options);

/// Checks of a sequence folder that need not open it: gaps in the numbering of scans, labels and
/// poses in another number than scans, files of odd sizes.
std::vector<Symptom> check_folder(const std::filesystem::path& folder, const std::string& name);

/// Checks that read part of the scans; they fill `checkup`, too.
std::vector<Symptom> check_content(const Sequence& sequence, DatasetKind kind,
                                   SequenceCheckup& checkup);

/// Checks of the poses by how well scans overlap.
std::vector<Symptom> check_poses(const Sequence& sequence, const std::filesystem::path& folder,
                                 SequenceCheckup& checkup);

/// Checks of the number of scans against what the data set's authors published.
std::vector<Symptom> check_published(const Sequence& sequence, DatasetKind kind,
                                     const std::filesystem::path& folder);

}  // namespace mosbench
