#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <bitset>
#include <cmath>
#include <cstring>
#include <fstream>
#include <numbers>
#include <numeric>
#include <set>
#include <unordered_map>

#include "datasets/disk/files.hpp"
#include "datasets/disk/folder_listing.hpp"
#include "datasets/doctor/doctor.hpp"
#include "datasets/formats/label_formats.hpp"
#include "datasets/formats/point_range.hpp"
#include "datasets/formats/scan_file.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

/// Single scans are upside down in which a larger share of flat places is above the sensor, of at
/// least this many, while as many scans have at most this share there.
constexpr double kMostAboveUpright = 0.2;
constexpr std::size_t kFewestFlatOfScan = 100, kFewestTurned = 2;
/// A return is at least so far away.
constexpr double kNearestReturnM = 0.3;

/// Returns the value with its bytes in reverse order.
float reversed(float value) {
  return std::bit_cast<float>(__builtin_bswap32(std::bit_cast<std::uint32_t>(value)));
}

/// Returns size and the bytes at both ends.
std::string ends_of_file(const std::filesystem::path& file) {
  constexpr std::uintmax_t kEndBytes = 2048;
  const std::uintmax_t size_bytes = size_of(file);
  const std::uintmax_t count = std::min(kEndBytes, size_bytes);
  std::string ends(2 * count, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(ends.data(), static_cast<std::streamsize>(count));
  in.seekg(static_cast<std::streamoff>(size_bytes - count));
  in.read(ends.data() + count, static_cast<std::streamsize>(count));
  return std::to_string(size_bytes) + " " + ends;
}

/// The sectors around the sensor, of 5 degrees, in which there are points.
using Directions = std::bitset<72>;

Directions directions_of(const std::vector<Point>& points) {
  Directions seen;
  for (const Point& point : points) {
    const double range = range_m(point);
    if (!(range > kNearestReturnM) || !std::isfinite(range)) continue;
    const double turns = 0.5 + std::atan2(point.y, point.x) / (2.0 * std::numbers::pi);
    seen.set(std::min(static_cast<std::size_t>(turns * static_cast<double>(seen.size())),
                      seen.size() - 1));
  }
  return seen;
}

bool same_points(const std::vector<Point>& a, const std::vector<Point>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Point)) == 0;
}

/// Returns evenly spread scans, and as many of the labelled ones.
std::set<std::size_t> sampled_scans(const Sequence& sequence, std::size_t most) {
  std::vector<std::size_t> all(sequence.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  const auto any = picked(all, most / 2);
  const auto labelled = picked(scans_with_truth(sequence), most / 2);
  std::set<std::size_t> sampled(any.begin(), any.end());
  sampled.insert(labelled.begin(), labelled.end());
  return sampled;
}

class ContentCount {
 public:
  ContentCount(const Sequence& sequence, const LayoutContent& expected, std::size_t most_scans,
               SequenceCheckup& checkup)
      : sequence_(sequence), expected_(expected), most_scans_(most_scans), checkup_(checkup) {}

  void run() {
    checkup_.points_of_range.assign(range_bins_m().size(), 0);
    for (const std::size_t scan_index : sampled_scans(sequence_, most_scans_))
      count_scan(scan_index);
    if (has_only_unlabelled()) {
      // Those read have no label by chance where key frames alone are labelled.
      for (const std::size_t scan_index : picked(scans_with_labels(sequence_), most_scans_ / 2)) {
        count_scan(scan_index);
      }
    }
    tell_points();
    tell_labels();
    tell_empty();
    tell_repeated();
    tell_directions();
  }

 private:
  bool has_only_unlabelled() const {
    return checkup_.points_of_id.size() == 1 && checkup_.points_of_id.contains(0);
  }

  void count_scan(std::size_t scan_index) {
    const Frame frame = sequence_.read(scan_index);
    ++checkup_.scans_read;
    count_lost(frame.points);
    count_flat(frame.points, scan_index);
    const Eigen::Vector3d place_m = sequence_.map_from_sensor(scan_index).translation();
    for (std::size_t i = 0; i < frame.points.size(); ++i) {
      const double range_m = mosbench::range_m(frame.points[i]);
      count_point(frame.points[i], range_m, place_m);
      if (frame.truth) count_label((*frame.truth)[i], range_m);
    }
  }

  void count_point(const Point& point, double range_m, const Eigen::Vector3d& place_m) {
    ++checkup_.points;
    count_byte_order(point, range_m);
    if (!std::isfinite(range_m)) {
      ++checkup_.nonfinite_points;
    } else if (range_m == 0.0) {
      ++checkup_.zero_points;
    } else {
      const auto bin = std::ranges::lower_bound(range_bins_m(), range_m) - range_bins_m().begin();
      ++checkup_
            .points_of_range[std::min(static_cast<std::size_t>(bin), range_bins_m().size() - 1)];
      if (range_m <= expected_.sensor_range_m) return;
      ++beyond_sensor_;
      const Eigen::Vector3d from_place_m = position_of(point) - place_m;
      if (from_place_m.norm() < expected_.sensor_range_m) ++near_place_;
    }
  }

  void count_byte_order(const Point& point, double range_m) {
    const auto is_in_range = [&](double range) {
      return range > kNearestReturnM && range < expected_.sensor_range_m;
    };
    if (is_in_range(range_m)) {
      ++in_range_;
    } else if (is_in_range(mosbench::range_m(
                   {reversed(point.x), reversed(point.y), reversed(point.z), 0.0F}))) {
      ++reversed_;
    }
  }

  /// Counts zeros that stand alone between returns.
  void count_lost(const std::vector<Point>& points) {
    for (std::size_t i = 1; i + 1 < points.size(); ++i) {
      if (range_m(points[i - 1]) == 0.0 || range_m(points[i + 1]) == 0.0) continue;
      ++between_returns_;
      if (range_m(points[i]) == 0.0) ++lost_between_;
    }
  }

  void count_flat(const std::vector<Point>& points, std::size_t scan_index) {
    constexpr double kNearM = 10.0;
    std::size_t flat = 0, above = 0;
    for (const Eigen::Vector3d& point_m : sparse_ground_m(points)) {
      if (point_m.norm() > kNearM) continue;
      ++flat;
      if (point_m.z() > 0.0) ++above;
    }
    flat_ += flat;
    flat_above_ += above;
    if (flat < kFewestFlatOfScan) return;
    const double share = static_cast<double>(above) / static_cast<double>(flat);
    if (share > kMostFlatAbove) turned_.push_back(scan_index);
    if (share < kMostAboveUpright) ++upright_;
  }

  void count_label(std::uint32_t label, double range_m) {
    constexpr double kToleranceM = 0.1;
    const std::uint32_t id = label & 0xFFFFU;
    ++checkup_.points_of_id[id];
    if (id == 0 || expected_.label_min_m == expected_.label_max_m) return;
    if (range_m < expected_.label_min_m - kToleranceM ||
        range_m > expected_.label_max_m + kToleranceM) {
      ++labels_beyond_;
    }
  }

  void tell_points() {
    // With fewer flat places nothing is concluded from them.
    constexpr std::size_t kFewestFlat = 500;
    Facts& facts = checkup_.facts;
    const std::size_t points = checkup_.points;
    const std::size_t returns = points - checkup_.zero_points - checkup_.nonfinite_points;
    facts["scans"] = checkup_.scans;
    facts["scans_read"] = checkup_.scans_read;
    facts["points"] = points;
    facts["nonfinite_points"] = checkup_.nonfinite_points;
    facts["returned"] = returns;
    if (points > 0) facts["returns"] = share(returns, points);
    facts["plausible_reversed"] = share(reversed_, points);
    facts["plausible"] = share(in_range_, points);
    facts["lost_between"] = share(lost_between_, between_returns_);
    facts["beyond"] = beyond_sensor_;
    facts["beyond_sensor"] = share(beyond_sensor_, returns);
    facts["near_place"] = share(near_place_, beyond_sensor_);
    facts["sensor_range_m"] = expected_.sensor_range_m;
    facts["nearest"] = share(checkup_.points_of_range.front(), returns);
    if (flat_ > kFewestFlat) facts["flat_above"] = share(flat_above_, flat_);
    checkup_.is_partly_turned = upright_ >= kFewestTurned && turned_.size() >= kFewestTurned;
    if (!checkup_.is_partly_turned) return;
    facts["turned_scans"] = turned_.size();
    facts["first_turned"] = sequence_.stem(turned_.front());
  }

  void tell_labels() {
    constexpr std::ptrdiff_t kShown = 8;
    Facts& facts = checkup_.facts;
    facts["only_unlabelled"] = std::size_t{has_only_unlabelled()};
    facts["labels_beyond"] = labels_beyond_;
    facts["label_min_m"] = expected_.label_min_m;
    facts["label_max_m"] = expected_.label_max_m;
    const std::set<std::uint32_t>& expected = expected_.label_ids;
    if (expected.empty() || checkup_.points_of_id.empty()) return;
    std::vector<std::uint32_t> ids, unknown;
    for (const auto& [id, unused] : checkup_.points_of_id) {
      ids.push_back(id);
      if (!expected.contains(id)) unknown.push_back(id);
    }
    const bool classes = ids.back() <= 2 && !has_only_unlabelled();
    facts["network_classes"] = std::size_t{classes};
    facts["unknown_ids"] = classes ? 0 : unknown.size();
    facts["ids"] = fmt::format("{}", fmt::join(ids, ", "));
    facts["unknown_names"] = fmt::format("{}", fmt::join(unknown, ", "));
    const auto count = static_cast<std::ptrdiff_t>(expected.size());
    const auto end = std::next(expected.begin(), std::min(count, kShown));
    facts["expected_ids"] =
        fmt::format("{}{}", fmt::join(expected.begin(), end, ", "), count > kShown ? ", ..." : "");
  }

  void tell_empty() {
    std::size_t empty = 0;
    for (std::size_t k = 0; k < sequence_.size(); ++k) {
      if (sequence_.point_count(k) > 0) continue;
      if (empty++ == 0) checkup_.facts["first_empty"] = sequence_.stem(k);
    }
    checkup_.facts["empty_scans"] = empty;
    checkup_.facts["scans_hold"] = counted(sequence_.size(), "scan holds", "scans hold");
  }

  /// Compares scans of the same size and the same bytes at both ends as a whole.
  void tell_repeated() {
    constexpr std::size_t kMost = 3;
    std::unordered_map<std::string, std::size_t> scan_of_ends;
    std::vector<std::string> repeated;
    for (const auto& [ends, scan_index] : ends_of_scans()) {
      const auto [known, added] = scan_of_ends.emplace(ends, scan_index);
      if (added) continue;
      const auto points = sequence_.read(scan_index).points;
      if (points.empty() || !same_points(points, sequence_.read(known->second).points)) continue;
      repeated.push_back(sequence_.stem(scan_index) + " as " + sequence_.stem(known->second));
      if (repeated.size() == kMost) break;
    }
    checkup_.facts["repeated_scans"] = repeated.size();
    checkup_.facts["repeated_names"] = fmt::format("{}", fmt::join(repeated, ", "));
  }

  /// Returns a key per scan; scans of equal keys are compared. Scans in a file of their own have
  /// the ends of the file, some scans of a bag that of the next one.
  std::vector<std::pair<std::string, std::size_t>> ends_of_scans() const {
    std::vector<std::pair<std::string, std::size_t>> ends;
    for (std::size_t i = 0; i < sequence_.size(); ++i) {
      if (const auto file = sequence_.scan_file(i)) ends.emplace_back(ends_of_file(*file), i);
    }
    if (!ends.empty()) return ends;
    for (const std::size_t i : sampled_scans(sequence_, most_scans_)) {
      if (i % 2 == 0 || i + 1 == sequence_.size()) continue;
      ends.emplace_back(std::to_string(i), i);
      ends.emplace_back(std::to_string(i), i + 1);
    }
    return ends;
  }

  /// Compares the directions that scans in a row see.
  void tell_directions() {
    constexpr std::size_t kMostPairs = 4, kFewestPairs = 3;
    std::vector<std::size_t> starts(sequence_.size() - 1);
    std::iota(starts.begin(), starts.end(), std::size_t{0});
    std::vector<double> common;
    for (const std::size_t first : picked(starts, kMostPairs)) {
      const Directions a = directions_of(sequence_.read(first).points);
      const Directions b = directions_of(sequence_.read(first + 1).points);
      if (a.any() && b.any())
        common.push_back(share((a & b).count(), std::min(a.count(), b.count())));
    }
    if (common.size() >= kFewestPairs) checkup_.facts["common_directions"] = median(common);
  }

  const Sequence& sequence_;
  const LayoutContent& expected_;
  const std::size_t most_scans_;
  SequenceCheckup& checkup_;
  std::vector<std::size_t> turned_;  ///< scans that are upside down
  std::size_t upright_ = 0, flat_ = 0, flat_above_ = 0;
  std::size_t beyond_sensor_ = 0, near_place_ = 0, labels_beyond_ = 0;
  std::size_t in_range_ = 0, reversed_ = 0, between_returns_ = 0, lost_between_ = 0;
};

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

const std::vector<double>& range_bins_m() {
  static const std::vector<double> bins = {0.5, 3.0, 10.0, 20.0, 50.0, 80.0, 120.0, 1e300};
  return bins;
}

void examine_content(const Sequence& sequence, const LayoutContent& expected,
                     std::size_t most_scans, SequenceCheckup& checkup) {
  ContentCount(sequence, expected, most_scans, checkup).run();
}

void examine_folder(const fs::path& folder, Facts& facts) {
  if (!scan_folder_of(folder)) return;
  const auto scans = list_scans(folder);
  const auto gaps = gaps_of(scans);
  facts["gaps"] = gaps.size();
  facts["gap_names"] = some_of(gaps);
  facts["first_scan"] = scans.empty() ? "" : scans.front().stem;
  facts["last_scan"] = scans.empty() ? "" : scans.back().stem;
  if (is_there(folder / "labels")) {
    const auto labels = list_by_stem(folder / "labels", kLabelExtensions);
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
