#include "eval/engine/pose_files.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "datasets/disk/claim.hpp"
#include "datasets/disk/files.hpp"
#include "datasets/sequence/corrected_sequence.hpp"
#include "datasets/sequence/fingerprint.hpp"
#include "datasets/sequence/pose_mark.hpp"
#include "datasets/text/errors.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/result/machine.hpp"
#include "eval/result/output.hpp"
#include "eval/result/reading_json.hpp"
#include "eval/result/settings_json.hpp"
#include "eval/result/tell.hpp"
#include "eval/store/store.hpp"

namespace mosbench {
namespace {

/// What two records must share for their poses to be the same.
nlohmann::ordered_json record_identity(const Sequence& sequence) {
  return {{"sequence", sequence.name()},
          {"reading", to_json(members_of(sequence.reading()))},
          {"file_stamp", file_stamp(sequence)},
          {"code", code_json()}};
}

/// Whether a file of this name lies beside others: stdout and pipes do not.
bool lies_in_a_folder(const std::filesystem::path& file) {
  std::error_code ignored;
  const auto status = std::filesystem::status(file, ignored);
  const std::string place = std::filesystem::absolute(file).lexically_normal().string();
  return file != "-" && !place.starts_with("/dev/") && !place.starts_with("/proc/") &&
         (!std::filesystem::exists(status) || std::filesystem::is_regular_file(status));
}

/// KITTI's rows do not say that they are the lidar's, which a calib.txt would take for the
/// camera's; those of TUM are marked where there is more to say.
void write_pose_file(const FoundPoses& found, bool as_tum) {
  const std::string rows = pose_rows(found, as_tum);
  const PoseMark mark = mark_of_poses(found.sequence);
  if ((!as_tum || mark.is_set()) && lies_in_a_folder(found.file)) {
    mark_poses(found.file, rows, mark);
  }
  write_output(found.file, rows);
}

/// Gives a sequence the poses of a record, or those that were found now.
void set_poses(Sequence& sequence, const FoundPoses& found) {
  auto* posed = dynamic_cast<PosedSequence*>(&sequence);
  if (posed == nullptr) return;  // it has them
  posed->set_poses(poses_of(found));
  std::string doubt = doubt_about(doubtful_poses(found), found.scans.size());
  if (!doubt.empty()) sequence.add_doubt(std::move(doubt));
}

/// KITTI's rows belong to all scans, the first to the first.
void refuse_part(const Sequence& sequence) {
  if (sequence.reading().scans.empty()) return;
  throw UsageError(fmt::format(
      "{}: KITTI's rows belong to all scans of {}, expected TUM's, which have stamps (a file "
      "called *.tum, or tum:FILE), or all scans",
      option("scans"), sequence.name()));
}

/// What is to be written of one sequence.
struct PoseTask {
  Sequence& sequence;
  std::filesystem::path file;
  std::filesystem::path record = {};  ///< beside each of several; none for a single one
  nlohmann::ordered_json identity = {};
  std::optional<nlohmann::ordered_json> recorded = std::nullopt;  ///< an earlier call's scans
  bool is_written = false;  ///< the poses of these scans lie there
};

PoseTask task_of(Sequence& sequence, const PoseFiles& files, bool single) {
  if (single) return {.sequence = sequence, .file = files.out};
  const std::string stem = (files.out / sequence.name()).string();
  return {.sequence = sequence,
          .file = stem + (files.as_tum ? ".tum" : ".txt"),
          .record = stem + ".json",
          .identity = record_identity(sequence)};
}

[[noreturn]] void refuse_record(const PoseTask& task, const std::string& why) {
  throw UsageError(
      fmt::format("{}: {}, expected another folder, or --overwrite", task.record.string(), why));
}

/// The scans of a record that an earlier call of the same question left before it wrote the poses.
/// Throws UsageError for any other file of that name.
std::optional<nlohmann::ordered_json> recorded_scans(const PoseTask& task, bool as_tum) {
  if (task.record.empty() || !is_there(task.record)) return std::nullopt;
  try {
    nlohmann::ordered_json json = nlohmann::ordered_json::parse(read_file(task.record));
    const std::string other = changed_members(json.at("identity"), task.identity);
    if (!other.empty()) refuse_record(task, fmt::format("belongs to other poses ({})", other));
    FoundPoses found{task.sequence, task.file, std::move(json.at("scans"))};
    const bool whole = found.scans.size() == found.sequence.size();
    (void)found_text(found, "");  // throws where something is missing
    (void)pose_rows(found, as_tum);
    if (whole) return std::move(found.scans);
  } catch (const nlohmann::json::exception&) {  // refused below
  }
  refuse_record(task, "was not written by mosbench odometry");
}

/// Keeps what an earlier call found. Throws UsageError for files that would be replaced.
void check_task(PoseTask& task, bool as_tum) {
  task.recorded = recorded_scans(task, as_tum);
  task.is_written =
      task.recorded && is_there(task.file) &&
      read_file(task.file) == pose_rows({task.sequence, task.file, *task.recorded}, as_tum);
  if (task.is_written || !lies_in_a_folder(task.file)) return;
  refuse_to_replace(task.file);
  if (has_foreign_mark(task.file)) refuse_to_replace(task.file.string() + ".frame");
}

/// The record is written before the poses: they never lie there without it.
FoundPoses find_or_keep(PoseTask task, const std::optional<OdometryChoice>& choice,
                        const PoseFiles& files) {
  FoundPoses found{task.sequence, task.file, {}};
  if (task.recorded) {
    tell(fmt::format("{}: finished by an earlier call, kept", task.sequence.name()));
    found.scans = std::move(*task.recorded);
  } else {
    found.scans =
        choice ? scans_json(task.sequence, estimate_poses(task.sequence, *choice, files.threads))
               : scans_json(task.sequence);
    if (!task.record.empty()) {
      commit_file(task.record, json_text({{"identity", task.identity}, {"scans", found.scans}}));
    }
  }
  set_poses(task.sequence, found);
  if (!task.is_written) write_pose_file(found, files.as_tum);
  return found;
}

}  // namespace

std::vector<FoundPoses> write_poses(Dataset& dataset, const std::optional<OdometryChoice>& choice,
                                    const PoseFiles& files) {
  for (const auto& sequence : dataset.sequences) {
    files.as_tum ? check_stamps_of_tum(*sequence) : refuse_part(*sequence);
  }
  const bool single = dataset.sequences.size() == 1;
  if (files.out == "-" && !single) {
    throw UsageError("-o -: has no room for several sequences, expected a folder");
  }
  if (single) check_output(files.out);
  const std::optional<FolderLock> lock =
      single ? std::nullopt : std::make_optional<FolderLock>(files.out);
  std::vector<PoseTask> tasks;
  for (const auto& sequence : dataset.sequences) {
    tasks.push_back(task_of(*sequence, files, single));
    if (!files.overwrite) check_task(tasks.back(), files.as_tum);
  }
  std::vector<FoundPoses> found;
  for (PoseTask& task : tasks) found.push_back(find_or_keep(std::move(task), choice, files));
  return found;
}

}  // namespace mosbench
