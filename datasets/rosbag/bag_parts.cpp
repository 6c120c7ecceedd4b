#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <regex>
#include <tuple>

#include "datasets/disk/folder_listing.hpp"
#include "datasets/rosbag/bag_reader.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

/// What a name says of a part.
struct PartName {
  std::string drive;   ///< "drive" of drive_2024-01-01-12-00-00_0.bag
  std::string ending;  ///< ".bag"
  std::uint64_t number = 0;
  auto operator<=>(const PartName&) const = default;
};

/// Returns nothing for a name without a number at its end. rosbag puts the time at which a part
/// began before its number, rosbag2 that of the drive.
std::optional<PartName> part_name(const fs::path& file) {
  static const std::regex kPart(
      R"((.*?)_?(?:\d{4}-\d\d-\d\d-\d\d-\d\d-\d\d)?_(\d{1,9})(\.bag|\.mcap|\.db3)(?:\.zstd)?)");
  const std::string name = file.filename().string();
  std::smatch found;
  if (!std::regex_match(name, found, kPart)) return std::nullopt;
  return PartName{found[1], found[3], std::stoull(found[2])};
}

using Extent = std::optional<std::pair<std::int64_t, std::int64_t>>;

/// Returns nothing for a bag that cannot be read, which opening it says.
Extent extent_of(const fs::path& bag) {
  try {
    return open_bag(bag)->extent_ns();
  } catch (const DataError&) {
    return std::nullopt;
  }
}

/// Returns whether the second of two bags was recorded right after the first.
bool follows(const Extent& before, const Extent& after) {
  constexpr std::int64_t kMostBetween_ns = 2'000'000'000, kMostOverlap_ns = 100'000'000;
  if (!before || !after) return false;
  const std::int64_t between_ns = after->first - before->second;
  return -kMostOverlap_ns <= between_ns && between_ns <= kMostBetween_ns &&
         before->first < after->first;
}

/// Returns a sentence where the time between two parts is about that of the parts whose numbers are
/// not there; drives that somebody numbered are farther apart.
std::string missing_between(const PartName& before, const Extent& first, const PartName& after,
                            const Extent& second) {
  const std::uint64_t missing = after.number - before.number - 1;
  if (missing == 0 || !first || !second) return "";
  const std::int64_t between_ns = second->first - first->second;
  const auto longest_ns =
      static_cast<double>(std::max(first->second - first->first, second->second - second->first));
  const double most_ns = 1.5 * longest_ns * static_cast<double>(missing) + 2e9;
  if (between_ns < 0 || static_cast<double>(between_ns) > most_ns) return "";
  return fmt::format("{} of {}{} {} not there: {:.1f} s are missing between parts {} and {}",
                     missing == 1
                         ? fmt::format("part {}", before.number + 1)
                         : fmt::format("parts {} to {}", before.number + 1, after.number - 1),
                     before.drive, before.ending, missing == 1 ? "is" : "are",
                     1e-9 * static_cast<double>(between_ns), before.number, after.number);
}

void add_doubt(BagParts& parts, const std::string& doubt) {
  parts.doubt += (parts.doubt.empty() ? "" : "; ") + doubt;
}

/// Adds what the recorder did not close, beside the bag that it goes on from.
void doubt_about_active(BagParts& parts) {
  const auto last = part_name(parts.files.back());
  if (!last) return;
  for (const StemFile& active : list_by_stem(parts.files.back().parent_path(), {".active"})) {
    const auto name = part_name(active.file.stem());
    if (!name || std::tie(name->drive, name->ending) != std::tie(last->drive, last->ending)) {
      continue;
    }
    add_doubt(parts, active.file.filename().string() +
                         " was not closed by its recorder and is left out (rosbag reindex)");
  }
}

}  // namespace

std::vector<BagParts> group_parts(const std::vector<fs::path>& bags) {
  std::map<PartName, fs::path> parts;
  std::vector<BagParts> found;
  for (const fs::path& bag : bags) {
    const auto name = is_bag_folder(bag) ? std::nullopt : part_name(bag);
    if (name && parts.emplace(*name, bag).second) continue;
    found.push_back({"", {bag}});
  }
  const PartName* last = nullptr;
  // Opening a packed bag takes long: none is opened that is alone, and none twice.
  std::map<fs::path, Extent> extents;
  const auto extent = [&](const fs::path& bag) -> const Extent& {
    const auto [known, is_new] = extents.try_emplace(bag);
    if (is_new) known->second = extent_of(bag);
    return known->second;
  };
  for (const auto& [name, file] : parts) {
    const bool is_next =
        last != nullptr && std::tie(last->drive, last->ending) == std::tie(name.drive, name.ending);
    const std::string missing =
        is_next ? missing_between(*last, extent(found.back().files.back()), name, extent(file))
                : "";
    if (is_next && follows(extent(found.back().files.back()), extent(file))) {
      found.back().name = name.drive;
      found.back().files.push_back(file);
    } else {
      if (!missing.empty()) add_doubt(found.back(), missing);
      found.push_back({"", {file}});
    }
    if (!missing.empty()) add_doubt(found.back(), missing);
    last = &name;
  }
  for (BagParts& one : found) doubt_about_active(one);
  // Files before folders, as they were given.
  std::ranges::stable_sort(found, {}, [&](const BagParts& one) {
    return std::ranges::find(bags, one.files.front()) - bags.begin();
  });
  return found;
}

std::unique_ptr<const BagReader> open_bag(const BagParts& parts) {
  if (parts.files.size() == 1) return open_bag(parts.files.front());
  std::vector<std::unique_ptr<const BagReader>> opened;
  for (const fs::path& file : parts.files) opened.push_back(open_bag(file));
  const fs::path& first = parts.files.front();
  return join_bags(
      first.parent_path() / (parts.name + "_*" + first.extension().string()), std::move(opened),
      {fmt::format("{} files are read as one drive, as their names and times say: {} to {}",
                   parts.files.size(), first.filename().string(),
                   parts.files.back().filename().string())});
}

}  // namespace mosbench
