#include "eval/job/study_drives.hpp"

#include <fmt/format.h>

#include <string_view>

#include "datasets/disk/files.hpp"
#include "datasets/sequence/fingerprint.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kOfScene = "scene ";

/// Hashes the sizes of all scans, or of a bag, and the bytes of the first: scans of one size may
/// have other points. Neither names nor poses matter.
std::string recorded_drive(const Sequence& sequence) {
  constexpr std::uintmax_t kMostBytes = 1U << 26U;
  std::vector<fs::path> files;
  for (const ScanEntry& scan : sequence.recording().scans) {
    if (scan.file) files.push_back(*scan.file);
  }
  if (files.empty()) files = sequence.files();
  std::string listing;
  for (const fs::path& file : files) listing += fmt::format("{} ", size_of(file));
  const bool is_scan = !files.empty() && size_of(files.front()) <= kMostBytes;
  return hash_of_text(listing + (is_scan ? hash_of_file(files.front()) : ""));
}

/// Whether two parts of a drive share no scan.
bool are_apart(const StudyCell& first, const StudyCell& second) {
  const ScanRange one = first.job.data.reading.scans.value_or(ScanRange{});
  const ScanRange other = second.job.data.reading.scans.value_or(ScanRange{});
  return (one.to && *one.to <= other.from) || (other.to && *other.to <= one.from);
}

/// Whether two cells may read the same scans. One simulation may write several sequences, which are
/// others.
bool may_share_scans(const StudyCell& first, const StudyCell& second) {
  if (first.drive.empty() || first.drive != second.drive) return false;
  const bool are_siblings = first.data == second.data && first.drive.starts_with(kOfScene);
  return !are_siblings && !are_apart(first, second);
}

}  // namespace

std::string simulated_drive(const std::string& scene_fingerprint, std::uint64_t seed) {
  return fmt::format("{}{} seed {}", kOfScene, scene_fingerprint, seed);
}

std::string drive_of(const Data& data, const std::string& sequence) {
  Reading reading = data.reading;
  reading.scans.reset();
  reading.refine_poses = false;
  const Dataset dataset = open_dataset(data.path, {data.kind, {sequence}, reading});
  const Sequence& opened = *dataset.sequences.front();
  const auto& origin = opened.simulated();
  return origin ? simulated_drive(origin->scene_fingerprint, origin->seed) : recorded_drive(opened);
}

void check_drives(const Study& study, const std::vector<StudyCell>& cells) {
  std::vector<const StudyCell*> tuned, judged;
  for (const StudyCell& cell : cells) {
    if (cell.axis != nullptr) continue;
    if (names_sequence(study.tuning->tune_on, cell)) tuned.push_back(&cell);
    if (names_sequence(study.tuning->judge_on, cell)) judged.push_back(&cell);
  }
  for (const StudyCell* one : tuned) {
    for (const StudyCell* other : judged) {
      if (!may_share_scans(*one, *other)) continue;
      throw UsageError(
          fmt::format("{}: best_of tunes on \"{}\" and judges on \"{}\", which are the same drive, "
                      "expected other sequences, or other `scans` of it, in judge_on",
                      study.file.string(), one->sequence_label(), other->sequence_label()));
    }
  }
}

}  // namespace mosbench
