#include "datasets/doctor/doctor.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "datasets/files/calib_file.hpp"
#include "datasets/files/errors.hpp"
#include "datasets/files/files.hpp"
#include "datasets/layouts/doals_sequence.hpp"
#include "datasets/layouts/simulated_origin.hpp"

namespace mosbench {
namespace {

bool tr_is_applied(const ReadingStatement& reading) {
  return std::ranges::any_of(reading, [](const auto& statement) {
    return statement.first == "pose_frame" && statement.second.starts_with("camera");
  });
}

/// Returns Tr of calib.txt, or nothing when it is the identity or there is no such file.
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

/// Turns an error into a symptom. The file that it names first becomes `where` if it is below
/// `path`.
Symptom symptom_of(const DataError& error, const std::filesystem::path& path) {
  const std::string message = error.what(), root = path.string();
  const std::size_t end =
      message.starts_with(root) ? message.find(": ", root.size()) : message.npos;
  if (end == message.npos) return {Severity::kError, root, message};
  return {Severity::kError, message.substr(0, end), message.substr(end + 2)};
}

/// Adds what a check returns, or the error that it throws.
template <typename Check>
void collect(std::vector<Symptom>& symptoms, const std::filesystem::path& folder, Check&& check) {
  try {
    append(symptoms, check());
  } catch (const DataError& error) {
    symptoms.push_back(symptom_of(error, folder));
  }
}

std::string sentence_on(const MisplacedRows& rows, const Sequence& sequence) {
  if (rows.single()) {
    return fmt::format(
        "the pose of scan {} (row {}) does not fit between its neighbours: the trajectory jumps "
        "there "
        "and back, and scans overlap better without; expected the poses in the order of the scans",
        sequence.stem(rows.first), rows.first + 1);
  }
  return fmt::format(
      "the poses of scans {} and {} (rows {} and {}) are exchanged: the other way round the "
      "trajectory "
      "is shorter and scans overlap better; expected the poses in the order of the scans",
      sequence.stem(rows.first), sequence.stem(rows.second), rows.first + 1, rows.second + 1);
}

std::string sentence_on_better(const SequenceCheckup& checkup) {
  const std::vector<std::size_t>& better = checkup.poses->better;
  const ConventionScore& score = checkup.poses->scores[better.front()];
  std::vector<std::string> names, remedies;
  for (const std::size_t i : better) {
    names.push_back(checkup.conventions[i].name);
    remedies.push_back(checkup.conventions[i].remedy);
  }
  return fmt::format(
      "the poses fit better as {}{}: scans overlap by {:.2f} instead of {:.2f} in {} of {} pairs; "
      "{}",
      fmt::join(names, " or "), better.size() > 1 ? " (these scans do not decide which)" : "",
      score.overlap, score.given_overlap, score.pairs_better, score.pairs,
      fmt::join(remedies, " or "));
}

void check_sequence(const Sequence& sequence, const std::filesystem::path& folder, DatasetKind kind,
                    bool simulated, Checkup& checkup) {
  SequenceCheckup& part = checkup.sequences.emplace_back();
  part.name = sequence.name();
  part.scans = sequence.size();
  part.reading = sequence.reading();
  part.remarks = sequence.remarks();
  part.labelled_scans = scans_with_truth(sequence).size();
  collect(checkup.symptoms, folder, [&] { return check_content(sequence, kind, part); });
  collect(checkup.symptoms, folder, [&] { return check_poses(sequence, folder, part); });
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
  const std::vector<MisplacedRows> misplaced = misplaced_rows(sequence, given);
  for (const MisplacedRows& rows : misplaced) given = mended(std::move(given), rows);
  checkup.conventions = other_conventions(given, tr_of(folder), tr_is_applied(checkup.reading));
  checkup.poses = measure_poses(sequence, given, checkup.conventions);
  if (checkup.poses && !checkup.poses->better.empty()) {
    // Poses in another convention have detours of their own.
    return {{Severity::kWarning, sequence.name(), sentence_on_better(checkup)}};
  }
  std::vector<Symptom> symptoms;
  for (const MisplacedRows& rows : misplaced) {
    symptoms.push_back({Severity::kWarning, sequence.name(), sentence_on(rows, sequence)});
  }
  if (checkup.poses && !checkup.poses->given.fits()) {
    const PoseFit& fit = checkup.poses->given;
    symptoms.push_back(
        {Severity::kWarning, sequence.name(),
         fmt::format("the poses do not fit the scans in any convention: scans overlap by {:.2f}, "
                     "moved by {:.2f} m by {:.2f}; expected the poses of this sequence",
                     fit.overlap, fit.median_correction_m, fit.best_overlap)});
  }
  return symptoms;
}

Checkup check_up(const std::filesystem::path& path, const OpenOptions& options) {
  Checkup checkup;
  std::vector<SequenceFolder> folders;
  try {
    folders = find_sequences(path, options, checkup.kind);
    for (const SequenceFolder& folder : folders) {
      collect(checkup.symptoms, folder.folder,
              [&] { return check_folder(folder.folder, folder.name); });
    }
    const Dataset dataset = open_dataset(path, options);
    const bool simulated = simulated_origin(path).has_value();
    for (std::size_t i = 0; i < dataset.sequences.size(); ++i) {
      check_sequence(*dataset.sequences[i], folders[i].folder, dataset.kind, simulated, checkup);
    }
  } catch (const DataError& error) {
    checkup.symptoms.push_back(symptom_of(error, path));
  }
  return checkup;
}

}  // namespace mosbench
