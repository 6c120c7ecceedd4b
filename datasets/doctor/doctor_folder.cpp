#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "datasets/disk/files.hpp"
#include "datasets/disk/folder_listing.hpp"
#include "datasets/doctor/doctor.hpp"
#include "datasets/formats/scan_file.hpp"
#include "datasets/text/counted.hpp"

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

void check_labels(const fs::path& folder, const std::vector<StemFile>& scans,
                  const std::string& name, std::vector<Symptom>& symptoms) {
  const auto labels = list_by_stem(folder, {".label"});
  const auto orphans = stems_without(labels, scans);
  if (!orphans.empty()) {
    symptoms.push_back({Severity::kError, name,
                        fmt::format("{} label files have no scan: {}; expected a scan of the same "
                                    "name for each",
                                    orphans.size(), some_of(orphans))});
  }
  // Share above which missing labels are no choice: data sets that label part of the scans label a
  // minority.
  constexpr double kMostlyLabelled = 0.8;
  const auto unlabelled = stems_without(scans, labels);
  const auto share = static_cast<double>(labels.size()) / static_cast<double>(scans.size());
  if (!unlabelled.empty() && share > kMostlyLabelled) {
    symptoms.push_back(
        {Severity::kWarning, name,
         fmt::format("{} of {} have no label: {}; expected labels for all or "
                     "for a part at regular distances",
                     unlabelled.size(), counted(scans.size(), "scan"), some_of(unlabelled))});
  }
}

/// Warns of scans far smaller than those around them: they were cut off while they were copied.
void check_sizes(const std::vector<StemFile>& scans, const std::string& name,
                 std::vector<Symptom>& symptoms) {
  constexpr std::size_t kAround = 3;      // scans on either side
  constexpr double kSmallestShare = 0.6;  // of the median, far below what scenes change
  std::vector<std::uintmax_t> sizes_bytes;
  for (const StemFile& scan : scans) sizes_bytes.push_back(size_of(scan.file));
  std::vector<std::string> small;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const std::size_t from = i < kAround ? 0 : i - kAround;
    std::vector<std::uintmax_t> around(
        sizes_bytes.begin() + static_cast<std::ptrdiff_t>(from),
        sizes_bytes.begin() + static_cast<std::ptrdiff_t>(std::min(i + kAround + 1, scans.size())));
    std::ranges::nth_element(around,
                             around.begin() + static_cast<std::ptrdiff_t>(around.size() / 2));
    const auto usual_bytes = static_cast<double>(around[around.size() / 2]);
    const bool is_empty = sizes_bytes[i] == 0;  // which is told of any format
    if (!is_empty && static_cast<double>(sizes_bytes[i]) < kSmallestShare * usual_bytes)
      small.push_back(scans[i].stem);
  }
  if (small.empty()) return;
  symptoms.push_back({Severity::kWarning, name,
                      fmt::format("{} far smaller than those around them: {}; expected "
                                  "scans of like size",
                                  counted(small.size(), "scan is", "scans are"), some_of(small))});
}

}  // namespace

std::vector<Symptom> check_folder(const fs::path& folder, const std::string& name) {
  std::vector<Symptom> symptoms;
  if (!scan_folder_of(folder)) return symptoms;
  const auto scans = list_scans(folder);
  const auto gaps = gaps_of(scans);
  if (!gaps.empty()) {
    symptoms.push_back(
        {Severity::kWarning, name,
         fmt::format("the numbering of the scans lacks {}: {}; expected all numbers "
                     "from {} to {}",
                     gaps.size(), some_of(gaps), scans.front().stem, scans.back().stem)});
  }
  if (is_there(folder / "labels")) check_labels(folder / "labels", scans, name, symptoms);
  check_sizes(scans, name, symptoms);
  return symptoms;
}

}  // namespace mosbench
