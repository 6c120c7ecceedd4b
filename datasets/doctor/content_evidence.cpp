#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <numeric>
#include <set>
#include <unordered_map>

#include "datasets/disk/files.hpp"
#include "datasets/doctor/doctor.hpp"
#include "datasets/formats/point_range.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

/// Scans read per sequence, half of them labelled ones: a checkup takes seconds.
constexpr std::size_t kScansRead = 24;
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

bool same_points(const std::vector<Point>& a, const std::vector<Point>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Point)) == 0;
}

/// Returns evenly spread scans, and as many of the labelled ones.
std::set<std::size_t> sampled_scans(const Sequence& sequence) {
  std::vector<std::size_t> all(sequence.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  const auto any = picked(all, kScansRead / 2);
  const auto labelled = picked(scans_with_truth(sequence), kScansRead / 2);
  std::set<std::size_t> sampled(any.begin(), any.end());
  sampled.insert(labelled.begin(), labelled.end());
  return sampled;
}

class ContentCount {
 public:
  ContentCount(const Sequence& sequence, const LayoutContent& expected, SequenceCheckup& checkup)
      : sequence_(sequence), expected_(expected), checkup_(checkup) {}

  void run() {
    checkup_.points_of_range.assign(range_bins_m().size(), 0);
    for (const std::size_t scan_index : sampled_scans(sequence_)) count_scan(scan_index);
    if (has_only_unlabelled()) {
      // Those read have no label by chance where key frames alone are labelled.
      for (const std::size_t scan_index : picked(scans_with_labels(sequence_), kScansRead / 2)) {
        count_scan(scan_index);
      }
    }
    tell_points();
    tell_labels();
    tell_empty();
    tell_repeated();
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
      const Eigen::Vector3d from_place_m = Eigen::Vector3d(point.x, point.y, point.z) - place_m;
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
    for (const std::size_t i : sampled_scans(sequence_)) {
      if (i % 2 == 0 || i + 1 == sequence_.size()) continue;
      ends.emplace_back(std::to_string(i), i);
      ends.emplace_back(std::to_string(i), i + 1);
    }
    return ends;
  }

  const Sequence& sequence_;
  const LayoutContent& expected_;
  SequenceCheckup& checkup_;
  std::vector<std::size_t> turned_;  ///< scans that are upside down
  std::size_t upright_ = 0, flat_ = 0, flat_above_ = 0;
  std::size_t beyond_sensor_ = 0, near_place_ = 0, labels_beyond_ = 0;
  std::size_t in_range_ = 0, reversed_ = 0, between_returns_ = 0, lost_between_ = 0;
};

}  // namespace

const std::vector<double>& range_bins_m() {
  static const std::vector<double> bins = {0.5, 3.0, 10.0, 20.0, 50.0, 80.0, 120.0, 1e300};
  return bins;
}

void examine_content(const Sequence& sequence, const LayoutContent& expected,
                     SequenceCheckup& checkup) {
  ContentCount(sequence, expected, checkup).run();
}

}  // namespace mosbench
