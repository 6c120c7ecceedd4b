#include "datasets/doctor/doctor.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "datasets/disk/files.hpp"
#include "datasets/doctor/row_patterns.hpp"
#include "datasets/formats/calib_file.hpp"
#include "datasets/layouts/doals_sequence.hpp"
#include "datasets/layouts/simulated_origin.hpp"
#include "datasets/sequence/pose_source.hpp"
#include "datasets/text/errors.hpp"

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

/// Returns the median time from scan to scan; nothing without stamps in order.
std::optional<double> usual_step_s(const Sequence& sequence) {
  std::vector<double> steps_s;
  for (std::size_t i = 1; i < sequence.size(); ++i) {
    const auto before = sequence.stamp_ns(i - 1), after = sequence.stamp_ns(i);
    if (before && after) steps_s.push_back(1e-9 * static_cast<double>(*after - *before));
  }
  if (steps_s.empty()) return std::nullopt;
  const double step_s = median(std::move(steps_s));
  return step_s > 0.0 ? std::optional(step_s) : std::nullopt;
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

SequenceCheckup described(const Sequence& sequence) {
  SequenceCheckup part;
  part.name = sequence.name();
  part.scans = sequence.size();
  part.reading = sequence.reading();
  part.remarks = sequence.remarks();
  part.labelled_scans = scans_with_truth(sequence).size();
  return part;
}

void check_sequence(const Sequence& sequence, const std::filesystem::path& folder, DatasetKind kind,
                    bool simulated, Checkup& checkup) {
  SequenceCheckup& part = checkup.sequences.emplace_back(described(sequence));
  collect(checkup.symptoms, folder, [&] { return check_content(sequence, kind, part); });
  append(checkup.symptoms, check_stamps(sequence, part));
  collect(checkup.symptoms, folder, [&] { return check_poses(sequence, folder, part); });
  collect(checkup.symptoms, folder, [&] { return check_labels_by_scans(sequence, part); });
  if (!simulated) append(checkup.symptoms, check_published(sequence, kind, folder, part));
}

/// Calls a function before each scan is read.
class WatchedSequence : public SequenceAround {
 public:
  WatchedSequence(std::unique_ptr<Sequence> inner, const std::function<void()>& at_each_scan)
      : SequenceAround(std::move(inner)), at_each_scan_(at_each_scan) {}

  using Sequence::read;
  void read(std::size_t scan_index, Frame& frame) const override {
    at_each_scan_();
    inner().read(scan_index, frame);
  }
  std::vector<std::uint32_t> read_truth(std::size_t scan_index) const override {
    at_each_scan_();
    return inner().read_truth(scan_index);
  }

 private:
  const std::function<void()>& at_each_scan_;
};

/// Opens the data set and checks it; `folders` are those of the sequences in the options.
void check_opened(const std::filesystem::path& path, const OpenOptions& options,
                  const std::vector<SequenceFolder>& folders,
                  const std::function<void()>& at_each_scan, Checkup& checkup) {
  Dataset dataset = open_dataset(path, options);
  const bool simulated = simulated_origin(path).has_value();
  for (std::size_t i = 0; i < dataset.sequences.size(); ++i) {
    const WatchedSequence sequence(std::move(dataset.sequences[i]), at_each_scan);
    check_sequence(sequence, folders[i].folder, dataset.kind, simulated, checkup);
  }
}

/// Checks what needs no poses.
void check_without_poses(const std::filesystem::path& path, OpenOptions options,
                         const std::vector<SequenceFolder>& folders,
                         const std::function<void()>& at_each_scan, Checkup& checkup) {
  options.reading.poses_by_odometry = true;
  Dataset dataset = open_dataset(path, options);
  for (std::size_t i = 0; i < dataset.sequences.size(); ++i) {
    const WatchedSequence sequence(std::move(dataset.sequences[i]), at_each_scan);
    SequenceCheckup& part = checkup.sequences.emplace_back(described(sequence));
    part.has_poses = false;
    collect(checkup.symptoms, folders[i].folder,
            [&] { return check_content(sequence, dataset.kind, part); });
    append(checkup.symptoms, check_stamps(sequence, part));
  }
}

/// Checks each sequence for itself, of those without poses what needs none.
void check_one_by_one(const std::filesystem::path& path, OpenOptions options,
                      const std::vector<SequenceFolder>& folders,
                      const std::function<void()>& at_each_scan, Checkup& checkup) {
  std::vector<Symptom> missing;
  for (const SequenceFolder& folder : folders) {
    options.sequences = {folder.name};
    collect(checkup.symptoms, path, [&] {
      try {
        check_opened(path, options, {folder}, at_each_scan, checkup);
      } catch (const MissingPoses& error) {
        missing.push_back(symptom_of(error, path));
        check_without_poses(path, options, {folder}, at_each_scan, checkup);
      }
      return std::vector<Symptom>();
    });
  }
  checkup.lacks_poses = !missing.empty() && !checkup.has(Severity::kError);
  append(checkup.symptoms, std::move(missing));
}

}  // namespace

bool Checkup::has(Severity severity) const {
  return std::ranges::any_of(
      symptoms, [severity](const Symptom& finding) { return finding.severity == severity; });
}

std::vector<Symptom> check_poses(const Sequence& sequence, const std::filesystem::path& folder,
                                 SequenceCheckup& checkup) {
  constexpr std::size_t kFewestScans = 6, kSpots = 6;
  std::vector<Pose> given;
  std::vector<std::string> stems;
  for (const ScanEntry& scan : sequence.recording().scans) {
    given.push_back(scan.map_from_sensor);
    stems.push_back(scan.stem);
  }
  if (given.size() < kFewestScans || checkup.is_partly_turned) return {};
  const MisplacedRowsFound misplaced = misplaced_rows(sequence, given);
  checkup.measures["row_gain"] = misplaced.largest_gain;
  for (const MisplacedRows& rows : misplaced.rows) given = mended(std::move(given), rows);
  std::vector<std::size_t> spots = odd_steps(given, kSpots);
  for (const RowRange& run : equal_rows(given)) {
    if (spots.size() < 2 * kSpots) spots.push_back((run.first + run.last) / 2);
  }
  const auto diagnose_from = [&](const std::vector<MotionGuess>& guesses) {
    return diagnose(given, measure_motions(sequence, given, spots, guesses),
                    other_conventions(given, tr_of(folder), tr_is_applied(checkup.reading)),
                    {stems, usual_step_s(sequence)});
  };
  checkup.poses = diagnose_from({});
  const auto tries = worth_another_try(checkup.poses->conventions, checkup.poses->scores);
  std::vector<MotionGuess> guesses;
  for (const PoseConvention& convention : tries) {
    guesses.push_back([&convention](const ScanPair& pair) { return convention.motion(pair); });
  }
  if (!guesses.empty()) checkup.poses = diagnose_from(guesses);
  checkup.measures.merge(checkup.poses->measures);
  std::ranges::copy(checkup.poses->remarks, std::back_inserter(checkup.remarks));
  std::vector<Symptom> symptoms;
  for (const std::string& finding : checkup.poses->findings) {
    symptoms.push_back({Severity::kWarning, sequence.name(), finding});
  }
  // Poses in another convention have detours of their own.
  if (!symptoms.empty()) return symptoms;
  for (const MisplacedRows& rows : misplaced.rows) {
    symptoms.push_back({Severity::kWarning, sequence.name(), sentence_on(rows, sequence)});
  }
  return symptoms;
}

std::vector<Symptom> check_labels_by_scans(const Sequence& sequence, SequenceCheckup& checkup) {
  if (!checkup.poses || !checkup.poses->findings.empty()) return {};
  std::vector<Pose> poses;
  for (const ScanEntry& scan : sequence.recording().scans) poses.push_back(scan.map_from_sensor);
  checkup.truth = check_truth(sequence, poses, checkup.poses->fits);
  std::ranges::copy(checkup.truth->remarks, std::back_inserter(checkup.remarks));
  std::vector<Symptom> symptoms;
  for (const std::string& finding : checkup.truth->findings) {
    symptoms.push_back({Severity::kWarning, sequence.name(), finding});
  }
  return symptoms;
}

Checkup check_up(const std::filesystem::path& path, const OpenOptions& options,
                 const std::function<void()>& at_each_scan) {
  Checkup checkup;
  std::vector<SequenceFolder> folders;
  try {
    folders = find_sequences(path, options, checkup.kind);
    for (const SequenceFolder& folder : folders) {
      collect(checkup.symptoms, folder.folder,
              [&] { return check_folder(folder.folder, folder.name); });
    }
    check_opened(path, options, folders, at_each_scan, checkup);
  } catch (const MissingPoses&) {
    check_one_by_one(path, options, folders, at_each_scan, checkup);
  } catch (const DataError& error) {
    checkup.symptoms.push_back(symptom_of(error, path));
  }
  return checkup;
}

}  // namespace mosbench
