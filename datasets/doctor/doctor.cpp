#include "datasets/doctor/doctor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "datasets/disk/files.hpp"
#include "datasets/doctor/pose_fit.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/layouts/folder_search.hpp"
#include "datasets/sequence/ego_points.hpp"
#include "datasets/sequence/pose_clock.hpp"
#include "datasets/sequence/pose_source.hpp"
#include "datasets/sequence/scan_range.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

/// Scans whose points are counted, half of them labelled ones: a checkup takes seconds.
constexpr std::size_t kScansRead = 24;

/// Returns Tr of calib.txt, or nothing when it is the identity or there is no such file.
std::optional<Pose> tr_of(const std::filesystem::path& folder) {
  const auto file = folder / "calib.txt";
  if (!is_there(file)) return std::nullopt;
  const Pose tr = read_calib(file);
  if (is_identity(tr)) return std::nullopt;
  return tr;
}

/// Returns whether the poses read were turned from the camera of Tr in calib.txt to the lidar.
bool tr_is_applied(const ReadingDone& reading) { return reading.poses.frame == PoseFrame::kCamera; }

/// Has the clock of poses moved, not their rows, where stamps look them up.
void advise_offsets(const SequenceCheckup& checkup, std::vector<PoseConvention>& conventions) {
  const PosesDone& read = checkup.reading.poses;
  const auto step_s = checkup.facts.number("step_s");
  if (!read.offset_s || !step_s) return;
  for (PoseConvention& convention : conventions) {
    if (convention.rows_later == 0) continue;
    const double offset_s = read.fitting_offset_s.value_or(
        mending_offset_s(*read.offset_s, convention.rows_later * *step_s));
    convention.remedy.pose_offset_s = offset_s;
    convention.advice = "run with " + option("pose_offset_s", fmt::format("{}", offset_s));
  }
}

/// Compares the poses with the motions that scans show.
void examine_poses(const Sequence& sequence, const std::filesystem::path& folder,
                   SequenceCheckup& checkup) {
  constexpr std::size_t kFewestScans = 6;
  if (sequence.size() < kFewestScans || checkup.is_partly_turned) return;
  std::vector<Pose> given = poses_of(sequence);
  examine_misplaced_rows(sequence, given, checkup.facts);
  auto conventions = other_conventions(given, tr_of(folder), tr_is_applied(checkup.reading));
  advise_offsets(checkup, conventions);
  checkup.poses =
      measure_poses(sequence, given, conventions, checkup.facts.number("step_s"), checkup.facts);
}

void examine_ego(const Sequence& sequence, Facts& facts) {
  const EgoPlaces ego = find_ego(sequence);
  facts["ego_points"] = ego.points_per_scan;
  facts["ego"] = to_string(ego);
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

/// Checks the sequences of a data set, one after the other.
class Examination {
 public:
  Examination(const std::filesystem::path& path, OpenOptions options,
              const std::function<void()>& at_each_scan)
      : path_(path), options_(std::move(options)), at_each_scan_(at_each_scan) {}

  Checkup run() {
    try {
      folders_ = find_sequences(path_, options_, checkup_.kind);
      for (const SequenceFolder& folder : folders_) check_folder(folder);
      check_opened(options_, folders_);
    } catch (const MissingPoses&) {
      check_one_by_one();
    } catch (const DataError& error) {
      checkup_.symptoms.push_back(symptom_of(error, path_));
    }
    return std::move(checkup_);
  }

 private:
  /// Notes what is no symptom; returns whether anything else is found.
  bool judge(Subject subject, SequenceCheckup& part) {
    Remedy remedy = part.poses ? remedy_of(*part.poses) : Remedy();
    if (const auto fitting_s = part.reading.poses.fitting_offset_s) {
      remedy.pose_offset_s = fitting_s;
    }
    bool found = false;
    for (Symptom& symptom : judged(checks(), subject, part.facts, part.name, remedy)) {
      if (symptom.severity == Severity::kNote) {
        part.remarks.push_back(symptom.what);
      } else {
        checkup_.symptoms.push_back(std::move(symptom));
        found = true;
      }
    }
    return found;
  }

  /// Calls a function, and makes the error that it throws a symptom.
  void attempt(const std::filesystem::path& path, const std::function<void()>& examine) {
    try {
      examine();
    } catch (const DataError& error) {
      checkup_.symptoms.push_back(symptom_of(error, path));
    }
  }

  void check_folder(const SequenceFolder& folder) {
    attempt(folder.folder, [&] {
      SequenceCheckup part;
      part.name = folder.name;
      examine_folder(folder.folder, part.facts);
      judge(Subject::kFolder, part);
      folder_facts_[folder.name] = part.facts;
    });
  }

  /// Says that no sensor measured the data so.
  static void add_mark(const DataMark& mark, std::vector<std::string>& remarks) {
    if (const auto& origin = mark.simulated) {
      remarks.push_back(fmt::format("simulated: scene {}, seed {}", origin->scene, origin->seed));
    }
    if (!mark.disturbed.empty()) remarks.push_back(disturbed_doubt(mark));
  }

  /// Whether the LiDARs of a rig fit is found where it is opened.
  void note_doubts(const Sequence& sequence, SequenceCheckup& part) {
    std::vector<std::string> doubts = sequence.recording().doubts;
    if (sequence.recording().lidars.empty()) {
      std::ranges::move(doubts, std::back_inserter(part.remarks));
      return;
    }
    for (std::string& doubt : doubts_that_stay(std::move(doubts), sequence)) {
      checkup_.symptoms.push_back({Severity::kWarning, part.name, std::move(doubt)});
    }
  }

  /// Opens and checks sequences, of those without poses what needs none.
  void check_opened(const OpenOptions& options, const std::vector<SequenceFolder>& folders) {
    Dataset dataset = open_dataset(path_, options);
    const LayoutContent& expected = layout_of(dataset.kind).files;
    for (std::size_t i = 0; i < dataset.sequences.size(); ++i) {
      const WatchedSequence sequence(std::move(dataset.sequences[i]), at_each_scan_);
      const std::filesystem::path& folder = folders[i].folder;
      SequenceCheckup& part = checkup_.sequences.emplace_back();
      part.name = sequence.name();
      part.scans = sequence.size();
      part.reading = sequence.reading();
      part.remarks = sequence.remarks();
      note_doubts(sequence, part);
      add_mark(mark_as_read(sequence), part.remarks);
      part.labelled_scans = scans_with_truth(sequence).size();
      part.facts = folder_facts_[folders[i].name];
      part.has_poses = !options.reading.is_by_odometry();
      check_points(sequence, folder, expected, part);
      if (!part.has_poses) continue;
      check_clock(part);
      check_poses(sequence, folder, part);
      const bool is_whole = !sequence.simulated() && !options.reading.scans;
      if (is_whole) check_published(sequence, folder, expected, part);
    }
  }

  void check_points(const Sequence& sequence, const std::filesystem::path& folder,
                    const LayoutContent& expected, SequenceCheckup& part) {
    attempt(folder, [&] {
      examine_content(sequence, expected, kScansRead, part);
      judge(Subject::kPoints, part);
      judge(Subject::kReturns, part);
      judge(Subject::kLabelIds, part);
    });
    examine_stamps(sequence, part.facts);
    judge(Subject::kStamps, part);
  }

  void check_clock(SequenceCheckup& part) {
    const auto offset_s = part.reading.poses.fitting_offset_s;
    if (!offset_s) return;
    part.facts["clock_off_s"] = std::abs(*offset_s - part.reading.poses.offset_s.value_or(0.0));
    part.facts["clock_cure"] = option("pose_offset_s", fmt::format("{}", *offset_s));
    judge(Subject::kClock, part);
  }

  /// Checks the poses, and the labels where nothing speaks against the poses.
  void check_poses(const Sequence& sequence, const std::filesystem::path& folder,
                   SequenceCheckup& part) {
    // Registration has found these poses, so that it is not asked again.
    const bool is_found_still =
        part.reading.poses.source == kStaticPoses && !options_.reading.is_static();
    bool is_sound = is_found_still;
    attempt(folder, [&] {
      if (is_found_still) return;
      examine_poses(sequence, folder, part);
      is_sound = part.poses && !judge(Subject::kPoses, part);
      if (!is_sound) return;
      examine_pose_fit(sequence, part.poses->given, FitDetail::kFull, part.facts);
      is_sound = !judge(Subject::kFit, part);
      judge(Subject::kRows, part);
      examine_ego(sequence, part.facts);
      judge(Subject::kEgo, part);
    });
    if (!is_sound) return;
    attempt(folder, [&] {
      examine_labels(sequence, part);
      judge(Subject::kLabels, part);
    });
  }

  /// Compares with what the authors published of this folder.
  void check_published(const Sequence& sequence, const std::filesystem::path& folder,
                       const LayoutContent& expected, SequenceCheckup& part) {
    const auto published = std::ranges::find_if(
        expected.published,
        [&](const PublishedCount& count) { return ends_with(folder, count.folder); });
    if (published == expected.published.end()) return;
    const std::size_t scans = sequence.size(), points = sequence.point_count(0);
    part.facts["scans"] = scans;
    part.facts["published_scans"] = published->scans;
    part.facts["scans_left_out"] = std::size_t{scans < published->scans};
    part.facts["scans_too_many"] = std::size_t{scans > published->scans};
    part.facts["first_scan_points"] = points;
    part.facts["published_points"] = published->points;
    part.facts["points_unlike_published"] =
        std::size_t{published->points != 0 && points != published->points};
    judge(Subject::kPublished, part);
  }

  void check_one_by_one() {
    std::vector<Symptom> missing;
    for (const SequenceFolder& folder : folders_) {
      OpenOptions options = options_;
      options.sequences = {folder.name};
      attempt(path_, [&] {
        try {
          check_opened(options, {folder});
        } catch (const MissingPoses& error) {
          missing.push_back(symptom_of(error, path_));
          options.reading.poses = ByOdometry{};
          check_opened(options, {folder});
        }
      });
    }
    checkup_.lacks_poses = !missing.empty() && !checkup_.has(Severity::kError);
    std::ranges::move(missing, std::back_inserter(checkup_.symptoms));
  }

  const std::filesystem::path& path_;
  const OpenOptions options_;
  const std::function<void()>& at_each_scan_;
  std::vector<SequenceFolder> folders_;
  std::map<std::string, Facts> folder_facts_;
  Checkup checkup_;
};

constexpr std::size_t kStarts = 5;  // of pairs of scans, spread over the sequence
constexpr std::size_t kFewestPairs = 2;
constexpr double kTellingDifference_m = 1.0;
// Of the overlap, a mean likelihood. Lidar poses of simulated streets, highways, malls and campuses
// gain 0.09 to 0.32 when Tr is not applied.
constexpr double kBetterOverlap = 0.05;

/// The pairs that begin at the starts and end where the two ways to read the poses differ enough.
std::vector<ScanPair> telling_pairs(const std::vector<Pose>& poses, const std::vector<Pose>& rows) {
  std::vector<ScanPair> pairs;
  for (std::size_t s = 0; s < kStarts; ++s) {
    ScanPair pair{s * poses.size() / kStarts, s * poses.size() / kStarts + 1};
    const auto differs = [&] {
      return difference_m(relative(poses, pair), relative(rows, pair)) > kTellingDifference_m;
    };
    while (pair.later < poses.size() && !differs()) ++pair.later;
    if (pair.later < poses.size()) pairs.push_back(pair);
  }
  return pairs;
}

}  // namespace

bool Checkup::has(Severity severity) const {
  return std::ranges::any_of(
      symptoms, [severity](const Symptom& finding) { return finding.severity == severity; });
}

Remedy Checkup::remedy() const {
  const auto remedy_for = [&](const SequenceCheckup& sequence) {
    for (const Symptom& symptom : symptoms) {
      if (symptom.where == sequence.name && symptom.remedy) return symptom.remedy;
    }
    return Remedy();
  };
  Remedy common;
  for (std::size_t i = 0; i < sequences.size(); ++i) {
    const Remedy remedy = remedy_for(sequences[i]);
    if (i == 0) common = remedy;
    if (!(remedy == common)) return {};
  }
  return common;
}

double share(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

Checkup check_up(const std::filesystem::path& path, const OpenOptions& options,
                 const std::function<void()>& at_each_scan) {
  return Examination(path, options, at_each_scan).run();
}

std::optional<std::string> doubt_about_pose_frame(const Sequence& sequence) {
  const PosesDone& read = sequence.reading().poses;
  if (read.format != PoseFormat::kKitti || !read.frame) return std::nullopt;
  const auto files = sequence.files();
  const auto calib = std::ranges::find(files, "calib.txt", &std::filesystem::path::filename);
  std::optional<Pose> tr;
  if (calib != files.end()) tr = read_calib(*calib);
  if (tr && is_identity(*tr)) tr.reset();
  const bool of_camera = tr_is_applied(sequence.reading());
  const std::vector<Pose> poses = poses_of(sequence);
  const PoseConvention other = other_conventions(poses, tr, of_camera).front();
  ScanOverlap scans(sequence);
  std::vector<double> given_overlaps, other_overlaps;
  for (const ScanPair& pair : telling_pairs(poses, other.map_from_sensor)) {
    if (!scans.has_points(pair)) continue;
    given_overlaps.push_back(scans.overlap(pair, relative(poses, pair)));
    other_overlaps.push_back(scans.overlap(pair, relative(other.map_from_sensor, pair)));
  }
  if (given_overlaps.size() < kFewestPairs) return std::nullopt;
  const double given = median(std::move(given_overlaps)),
               better = median(std::move(other_overlaps));
  if (better < given + kBetterOverlap) return std::nullopt;
  return fmt::format(
      "THE POSES FIT AS THOSE OF THE {}: they were taken for the {}'s, under which scans overlap "
      "by "
      "{:.2f} instead of {:.2f}, so that labels are wrong; {}",
      of_camera ? "LIDAR" : "CAMERA", of_camera ? "camera" : "lidar", given, better, other.advice);
}

}  // namespace mosbench
