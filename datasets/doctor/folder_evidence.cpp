#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "datasets/disk/files.hpp"
#include "datasets/disk/folder_listing.hpp"
#include "datasets/doctor/doctor.hpp"
#include "datasets/formats/scan_file.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

/// Returns "000017, 000019 and 3 more".
std::string some_of(const std::vector<std::string>& names) {
  constexpr std::size_t kShown = 5;
  const std::size_t shown = std::min(kShown, names.size());
  std::string text = fmt::format(
      "{}", fmt::join(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(shown), ", "));
  if (names.size() > shown) text += fmt::format(" and {} more", names.size() - shown);
  return text;
}

/// Returns the numbers that numbered scans skip; none when most are skipped, as in stamps.
std::vector<std::string> gaps_of(const std::vector<StemFile>& scans) {
  std::set<std::uint64_t> numbers;
  for (const StemFile& scan : scans) {
    const auto number = stem_number(scan.stem);
    if (!number) return {};
    numbers.insert(*number);
  }
  if (numbers.empty() || *numbers.rbegin() - *numbers.begin() >= 2 * numbers.size()) return {};
  std::vector<std::string> gaps;
  for (std::uint64_t n = *numbers.begin(); n < *numbers.rbegin(); ++n) {
    if (!numbers.contains(n)) gaps.push_back(fmt::format("{:0{}}", n, scans.front().stem.size()));
  }
  return gaps;
}

std::vector<std::string> stems_without(const std::vector<StemFile>& files,
                                       const std::vector<StemFile>& partners) {
  std::set<std::string> known;
  for (const StemFile& partner : partners) known.insert(partner.stem);
  std::vector<std::string> without;
  for (const StemFile& file : files) {
    if (!known.contains(file.stem)) without.push_back(file.stem);
  }
  return without;
}

/// Compares the sizes of scans with those around them.
void compare_sizes(const std::vector<StemFile>& scans, Facts& facts) {
  double smallest_share = 1.0;
  std::vector<std::string> small;
  constexpr std::size_t kAround = 3;  // scans on either side
  std::vector<double> sizes_bytes;
  for (const StemFile& scan : scans) sizes_bytes.push_back(static_cast<double>(size_of(scan.file)));
  for (std::size_t i = 0; i < scans.size(); ++i) {
    if (sizes_bytes[i] == 0.0) continue;  // which is told of any format
    const std::size_t from = i < kAround ? 0 : i - kAround;
    const double usual_bytes = median({sizes_bytes.begin() + static_cast<std::ptrdiff_t>(from),
                                       sizes_bytes.begin() + static_cast<std::ptrdiff_t>(std::min(
                                                                 i + kAround + 1, scans.size()))});
    if (usual_bytes == 0.0) continue;
    const double share = sizes_bytes[i] / usual_bytes;
    smallest_share = std::min(smallest_share, share);
    if (share < kSmallestShare) small.push_back(scans[i].stem);
  }
  facts["smallest_scan"] = smallest_share;
  facts["small_scans"] = counted(small.size(), "scan is", "scans are");
  facts["small_names"] = some_of(small);
}

}  // namespace

void examine_folder(const fs::path& folder, Facts& facts) {
  if (!scan_folder_of(folder)) return;
  const auto scans = list_scans(folder);
  const auto gaps = gaps_of(scans);
  facts["gaps"] = gaps.size();
  facts["gap_names"] = some_of(gaps);
  facts["first_scan"] = scans.empty() ? "" : scans.front().stem;
  facts["last_scan"] = scans.empty() ? "" : scans.back().stem;
  if (is_there(folder / "labels")) {
    const auto labels = list_by_stem(folder / "labels", {".label"});
    const auto orphans = stems_without(labels, scans), unlabelled = stems_without(scans, labels);
    facts["orphans"] = orphans.size();
    facts["orphan_names"] = some_of(orphans);
    facts["unlabelled"] = unlabelled.size();
    facts["unlabelled_names"] = some_of(unlabelled);
    facts["labelled_share"] = share(labels.size(), scans.size());
    facts["scans_listed"] = counted(scans.size(), "scan");
  }
  compare_sizes(scans, facts);
}

void examine_stamps(const Sequence& sequence, Facts& facts) {
  std::vector<double> steps_s;
  std::size_t backward = 0;
  double longest_s = 0.0;
  for (std::size_t i = 1; i < sequence.size(); ++i) {
    const auto before = sequence.stamp_ns(i - 1), after = sequence.stamp_ns(i);
    if (!before || !after) continue;
    if (*after <= *before) {
      if (backward++ == 0) facts["first_backward"] = sequence.stem(i);
      continue;
    }
    steps_s.push_back(1e-9 * static_cast<double>(*after - *before));
    if (steps_s.back() <= longest_s) continue;
    longest_s = steps_s.back();
    facts["after_gap"] = sequence.stem(i);
  }
  facts["stamps_backward"] = backward;
  if (steps_s.empty()) return;
  const double step_s = median(std::move(steps_s));
  facts["step_s"] = step_s;
  facts["longest_step_s"] = longest_s;
  facts["gap_steps"] = longest_s / step_s;
}

}  // namespace mosbench
