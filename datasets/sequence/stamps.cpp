#include "datasets/sequence/stamps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "datasets/disk/files.hpp"
#include "datasets/disk/folder_listing.hpp"
#include "datasets/formats/times_file.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/numbers.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

constexpr double kShortestStep_s = 0.005, kLongestStep_s = 5.0;
constexpr std::size_t kMostJudgedScans = 64;

/// The unit of whole numbers in names; nothing for the numbers of scans. Small numbers that count
/// in steps of some milliseconds or seconds are numbers.
std::optional<TimeUnit> unit_of_stems(const std::vector<double>& numbers) {
  constexpr double kSmallestStepOfStamps = 5000.0, kOldestStampStem = 1e15;
  const auto since_1970 = unit_since_1970(numbers.front());
  const double step = usual_step(numbers);
  const auto by_step = unit_within(step, kShortestStep_s, kLongestStep_s);
  // Seconds and milliseconds could as well be numbers that begin with a date.
  if (by_step && by_step == since_1970 && step >= 5.0) return by_step;
  if (by_step && step >= kSmallestStepOfStamps) return by_step;
  if (numbers.front() < kOldestStampStem) return std::nullopt;
  return since_1970.value_or(TimeUnit::kNanoseconds);
}

std::int64_t ns_per(TimeUnit unit) {
  constexpr std::array<std::int64_t, 4> kNs = {1'000'000'000, 1'000'000, 1'000, 1};
  return kNs.at(static_cast<std::size_t>(unit));
}

void state_unit(Recording& recording, const std::string& where, TimeUnit unit, double step) {
  recording.reading.stamps = to_string(unit);
  recording.doubts.push_back(fmt::format(
      "stamps: {} of {} scans are taken as {}, these are {:g} s apart", where,
      recording.scans.size(), to_string(unit), step * 1e-9 * static_cast<double>(ns_per(unit))));
}

/// The stamp of a name as 1700000000.1 or 1700000000_100000000, seconds and their decimals.
std::optional<std::int64_t> stamp_of_parts_ns(std::string_view stem) {
  const std::size_t between = stem.find_first_of("._");
  if (between == stem.npos) return std::nullopt;
  const auto seconds = parse_unsigned(stem.substr(0, between));
  const std::string_view decimals = stem.substr(between + 1);
  // Without a point only nine digits are surely nanoseconds.
  const bool is_fraction = stem[between] == '.' || decimals.size() == 9;
  if (!seconds || !is_fraction || !parse_unsigned(decimals)) return std::nullopt;
  if (unit_since_1970(static_cast<double>(*seconds)) != TimeUnit::kSeconds) return std::nullopt;
  return parse_seconds_as_ns(fmt::format("{}.{}", *seconds, decimals));
}

/// Throws DataError for nanoseconds without the zeros before them, which are no decimals: none
/// begins with a zero, and they end with some, or are many.
void expect_decimals(const Recording& recording) {
  constexpr std::size_t kNanoseconds = 9, kMany = 30;
  bool ends_with_zero = recording.scans.size() >= kMany, begins_with_zero = false;
  const ScanEntry* shorter = nullptr;
  for (const ScanEntry& scan : recording.scans) {
    const std::string_view stem = scan.stem;
    const std::string_view decimals = stem.substr(stem.find_first_of("._") + 1);
    if (decimals.size() > kNanoseconds) return;
    begins_with_zero |= decimals.size() > 1 && decimals.starts_with('0');
    if (decimals.size() == kNanoseconds) {
      ends_with_zero |= decimals.ends_with('0');
    } else {
      shorter = &scan;
    }
  }
  const bool has_nanoseconds = std::ranges::any_of(recording.scans, [](const ScanEntry& scan) {
    return scan.stem.size() - scan.stem.find_first_of("._") == kNanoseconds + 1;
  });
  if (shorter == nullptr || !has_nanoseconds || begins_with_zero || !ends_with_zero) return;
  throw DataError(shorter->file.value_or(shorter->stem),
                  "seems to be called by seconds and nanoseconds without the zeros before these",
                  "nine digits in every name, as 1700000000.020000000");
}

/// Returns whether all scans are called so.
bool stamp_by_parts(Recording& recording) {
  std::vector<std::int64_t> stamps_ns;
  for (const ScanEntry& scan : recording.scans) {
    const auto stamp_ns = stamp_of_parts_ns(scan.stem);
    if (!stamp_ns) return false;
    stamps_ns.push_back(*stamp_ns);
  }
  expect_decimals(recording);
  for (std::size_t k = 0; k < stamps_ns.size(); ++k) recording.scans[k].stamp_ns = stamps_ns[k];
  return true;
}

void stamp_by_stems(Recording& recording) {
  if (stamp_by_parts(recording)) {
    state_unit(recording, "the names", TimeUnit::kSeconds,
               usual_step_s(recording.scans).value_or(0.0));
    return;
  }
  std::vector<std::uint64_t> stems;
  std::vector<double> numbers;
  for (const ScanEntry& scan : recording.scans) {
    const auto number = stem_number(scan.stem);
    if (!number) return;
    stems.push_back(*number);
    numbers.push_back(static_cast<double>(*number));
  }
  const auto unit = unit_of_stems(numbers);
  if (!unit) return;
  const auto most = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  const auto ns = static_cast<std::uint64_t>(ns_per(*unit));
  if (std::ranges::any_of(stems, [&](std::uint64_t stem) { return stem > most / ns; })) return;
  for (std::size_t k = 0; k < stems.size(); ++k) {
    recording.scans[k].stamp_ns = static_cast<std::int64_t>(stems[k] * ns);
  }
  if (*unit != TimeUnit::kNanoseconds) {
    state_unit(recording, "the names", *unit, usual_step(numbers));
  }
}

void stamp_by_file(const std::filesystem::path& file, Recording& recording) {
  const std::string text = read_file(file);
  const std::vector<double> numbers = parse_time_numbers(text, file);
  if (numbers.size() != recording.scans.size()) {
    throw DataError(file,
                    fmt::format("{} times for {} scans", numbers.size(), recording.scans.size()),
                    "one per scan");
  }
  const TimeUnit unit = unit_of_stamps(numbers);
  const std::vector<std::int64_t> stamps_ns = parse_times(text, file, unit);
  for (std::size_t k = 0; k < stamps_ns.size(); ++k) {
    recording.scans[k].stamp_ns = stamps_ns[k];
  }
  recording.files.push_back(file);
  if (unit != TimeUnit::kSeconds) {
    state_unit(recording, file.filename().string(), unit, usual_step(numbers));
  }
}

/// Rings and other small whole numbers may be milliseconds by their span alone.
bool may_be_rings(std::span<const StoredTimes> scans) {
  return std::ranges::all_of(scans, [](const StoredTimes& scan) {
    return std::ranges::all_of(scan.times, [](double time) {
      return time >= 0.0 && time < 256.0 && time == std::floor(time);
    });
  });
}

}  // namespace

std::optional<double> usual_step_s(const std::vector<ScanEntry>& scans) {
  std::vector<double> stamps_s;
  for (const ScanEntry& scan : scans) {
    if (scan.stamp_ns) stamps_s.push_back(1e-9 * static_cast<double>(*scan.stamp_ns));
  }
  const double step_s = usual_step(stamps_s);
  if (step_s < kShortestStep_s || step_s > kLongestKept_s) return std::nullopt;
  return step_s;
}

void read_stamps(const std::filesystem::path& folder, Recording& recording) {
  const std::filesystem::path times = folder / "times.txt";
  if (is_there(times)) return stamp_by_file(times, recording);
  stamp_by_stems(recording);
}

PointClock judged_clock(Recording& recording,
                        const std::function<std::vector<double>(std::size_t)>& read,
                        std::optional<TimeUnit> told, bool is_named) {
  const std::size_t all = recording.scans.size(), judged = std::min(all, kMostJudgedScans);
  std::vector<StoredTimes> scans;
  for (std::size_t i = 0; i < judged; ++i) {
    const std::size_t k = i * all / judged;
    scans.push_back({read(k), recording.scans[k].stamp_ns});
  }
  std::erase_if(scans, [](const StoredTimes& scan) { return scan.times.empty(); });
  const bool are_rings = !told && !is_named && may_be_rings(scans);
  if (are_rings) scans.clear();
  PointClock clock(scans, usual_step_s(recording.scans), told);
  recording.reading.point_times =
      are_rings ? "not used, the fifth column holds whole numbers as rings do" : clock.text();
  const std::string found = "point times: " + recording.reading.point_times;
  (clock.is_odd() ? recording.doubts : recording.remarks).push_back(found);
  if (!clock.doubt().empty()) recording.doubts.push_back("point times: " + clock.doubt());
  return clock;
}

std::optional<TimeUnit> told_unit(const Reading& asked) {
  if (!asked.point_times || *asked.point_times < PointTimes::kSeconds) return std::nullopt;
  return static_cast<TimeUnit>(static_cast<int>(*asked.point_times) -
                               static_cast<int>(PointTimes::kSeconds));
}

}  // namespace mosbench
