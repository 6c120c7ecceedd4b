#include "datasets/doctor.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "datasets/calib_file.hpp"
#include "datasets/doals_sequence.hpp"
#include "datasets/errors.hpp"
#include "datasets/files.hpp"
#include "datasets/simulated_origin.hpp"

namespace mosbench {
namespace {

bool tr_is_applied(const ReadingStatement& reading) {
  return std::ranges::any_of(reading, [](const auto& statement) {
    return statement.first == "pose_frame" && statement.second.starts_with("camera");
  });
}

/// Tr of calib.txt unless it is the identity or cannot be read.
std::optional<Pose> tr_of(const std::filesystem::path& folder) {
  const auto file = folder / "calib.txt";
  if (!is_there(file)) return std::nullopt;
  const Pose tr = read_calib(file);
  if (is_identity(tr)) return std::nullopt;
  return tr;
}

void append(std::vector<Symptom>& all, std::vector<Symptom> more) {
  std::ranges::move(more, std::back_inserter(all));
}

/// What a check throws is a finding as well.
template <typename Check>
void collect(std::vector<Symptom>& symptoms, const std::string& where, Check&& check) {
  try {
    append(symptoms, check());
  } catch (const DataError& error) {
    symptoms.push_back({Severity::kError, where, error.what()});
  }
}

void check_sequence(const Sequence& sequence, const std::filesystem::path& folder, DatasetKind kind,
                    bool simulated, Checkup& checkup) {
  SequenceCheckup& part = checkup.sequences.emplace_back();
  part.name = sequence.name();
  part.scans = sequence.size();
  part.reading = sequence.reading();
  part.remarks = sequence.remarks();
  part.labelled_scans = scans_with_truth(sequence).size();
  collect(checkup.symptoms, part.name, [&] { return check_content(sequence, kind, part); });
  collect(checkup.symptoms, part.name, [&] { return check_poses(sequence, folder, part); });
  if (!simulated) append(checkup.symptoms, check_published(sequence, kind, folder));
}

}  // namespace

bool Checkup::has(Severity severity) const {
  return std::ranges::any_of(
      symptoms, [severity](const Symptom& finding) { return finding.severity == severity; });
}

std::vector<Symptom> check_poses(const Sequence& sequence, const std::filesystem::path& folder,
                                 SequenceCheckup& checkup) {
  std::vector<Pose> given;
  for (std::size_t i = 0; i < sequence.size(); ++i) given.push_back(sequence.map_from_sensor(i));
  checkup.conventions = other_conventions(given, tr_of(folder), tr_is_applied(checkup.reading));
  checkup.poses = measure_poses(sequence, given, checkup.conventions);
  if (!checkup.poses) return {};
  const PoseMeasurement& measured = *checkup.poses;
  const ConventionScore* best = nullptr;
  for (const ConventionScore& score : measured.scores) {
    if (score.beats_given() && measured.is_full(score.overlap) &&
        (best == nullptr ||
         score.overlap - score.given_overlap > best->overlap - best->given_overlap)) {
      best = &score;
    }
  }
  if (best != nullptr) {
    const PoseConvention& convention = checkup.conventions[best->convention];
    return {{Severity::kWarning, sequence.name(),
             fmt::format("the poses fit better as {}: scans overlap by {:.2f} instead of {:.2f} in "
                         "{} of {} pairs; {}",
                         convention.name, best->overlap, best->given_overlap, best->pairs_better,
                         best->pairs, convention.remedy)}};
  }
  if (measured.given_fits()) return {};
  return {
      {Severity::kWarning, sequence.name(),
       fmt::format("the poses do not fit the scans in any convention: scans overlap by {:.2f}, "
                   "moved by {:.2f} m by {:.2f}; expected the poses of this sequence",
                   measured.given_overlap, measured.median_correction_m, measured.best_overlap)}};
}

Checkup check_up(const std::filesystem::path& path, const OpenOptions& options) {
  Checkup checkup;
  std::vector<SequenceFolder> folders;
  try {
    folders = find_sequences(path, options, checkup.kind);
    for (const SequenceFolder& folder : folders) {
      collect(checkup.symptoms, folder.name,
              [&] { return check_folder(folder.folder, folder.name); });
    }
    const Dataset dataset = open_dataset(path, options);
    const bool simulated = simulated_origin(path).has_value();
    for (std::size_t i = 0; i < dataset.sequences.size(); ++i) {
      check_sequence(*dataset.sequences[i], folders[i].folder, dataset.kind, simulated, checkup);
    }
  } catch (const DataError& error) {
    checkup.symptoms.push_back({Severity::kError, path.string(), error.what()});
  }
  return checkup;
}

}  // namespace mosbench
