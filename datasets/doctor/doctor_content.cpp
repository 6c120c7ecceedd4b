#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <set>
#include <unordered_map>

#include "datasets/doctor/doctor.hpp"
#include "datasets/files/files.hpp"
#include "datasets/files/point_range.hpp"
#include "datasets/layouts/layout.hpp"

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
    check_returns();
    check_ids();
    check_stamps();
    check_frozen();
    return std::move(symptoms_);
  }

 private:
  void warn(std::string what) {
    symptoms_.push_back({Severity::kWarning, sequence_.name(), std::move(what)});
  }

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

  void count_scan(std::size_t scan_index) {
    const Frame frame = sequence_.read(scan_index);
    ++checkup_.scans_read;
    for (std::size_t i = 0; i < frame.points.size(); ++i) {
      const double range_m = mosbench::range_m(frame.points[i]);
      ++checkup_.points;
      if (!std::isfinite(range_m)) {
        ++checkup_.nonfinite_points;
      } else if (range_m == 0.0) {
        ++checkup_.zero_points;
      } else {
        const auto bin = std::ranges::lower_bound(range_bins_m(), range_m);
        ++checkup_.points_of_range[std::min(static_cast<std::size_t>(bin - range_bins_m().begin()),
                                            range_bins_m().size() - 1)];
        if (range_m > expected_.sensor_range_m) ++beyond_sensor_;
      }
      if (frame.truth) count_label((*frame.truth)[i], range_m);
    }
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

  void check_returns() {
    const std::size_t returns = checkup_.points - checkup_.zero_points - checkup_.nonfinite_points;
    if (checkup_.nonfinite_points > 0) {
      warn(fmt::format("{} of {} points are NaN or infinite; expected numbers",
                       checkup_.nonfinite_points, checkup_.points));
    }
    const auto share = [](std::size_t part, std::size_t whole) {
      return static_cast<double>(part) / static_cast<double>(std::max<std::size_t>(whole, 1));
    };
    if (checkup_.points > 0 && share(returns, checkup_.points) < kLeastReturns) {
      warn(fmt::format("{} of {} points are returns; expected most", returns, checkup_.points));
    }
    if (share(beyond_sensor_, returns) > kMostBeyond) {
      warn(
          fmt::format("{} of {} points are farther than the {:g} m that the sensor measures; "
                      "expected metres (are these millimetres?)",
                      beyond_sensor_, returns, expected_.sensor_range_m));
    }
    if (share(checkup_.points_of_range.front(), returns) > kMostNear) {
      warn(fmt::format("nearly all points are nearer than {:g} m; expected metres",
                       range_bins_m().front()));
    }
  }

  void check_ids() {
    std::vector<std::uint32_t> unknown;
    bool learning_classes = !checkup_.points_of_id.empty() && !expected_.label_ids.empty();
    for (const auto& [id, unused] : checkup_.points_of_id) {
      if (!expected_.label_ids.empty() && !expected_.label_ids.contains(id)) unknown.push_back(id);
      learning_classes = learning_classes && id <= 2;
    }
    const bool only_unlabelled =
        checkup_.points_of_id.size() == 1 && checkup_.points_of_id.contains(0);
    if (learning_classes && !only_unlabelled) {
      warn(
          fmt::format("the labels are {}, as the classes of a network; expected the ids of the "
                      "data set ({})",
                      fmt::join(ids_present(), ", "), shortened(expected_.label_ids)));
    } else if (!unknown.empty()) {
      warn(fmt::format("the labels hold the ids {}; expected only those of the data set ({})",
                       fmt::join(unknown, ", "), shortened(expected_.label_ids)));
    }
    if (only_unlabelled) warn("all labels of the scans read are 0; expected labelled points");
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

  void check_stamps() {
    std::size_t backward = 0;
    std::string first;
    for (std::size_t i = 1; i < sequence_.size(); ++i) {
      const auto before = sequence_.stamp_ns(i - 1);
      const auto after = sequence_.stamp_ns(i);
      if (!before || !after || *before < *after) continue;
      if (backward++ == 0) first = sequence_.stem(i);
    }
    if (backward == 0) return;
    warn(
        fmt::format("{} stamps are not later than the one before, first that of scan {}; expected "
                    "them in order",
                    backward, first));
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
  std::size_t beyond_sensor_ = 0, labels_beyond_ = 0;
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
