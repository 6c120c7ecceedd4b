#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>

#include "datasets/doctor/pose_evidence.hpp"

namespace mosbench {
namespace {

// The thresholds below were checked on 40 simulated scans each of street and highway (HDL-64E,
// VLP-16), campus (Avia, OS1-64), mall (OS1-64) and street (Aeva): all of some 310 exchanged pairs
// and 80 rows moved by 2 m are named, and nothing in the right poses, also with 2 cm of noise.

/// A shorter detour is never suspected, metres: scans overlap no better without it.
constexpr double kLeastDetourM = 0.1;
/// Rows on either side that a row's usual detour and step are medians of.
constexpr std::size_t kRowsAround = 8;
/// A detour of more than this many usual ones is suspected; noise alone rarely makes one.
constexpr double kUsualDetours = 4.0;
/// A single row has to save this many times the detour that noise makes, since noise puts a single
/// row aside more easily than it makes two fit in each other's place.
constexpr double kSingleRowFactor = 2.5;
/// Share of what a single row saves that counts against exchanges: of two explanations that save
/// nearly as much, the exchange is the right one.
constexpr double kSingleRowShare = 0.9;
/// An exchange has to shorten the longest step to this share, else it moves the jump elsewhere.
constexpr double kStepShare = 0.75;
/// An exchange of the first or last two rows saves half: the other detour is beyond the end.
constexpr double kEndFactor = 2.0;

Pose midway(const Pose& a, const Pose& b) {
  Pose middle = Pose::Identity();
  middle.linear() =
      Eigen::Quaterniond(a.linear()).slerp(0.5, Eigen::Quaterniond(b.linear())).toRotationMatrix();
  middle.translation() = 0.5 * (a.translation() + b.translation());
  return middle;
}

/// Returns by how much the trajectory is shorter without the row, metres; next to nothing on real
/// trajectories, also in turns, because difference_m adds up along them.
double detour_m(const std::vector<Pose>& poses, std::size_t row) {
  return difference_m(poses[row - 1], poses[row]) + difference_m(poses[row], poses[row + 1]) -
         difference_m(poses[row - 1], poses[row + 1]);
}

/// Returns the steps into and out of the rows.
std::vector<ScanPair> pairs_around(const MisplacedRows& rows, std::size_t scans) {
  std::set<std::size_t> earlier;
  for (const std::size_t row : {rows.first, rows.last}) {
    if (row > 0) earlier.insert(row - 1);
    if (row + 1 < scans) earlier.insert(row);
  }
  std::vector<ScanPair> pairs;
  for (const std::size_t i : earlier) pairs.push_back({i, i + 1});
  return pairs;
}

struct Steps {
  double sum_m = 0.0, longest_m = 0.0;
};

/// Measures the steps around the rows.
Steps steps_around(const std::vector<Pose>& poses, const MisplacedRows& rows) {
  Steps steps;
  for (const auto& [earlier, later] : pairs_around(rows, poses.size())) {
    const double step_m = difference_m(poses[earlier], poses[later]);
    steps.sum_m += step_m;
    steps.longest_m = std::max(steps.longest_m, step_m);
  }
  return steps;
}

class Search {
 public:
  explicit Search(const std::vector<Pose>& poses) : poses_(poses) {}

  std::optional<MisplacedRows> worst() {
    find_suspects();
    for (const Suspect& suspect : suspects_) try_with_partners(suspect);
    // The first and last row make no detour.
    const std::size_t last = poses_.size() - 1;
    consider({0, last}, suspect_at(1));
    return worst_;
  }

 private:
  struct Suspect {
    std::size_t row = 0;
    double detour_m = 0.0;
    double noise_m = 0.0;  ///< detour that noise may make there, or a negligible one
    double step_m = 0.0;   ///< median around
    double excess() const { return detour_m / noise_m; }
  };

  Suspect suspect_at(std::size_t row) const {
    std::vector<double> steps_m, detours_m;
    const std::size_t last = std::min(row + kRowsAround, poses_.size() - 2);
    for (std::size_t i = row > kRowsAround ? row - kRowsAround : 1; i <= last; ++i) {
      steps_m.push_back(difference_m(poses_[i - 1], poses_[i]));
      detours_m.push_back(detour_m(poses_, i));
    }
    return {row, detour_m(poses_, row), std::max(kUsualDetours * median(detours_m), kLeastDetourM),
            median(steps_m)};
  }

  void find_suspects() {
    constexpr std::size_t kMost = 12;
    for (std::size_t row = 1; row + 1 < poses_.size(); ++row) {
      if (detour_m(poses_, row) <= kLeastDetourM) continue;
      const Suspect suspect = suspect_at(row);
      if (suspect.excess() > 1.0) suspects_.push_back(suspect);
    }
    std::ranges::sort(suspects_, std::ranges::greater(), &Suspect::excess);
    suspects_.resize(std::min(suspects_.size(), kMost));
  }

  void try_with_partners(const Suspect& suspect) {
    std::set<std::size_t> partners = {0, poses_.size() - 1, suspect.row - 1, suspect.row + 1};
    for (const Suspect& other : suspects_) partners.insert(other.row);
    for (const std::size_t partner : partners) {
      consider({std::min(suspect.row, partner), std::max(suspect.row, partner)}, suspect);
    }
  }

  void consider(const MisplacedRows& rows, const Suspect& suspect) {
    const Steps before = steps_around(poses_, rows);
    const Steps after = steps_around(mended(poses_, rows), rows);
    double saved_m = before.sum_m - after.sum_m;
    double needed_m = std::max(suspect.step_m, suspect.noise_m);
    if (rows.single()) {
      needed_m = kSingleRowFactor * suspect.noise_m;
      saved_m *= kSingleRowShare;
    } else if (after.longest_m > kStepShare * before.longest_m) {
      return;
    } else if (rows.last - rows.first == 1 && (rows.first == 0 || rows.last + 1 == poses_.size())) {
      saved_m *= kEndFactor;
    }
    if (saved_m <= std::max(needed_m, saved_m_)) return;
    saved_m_ = saved_m;
    worst_ = rows;
  }

  const std::vector<Pose>& poses_;
  std::vector<Suspect> suspects_;
  std::optional<MisplacedRows> worst_;
  double saved_m_ = 0.0;
};

std::string sentence_on(const MisplacedRows& rows, const Sequence& sequence) {
  if (rows.single()) {
    return fmt::format(
        "the pose of scan {} (row {}) does not fit between its neighbours: the trajectory jumps "
        "there and back, and scans overlap better without; expected the poses in the order of the "
        "scans",
        sequence.stem(rows.first), rows.first + 1);
  }
  return fmt::format(
      "the poses of scans {} and {} (rows {} and {}) are exchanged: the other way round the "
      "trajectory is shorter and scans overlap better; expected the poses in the order of the "
      "scans",
      sequence.stem(rows.first), sequence.stem(rows.last), rows.first + 1, rows.last + 1);
}

}  // namespace

std::vector<Pose> mended(std::vector<Pose> poses, const MisplacedRows& rows) {
  if (rows.single()) {
    poses[rows.first] = midway(poses[rows.first - 1], poses[rows.first + 1]);
  } else {
    std::swap(poses[rows.first], poses[rows.last]);
  }
  return poses;
}

std::vector<MisplacedRows> suspected_rows(std::vector<Pose> poses) {
  constexpr std::size_t kMost = 5, kFewest = 4;
  std::vector<MisplacedRows> suspected;
  if (poses.size() < kFewest) return suspected;
  while (suspected.size() < kMost) {
    const auto rows = Search(poses).worst();
    if (!rows) break;
    suspected.push_back(*rows);
    poses = mended(std::move(poses), *rows);
  }
  return suspected;
}

void examine_misplaced_rows(const Sequence& sequence, std::vector<Pose>& poses, Facts& facts) {
  ScanOverlap scans(sequence);
  std::vector<std::string> sentences;
  double largest_gain = 0.0;
  for (const MisplacedRows& rows : suspected_rows(poses)) {
    std::vector<Pose> after = mended(poses, rows);
    double gain = 0.0, pairs = 0.0;
    for (const ScanPair& pair : pairs_around(rows, poses.size())) {
      if (!scans.has_points(pair)) continue;
      gain += scans.overlap(pair, relative(after, pair));
      gain -= scans.overlap(pair, relative(poses, pair));
      pairs += 1.0;
    }
    if (pairs > 0.0) largest_gain = std::max(largest_gain, gain / pairs);
    if (gain <= kLeastRowGain * pairs) continue;
    sentences.push_back(sentence_on(rows, sequence));
    poses = std::move(after);
  }
  facts["row_gain"] = largest_gain;
  facts["misplaced_rows"] = sentences.size();
  facts["misplaced"] = fmt::format("{}", fmt::join(sentences, "\n"));
}

}  // namespace mosbench
