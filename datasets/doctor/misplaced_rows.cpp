#include "datasets/doctor/misplaced_rows.hpp"

#include <algorithm>
#include <optional>
#include <set>

#include "datasets/doctor/scan_overlap.hpp"

namespace mosbench {
namespace {

Pose midway(const Pose& a, const Pose& b) {
  Pose middle = Pose::Identity();
  middle.linear() =
      Eigen::Quaterniond(a.linear()).slerp(0.5, Eigen::Quaterniond(b.linear())).toRotationMatrix();
  middle.translation() = 0.5 * (a.translation() + b.translation());
  return middle;
}

/// What `mended` puts into the row.
Pose mended_pose(const std::vector<Pose>& poses, const MisplacedRows& rows, std::size_t row) {
  if (row != rows.first && row != rows.second) return poses[row];
  if (rows.single()) return midway(poses[row - 1], poses[row + 1]);
  return poses[row == rows.first ? rows.second : rows.first];
}

/// How much shorter the way is without the row. Next to nothing on any way that is driven, also in
/// its turns, as difference_m adds up along it.
double detour_m(const std::vector<Pose>& poses, std::size_t row) {
  return difference_m(poses[row - 1], poses[row]) + difference_m(poses[row], poses[row + 1]) -
         difference_m(poses[row - 1], poses[row + 1]);
}

/// The steps into and out of the rows.
std::vector<ScanPair> pairs_around(const MisplacedRows& rows, std::size_t scans) {
  std::set<std::size_t> earlier;
  for (const std::size_t row : {rows.first, rows.second}) {
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

/// `pose_of(row)` for the pose of each.
template <typename PoseOf>
Steps steps_around(const MisplacedRows& rows, std::size_t scans, PoseOf&& pose_of) {
  Steps steps;
  for (const ScanPair& pair : pairs_around(rows, scans)) {
    const double step_m = difference_m(pose_of(pair.earlier), pose_of(pair.later));
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
    // Ends make no detour.
    const std::size_t last = poses_.size() - 1;
    consider({0, last}, suspect_at(1));
    return worst_;
  }

 private:
  struct Suspect {
    std::size_t row = 0;
    double detour_m = 0.0;
    double noise_m = 0.0;  ///< what noise makes a way detour there at most, or does not matter
    double step_m = 0.0;   ///< usual there
    double excess() const { return detour_m / noise_m; }
  };

  static constexpr double kLeastM = 0.1;

  Suspect suspect_at(std::size_t row) const {
    constexpr std::size_t kAround = 8;
    constexpr double kDetours = 4.0;
    std::vector<double> steps_m, detours_m;
    const std::size_t last = std::min(row + kAround, poses_.size() - 2);
    for (std::size_t i = row > kAround ? row - kAround : 1; i <= last; ++i) {
      steps_m.push_back(difference_m(poses_[i - 1], poses_[i]));
      detours_m.push_back(detour_m(poses_, i));
    }
    return {row, detour_m(poses_, row), std::max(kDetours * median(detours_m), kLeastM),
            median(steps_m)};
  }

  void find_suspects() {
    constexpr std::size_t kMost = 12;
    for (std::size_t row = 1; row + 1 < poses_.size(); ++row) {
      if (detour_m(poses_, row) <= kLeastM) continue;
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
    const auto given = [&](std::size_t row) { return poses_[row]; };
    const auto better = [&](std::size_t row) { return mended_pose(poses_, rows, row); };
    const Steps before = steps_around(rows, poses_.size(), given),
                after = steps_around(rows, poses_.size(), better);
    double saved_m = before.sum_m - after.sum_m;
    double needed_m = std::max(suspect.step_m, suspect.noise_m);
    if (rows.single()) {
      // Noise puts a single row aside more easily than it makes two fit in one another's place.
      needed_m = 2.5 * suspect.noise_m;
      saved_m *= 0.9;
    } else if (after.longest_m > 0.75 * before.longest_m) {
      return;  // moves the jump elsewhere
    } else if (rows.second - rows.first == 1 &&
               (rows.first == 0 || rows.second + 1 == poses_.size())) {
      saved_m *= 2.0;  // the detour on the other side is beyond the end
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

}  // namespace

std::vector<Pose> mended(std::vector<Pose> poses, const MisplacedRows& rows) {
  const Pose first = mended_pose(poses, rows, rows.first);
  poses[rows.second] = mended_pose(poses, rows, rows.second);
  poses[rows.first] = first;
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

std::vector<MisplacedRows> misplaced_rows(const Sequence& sequence,
                                          const std::vector<Pose>& poses) {
  constexpr double kGain = 0.005;
  ScanOverlap scans(sequence);
  std::vector<MisplacedRows> misplaced;
  std::vector<Pose> before = poses;
  for (const MisplacedRows& rows : suspected_rows(poses)) {
    std::vector<Pose> after = mended(before, rows);
    double gain = 0.0, pairs = 0.0;
    for (const ScanPair& pair : pairs_around(rows, poses.size())) {
      if (!scans.can_tell(pair)) continue;
      gain += scans.overlap(pair, relative(after, pair));
      gain -= scans.overlap(pair, relative(before, pair));
      pairs += 1.0;
    }
    if (gain <= kGain * pairs) continue;
    misplaced.push_back(rows);
    before = std::move(after);
  }
  return misplaced;
}

}  // namespace mosbench
