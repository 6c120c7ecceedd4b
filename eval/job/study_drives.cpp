#include "eval/job/study_drives.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string_view>
#include <utility>

#include "datasets/layouts/dataset.hpp"
#include "datasets/simulator/simulate.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

constexpr std::string_view kSeed = " seed ";

/// Hashes where returns are, in any order: layouts differ in intensities and in returns that miss.
std::optional<std::uint64_t> hash_of_points(const std::vector<Point>& points) {
  std::uint64_t sum = 0;
  for (const Point& point : points) {
    const std::array<float, 3> at = {point.x, point.y, point.z};
    const bool is_return = std::isfinite(at[0] + at[1] + at[2]) && at != std::array<float, 3>{};
    if (is_return) sum += XXH3_64bits(at.data(), sizeof(at));
  }
  return sum != 0 ? std::optional(sum) : std::nullopt;
}

/// How many points each scan has, with returns that miss where the layout keeps them.
std::vector<std::uint64_t> point_counts(const Sequence& sequence) {
  std::vector<std::uint64_t> counts;
  for (const ScanEntry& scan : sequence.recording().scans) counts.push_back(scan.points);
  return counts;
}

/// Hashes how many points scans in a row have, which no two drives share by chance; nothing where
/// two of them have as many, as of a sensor whose scans all do.
std::optional<std::uint64_t> hash_of_counts(std::span<const std::uint64_t> counts) {
  constexpr std::size_t kInRow = 8;
  if (counts.size() < kInRow) return std::nullopt;
  counts = counts.first(kInRow);
  if (std::set(counts.begin(), counts.end()).size() < kInRow) return std::nullopt;
  return XXH3_64bits(counts.data(), counts.size_bytes());
}

/// Up to so many scans; those of as many points in their order.
std::vector<std::size_t> chosen_scans(const std::vector<std::uint64_t>& counts) {
  constexpr std::size_t kRead = 16;
  std::vector<std::pair<std::uint64_t, std::size_t>> order;
  for (std::size_t k = 0; k < counts.size(); ++k) {
    order.emplace_back(XXH3_64bits(&counts[k], sizeof(counts[k])), k);
  }
  std::ranges::sort(order);
  order.resize(std::min(order.size(), kRead));
  std::vector<std::size_t> scans;
  for (const auto& [hash, k] : order) scans.push_back(k);
  return scans;
}

/// Whether two parts of the same data share no scan. Numbers of scans of a copy say nothing.
bool are_apart(const StudyCell& first, const StudyCell& second) {
  const bool are_simulated = first.job.data.simulation && second.job.data.simulation;
  const bool are_same =
      first.job.data.path == second.job.data.path && first.sequence == second.sequence;
  if (!are_simulated && !are_same) return false;
  const ScanRange one = first.job.data.reading.scans.value_or(ScanRange{});
  const ScanRange other = second.job.data.reading.scans.value_or(ScanRange{});
  return (one.to && *one.to <= other.from) || (other.to && *other.to <= one.from);
}

/// One simulation may write several sequences, which are others.
bool are_siblings(const StudyCell& first, const StudyCell& second) {
  return first.kind == second.kind && first.sequence != second.sequence &&
         simulates_several(first.kind);
}

/// Whether two cells may read the same scans.
bool may_share_scans(const StudyCell& first, const StudyCell& second) {
  const bool same_simulation = !first.drive.empty() && first.drive == second.drive;
  const bool same =
      share_a_scan(first.scans, second.scans) || (same_simulation && !are_siblings(first, second));
  return same && !are_apart(first, second);
}

}  // namespace

std::string simulated_drive(const std::string& scene_fingerprint, std::uint64_t seed) {
  return fmt::format("scene {}{}{}", scene_fingerprint, kSeed, seed);
}

std::string drive_of(const std::optional<SimulatedOrigin>& origin) {
  return origin ? simulated_drive(origin->scene_fingerprint, origin->seed) : "";
}

std::string scene_of(const std::string& drive) { return drive.substr(0, drive.rfind(kSeed)); }

std::set<std::uint64_t> scan_hashes(const Data& data, const std::string& sequence) {
  Reading reading = data.reading;
  reading.scans.reset();
  reading.perturb.reset();
  reading.refine_poses = reading.hdl64_correction = false;
  const Dataset dataset = open_dataset(data.path, {data.kind, {sequence}, reading});
  const Sequence& opened = *dataset.sequences.front();
  const std::vector<std::uint64_t> counts = point_counts(opened);
  std::set<std::uint64_t> hashes;
  Frame frame;
  for (const std::size_t k : chosen_scans(counts)) {
    try {
      opened.read(k, frame);
    } catch (const DataError&) {  // which fails where it is needed
      continue;
    }
    if (const auto hash = hash_of_points(frame.points)) hashes.insert(*hash);
    if (const auto hash = hash_of_counts(std::span(counts).subspan(k))) hashes.insert(*hash);
  }
  return hashes;
}

bool share_a_scan(const std::set<std::uint64_t>& first, const std::set<std::uint64_t>& second) {
  return std::ranges::any_of(first, [&](std::uint64_t scan) { return second.contains(scan); });
}

bool are_seeds_of_one_scene(const StudyCell& first, const StudyCell& second) {
  return !first.drive.empty() && first.drive != second.drive &&
         scene_of(first.drive) == scene_of(second.drive);
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
