#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <set>
#include <unordered_map>

#include "datasets/disk/files.hpp"
#include "datasets/doctor/doctor.hpp"
#include "datasets/doctor/registration.hpp"
#include "datasets/doctor/truth_check.hpp"
#include "datasets/formats/point_range.hpp"
#include "datasets/layouts/layout.hpp"
#include "datasets/text/counted.hpp"

namespace mosbench {
namespace {

/// Scans read per sequence, half of them labelled ones: a checkup takes seconds.
constexpr std::size_t kScansRead = 24;
/// A smaller share of returns among the points comes from a wrong export, whatever the scene.
constexpr double kLeastReturns = 0.05;
/// A larger share of points beyond the sensor's range comes from another unit than metres, in which
/// nearly all points are beyond it; single outliers are fewer.
constexpr double kMostBeyond = 0.01;
/// A larger share of returns in the first bin of ranges (0.5 m) comes from a larger unit than
/// metres.
constexpr double kMostNear = 0.99;

/// Share of zeros between two returns above which they were zeroed: a sensor loses few single
/// returns (up to 0.05), while whole regions have none.
constexpr double kMostLostBetween = 0.1;
/// Share of the flat surfaces around the sensor that may be above it, unless it hangs upside down.
constexpr double kMostAbove = 0.8;
/// Single scans are upside down in which more are above it, of at least this many, while as many
/// scans have at most this share there.
constexpr std::size_t kFewestFlatOfScan = 100, kFewestTurned = 2;
constexpr double kMostAboveUpright = 0.2;
/// With fewer flat places nothing is concluded from them.
constexpr std::size_t kFewestFlat = 500;
/// Share of the points beyond the sensor's range that are near its pose in the map.
constexpr double kMostNearPlace = 0.5;
/// Share of the points that are in range only with their bytes in reverse order.
constexpr double kMostReversed = 0.5;
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

class ContentCheck {
 public:
  ContentCheck(const Sequence& sequence, DatasetKind kind, SequenceCheckup& checkup)
      : sequence_(sequence), expected_(layout_of(kind).files), checkup_(checkup) {}

  std::vector<Symptom> run() {
    checkup_.points_of_range.assign(range_bins_m().size(), 0);
    for (const std::size_t scan_index : sampled_scans()) count_scan(scan_index);
    if (has_only_unlabelled()) count_labelled_scans();
    check_empty();
    check_returns();
    check_ids();
    check_frozen();
    return std::move(symptoms_);
  }

 private:
  void warn(std::string what) {
    symptoms_.push_back({Severity::kWarning, sequence_.name(), std::move(what)});
  }

  double measure(const char* name, double value) { return checkup_.measures[name] = value; }

  /// Returns evenly spread scans, and as many of the labelled ones.
  std::set<std::size_t> sampled_scans() const {
    const std::vector<std::size_t> labelled = scans_with_truth(sequence_);
    std::set<std::size_t> sampled;
    for (std::size_t i = 0; i < kScansRead / 2; ++i) {
      sampled.insert(i * sequence_.size() / (kScansRead / 2));
      if (!labelled.empty()) sampled.insert(labelled[i * labelled.size() / (kScansRead / 2)]);
    }
    return sampled;
  }

  bool has_only_unlabelled() const {
    return checkup_.points_of_id.size() == 1 && checkup_.points_of_id.contains(0);
  }

  /// Those read have none by chance where key frames alone are labelled.
  void count_labelled_scans() {
    const std::vector<std::size_t> labelled = scans_with_labels(sequence_);
    const std::size_t count = std::min(kScansRead / 2, labelled.size());
    for (std::size_t i = 0; i < count; ++i) count_scan(labelled[i * labelled.size() / count]);
  }

  void count_scan(std::size_t scan_index) {
    const Frame frame = sequence_.read(scan_index);
    ++checkup_.scans_read;
    count_lost(frame.points);
    count_flat(frame.points, scan_index);
    const Eigen::Vector3d place_m = sequence_.map_from_sensor(scan_index).translation();
    for (std::size_t i = 0; i < frame.points.size(); ++i) {
      const double range_m = mosbench::range_m(frame.points[i]);
      ++checkup_.points;
      count_byte_order(frame.points[i], range_m);
      if (!std::isfinite(range_m)) {
        ++checkup_.nonfinite_points;
      } else if (range_m == 0.0) {
        ++checkup_.zero_points;
      } else {
        const auto bin = std::ranges::lower_bound(range_bins_m(), range_m);
        ++checkup_.points_of_range[std::min(static_cast<std::size_t>(bin - range_bins_m().begin()),
                                            range_bins_m().size() - 1)];
        if (range_m > expected_.sensor_range_m) {
          ++beyond_sensor_;
          const Point& point = frame.points[i];
          if ((Eigen::Vector3d(point.x, point.y, point.z) - place_m).norm() <
              expected_.sensor_range_m) {
            ++near_place_;
          }
        }
      }
      if (frame.truth) count_label((*frame.truth)[i], range_m);
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
    if (share > kMostAbove) turned_.push_back(scan_index);
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

  void check_empty() {
    std::vector<std::size_t> empty;
    for (std::size_t k = 0; k < sequence_.size(); ++k) {
      if (sequence_.point_count(k) == 0) empty.push_back(k);
    }
    if (empty.empty()) return;
    warn(fmt::format("{} of {} no points, first {}; expected some in every scan", empty.size(),
                     counted(sequence_.size(), "scan holds", "scans hold"),
                     sequence_.stem(empty.front())));
  }

  void check_returns() {
    const std::size_t returns = checkup_.points - checkup_.zero_points - checkup_.nonfinite_points;
    const auto share = [](std::size_t part, std::size_t whole) {
      return static_cast<double>(part) / static_cast<double>(std::max<std::size_t>(whole, 1));
    };
    const double beyond = measure("beyond_sensor", share(beyond_sensor_, returns));
    const double near = measure("nearest", share(checkup_.points_of_range.front(), returns));
    const double measured = measure("returns", share(returns, checkup_.points));
    const double lost = measure("lost_between", share(lost_between_, between_returns_));
    if (measure("plausible_reversed", share(reversed_, checkup_.points)) > kMostReversed) {
      warn(fmt::format(
          "{:.0f} % of the points are in range when their bytes are reversed, {:.0f} % "
          "as they are; expected little-endian floats",
          100.0 * share(reversed_, checkup_.points), 100.0 * share(in_range_, checkup_.points)));
      return;
    }
    if (checkup_.nonfinite_points > 0) {
      warn(fmt::format("{} of {} points are NaN or infinite; expected numbers",
                       checkup_.nonfinite_points, checkup_.points));
    }
    if (checkup_.points > 0 && measured < kLeastReturns) {
      warn(fmt::format("{} of {} points are returns; expected most", returns, checkup_.points));
    }
    if (lost > kMostLostBetween) {
      warn(fmt::format("{:.0f} % of the points between two returns are (0, 0, 0); expected returns",
                       100.0 * lost));
    }
    if (flat_ > kFewestFlat && measure("flat_above", share(flat_above_, flat_)) > kMostAbove) {
      warn(
          fmt::format("{:.0f} % of the flat surfaces within 10 m are above the sensor; expected "
                      "the ground below it (are the points upside down, z with the wrong sign?)",
                      100.0 * share(flat_above_, flat_)));
    }
    check_turned();
    if (beyond > kMostBeyond && share(near_place_, beyond_sensor_) > kMostNearPlace) {
      warn(
          fmt::format("{} of {} points are farther than the {:g} m that the sensor measures, but "
                      "near its pose; expected points in the sensor's frame (are these in the "
                      "map's?)",
                      beyond_sensor_, returns, expected_.sensor_range_m));
    } else if (beyond > kMostBeyond) {
      warn(
          fmt::format("{} of {} points are farther than the {:g} m that the sensor measures; "
                      "expected metres (are these millimetres or feet?)",
                      beyond_sensor_, returns, expected_.sensor_range_m));
    }
    if (near > kMostNear) {
      warn(fmt::format("nearly all points are nearer than {:g} m; expected metres",
                       range_bins_m().front()));
    }
  }

  /// Checks whether only some scans are upside down: with none upright, all are.
  void check_turned() {
    if (turned_.size() < kFewestTurned || upright_ < kFewestTurned) return;
    checkup_.is_partly_turned = true;
    warn(
        fmt::format("in {} of {} scans read, first {}, the flat surfaces within 10 m are above the "
                    "sensor, in others below; expected the ground below it (has z the wrong sign "
                    "there? the poses were not checked)",
                    turned_.size(), checkup_.scans_read, sequence_.stem(turned_.front())));
  }

  void check_ids() {
    std::vector<std::uint32_t> unknown;
    bool learning_classes = !checkup_.points_of_id.empty() && !expected_.label_ids.empty();
    for (const auto& [id, unused] : checkup_.points_of_id) {
      if (!expected_.label_ids.empty() && !expected_.label_ids.contains(id)) unknown.push_back(id);
      learning_classes = learning_classes && id <= 2;
    }
    const bool only_unlabelled = has_only_unlabelled();
    if (learning_classes && !only_unlabelled) {
      warn(
          fmt::format("the labels are {}, as the classes of a network; expected the ids of the "
                      "data set ({})",
                      fmt::join(ids_present(), ", "), shortened(expected_.label_ids)));
    } else if (!unknown.empty()) {
      warn(fmt::format("the labels hold the ids {}; expected only those of the data set ({})",
                       fmt::join(unknown, ", "), shortened(expected_.label_ids)));
    }
    if (only_unlabelled) warn("all labels of all scans are 0; expected labelled points");
    if (labels_beyond_ > 0) {
      warn(
          fmt::format("{} labelled points lie outside of {:g} to {:g} m; expected id 0 there, as "
                      "published",
                      labels_beyond_, expected_.label_min_m, expected_.label_max_m));
    }
  }

  std::vector<std::uint32_t> ids_present() const {
    std::vector<std::uint32_t> ids;
    for (const auto& [id, unused] : checkup_.points_of_id) ids.push_back(id);
    return ids;
  }

  static std::string shortened(const std::set<std::uint32_t>& ids) {
    constexpr std::ptrdiff_t kShown = 8;
    const auto count = static_cast<std::ptrdiff_t>(ids.size());
    return fmt::format(
        "{}{}", fmt::join(ids.begin(), std::next(ids.begin(), std::min(count, kShown)), ", "),
        count > kShown ? ", ..." : "");
  }

  /// Compares scans of the same size and the same bytes at both ends as a whole.
  void check_frozen() {
    std::unordered_map<std::string, std::size_t> scan_of_ends;
    std::vector<std::string> repeated;
    for (const auto& [ends, scan_index] : ends_of_scans()) {
      const auto [known, added] = scan_of_ends.emplace(ends, scan_index);
      if (added) continue;
      const auto points = sequence_.read(scan_index).points;
      if (points.empty() || !same_points(points, sequence_.read(known->second).points)) continue;
      repeated.push_back(sequence_.stem(scan_index) + " as " + sequence_.stem(known->second));
      if (repeated.size() == 3) break;
    }
    if (repeated.empty()) return;
    warn(fmt::format("scans hold the same points: {}; expected every scan once",
                     fmt::join(repeated, ", ")));
  }

  /// Returns a key per scan; scans of equal keys are compared. Scans in a file of their own have
  /// the ends of the file, some scans of a bag that of the next one.
  std::vector<std::pair<std::string, std::size_t>> ends_of_scans() const {
    std::vector<std::pair<std::string, std::size_t>> ends;
    for (std::size_t i = 0; i < sequence_.size(); ++i) {
      if (const auto file = sequence_.scan_file(i)) ends.emplace_back(ends_of_file(*file), i);
    }
    if (!ends.empty()) return ends;
    for (const std::size_t i : sampled_scans()) {
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
  std::size_t upright_ = 0;
  std::size_t beyond_sensor_ = 0, near_place_ = 0, labels_beyond_ = 0;
  std::size_t in_range_ = 0, reversed_ = 0;
  std::size_t between_returns_ = 0, lost_between_ = 0, flat_ = 0, flat_above_ = 0;
  std::vector<Symptom> symptoms_;
};

}  // namespace

const std::vector<double>& range_bins_m() {
  static const std::vector<double> bins = {0.5, 3.0, 10.0, 20.0, 50.0, 80.0, 120.0, 1e300};
  return bins;
}

std::vector<Symptom> check_content(const Sequence& sequence, DatasetKind kind,
                                   SequenceCheckup& checkup) {
  return ContentCheck(sequence, kind, checkup).run();
}

}  // namespace mosbench
