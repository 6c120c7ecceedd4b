#include "datasets/sequence/rig_sequence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include "datasets/formats/point_range.hpp"
#include "datasets/sequence/pose_track.hpp"
#include "datasets/sequence/stamps.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

/// Errors name this file.
const std::filesystem::path& file_of(const Recording& recording) {
  const ScanEntry& first = recording.scans.front();
  return first.file ? *first.file : recording.files.front();
}

/// The stamps of a LiDAR's scans with their indices, in order.
std::vector<std::pair<std::int64_t, std::size_t>> stamps_of(const RigLidar& lidar) {
  const Recording& recording = lidar.sequence->recording();
  std::vector<std::pair<std::int64_t, std::size_t>> stamps;
  for (const ScanEntry& scan : recording.scans) {
    if (!scan.stamp_ns) {
      throw DataError(file_of(recording), fmt::format("the scans of {} have no stamps", lidar.name),
                      "times.txt in its folder, or stamps as names, to merge LiDARs");
    }
    stamps.emplace_back(*scan.stamp_ns, stamps.size());
  }
  std::ranges::sort(stamps);
  return stamps;
}

/// "rear mounted at (-2.000, 0.000, 0.000) m, turned by 180.0 degrees".
std::string placed(const RigLidar& lidar) {
  const Eigen::Vector3d millimetres = (1e3 * lidar.first_from_this.translation()).array().round();
  const Eigen::Vector3d at_m = (millimetres / 1e3).array() + 0.0;  // no -0
  const double turn_rad = Eigen::AngleAxisd(lidar.first_from_this.linear()).angle();
  return fmt::format("{} mounted at ({:.3f}, {:.3f}, {:.3f}) m, turned by {:.1f} degrees",
                     lidar.name, at_m.x(), at_m.y(), at_m.z(), turn_rad * 180 / std::numbers::pi);
}

Point mounted(const Pose& first_from_this, const Point& point) {
  if (!is_return(point)) return point;
  const Eigen::Vector3d p = first_from_this * position_of(point);
  return {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()),
          point.intensity};
}

/// Appends a scan whose sensor is the next origin.
void append(const Frame& scan, const Pose& first_from_this, std::int64_t later_ns, Frame& frame) {
  const auto origin = static_cast<std::uint8_t>(frame.origins.positions_m.size() - 1);
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    frame.points.push_back(mounted(first_from_this, scan.points[i]));
    frame.point_times_ns.push_back(later_ns +
                                   (scan.point_times_ns.empty() ? 0 : scan.point_times_ns[i]));
    frame.origins.of_point.push_back(origin);
  }
}

}  // namespace

RigSequence::RigSequence(std::vector<RigLidar> lidars,
                         const std::vector<std::filesystem::path>& files)
    : Sequence(lidars.front().sequence->recording()), lidars_(std::move(lidars)) {
  stamps_of(lidars_.front());
  for (std::size_t i = 1; i < lidars_.size(); ++i) {
    partners_.push_back(partners_of(lidars_[i]));
    take_in(lidars_[i], partners_.back());
  }
  Recording& recording = mutable_recording();
  recording.files.insert(recording.files.end(), files.begin(), files.end());
  recording.has_radial_velocities = false;
  state();
}

/// How far partners may be away.
double RigSequence::half_step_ms() const {
  return usual_step_s(recording().scans).value_or(0.1) * 1e3 / 2;
}

RigSequence::Partners RigSequence::partners_of(const RigLidar& lidar) const {
  const auto stamps = stamps_of(lidar);
  const std::int64_t half_ns = std::llround(half_step_ms() * 1e6);
  Partners partners(recording().scans.size());
  // Who takes each scan so far, and from how far away: none is taken twice.
  std::vector<std::pair<std::int64_t, std::size_t>> takers(stamps.size(), {half_ns + 1, 0});
  for (std::size_t k = 0; k < partners.size(); ++k) {
    const std::int64_t at_ns = *recording().scans[k].stamp_ns;
    const auto after = std::ranges::lower_bound(stamps, std::pair(at_ns, std::size_t{0}));
    std::int64_t least_ns = half_ns + 1;
    for (auto near = after == stamps.begin() ? after : std::prev(after);
         near != stamps.end() && near <= after; ++near) {
      // One exactly between two scans belongs to the first.
      const std::int64_t away_ns = near < after ? at_ns - near->first + 1 : near->first - at_ns;
      if (away_ns < least_ns) partners[k] = near->second;
      least_ns = std::min(least_ns, away_ns);
    }
    if (!partners[k]) continue;
    auto& [taken_ns, taker] = takers[*partners[k]];
    if (taken_ns <= least_ns) {
      partners[k].reset();
      continue;
    }
    if (taken_ns <= half_ns) partners[taker].reset();
    taken_ns = least_ns;
    taker = k;
  }
  const auto found = std::ranges::count_if(partners, [](const auto& p) { return p.has_value(); });
  const std::string limit = fmt::format("within {:g} ms", half_step_ms());
  if (found == 0) {
    const auto first = stamps_of(lidars_.front());
    throw DataError(
        file_of(lidar.sequence->recording()),
        fmt::format("no scan of {} is {} of one of {}: they are from {:.3f} to {:.3f} s, and from "
                    "{:.3f} to {:.3f} s",
                    lidar.name, limit, lidars_.front().name, seconds_of(stamps.front().first),
                    seconds_of(stamps.back().first), seconds_of(first.front().first),
                    seconds_of(first.back().first)),
        "clocks of one time");
  }
  return partners;
}

/// Adds what is known of the scans of another LiDAR.
void RigSequence::take_in(const RigLidar& lidar, const Partners& partners) {
  Recording& all = mutable_recording();
  const Recording& own = lidar.sequence->recording();
  std::size_t missing = 0;
  for (std::size_t k = 0; k < partners.size(); ++k) {
    if (!partners[k]) {
      ++missing;
      continue;
    }
    const ScanEntry& scan = own.scans[*partners[k]];
    all.scans[k].points += scan.points;
    all.scans[k].has_truth = all.scans[k].has_truth && scan.has_truth;
  }
  const std::size_t merged_scans = partners.size() - missing;
  const bool are_few = 2 * merged_scans + 1 < std::max(partners.size(), own.scans.size());
  std::vector<std::string>& said = are_few ? all.doubts : all.remarks;
  if (missing > 0) {
    said.push_back(fmt::format("{}: {} of {} have no scan of it within {:g} ms", lidar.name,
                               missing, counted(partners.size(), "scan"), half_step_ms()));
  }
  if (own.scans.size() > merged_scans) {
    said.push_back(fmt::format("{}: {} of its {} are left out: no scan of {} is nearest",
                               lidar.name, own.scans.size() - merged_scans,
                               counted(own.scans.size(), "scan"), lidars_.front().name));
  }
  if (std::ranges::all_of(own.scans, [](const ScanEntry& scan) { return scan.points == 0; })) {
    all.doubts.push_back(lidar.name + ": all its scans are empty");
  }
  for (const auto list : {&Recording::remarks, &Recording::doubts}) {
    for (const std::string& text : own.*list) {
      (all.*list).push_back(fmt::format("{}: {}", lidar.name, text));
    }
  }
  all.mark = merged(std::move(all.mark), own.mark);
  std::vector<std::filesystem::path> files = files_of(own);
  std::erase_if(files, [&](const auto& file) {
    return std::ranges::find(all.files, file) != all.files.end();
  });
  all.files.insert(all.files.end(), files.begin(), files.end());
}

/// Says which LiDARs these are, and where.
void RigSequence::state() {
  constexpr double kFarthestM = 20.0, kSameM = 1e-3;
  Recording& all = mutable_recording();
  std::string& lidars = all.reading.lidars;
  bool are_apart = true;
  for (const RigLidar& lidar : lidars_) {
    all.lidars.push_back(lidar.name);
    lidars += lidars.empty() ? lidar.name : ", " + placed(lidar);
    if (&lidar == &lidars_.front()) continue;
    const double away_m = lidar.first_from_this.translation().norm();
    if (away_m > kFarthestM) {
      all.doubts.push_back(fmt::format("{} is mounted {:.1f} m from {}, expected at most {:g}",
                                       lidar.name, away_m, all.lidars.front(), kFarthestM));
    }
    if (away_m > kSameM) continue;
    are_apart = false;
    all.doubts.push_back(
        fmt::format("{0} is mounted where {1} is, or its scans are in the frame of {1}: rays start "
                    "at the origin of that, not at the LiDARs",
                    lidar.name, all.lidars.front()));
  }
  all.remarks.push_back("LiDARs merged: " + lidars +
                        (are_apart ? "; rays start at each point's own" : ""));
}

void RigSequence::read(std::size_t scan_index, Frame& frame) const {
  lidars_.front().sequence->read(scan_index, frame);
  frame.motions.reset();
  frame.radial_velocity_m_s.clear();
  frame.point_times_ns.resize(frame.points.size(), 0);
  frame.origins.positions_m.assign(1, Eigen::Vector3d::Zero());
  frame.origins.of_point.assign(frame.points.size(), 0);
  Frame other;
  for (std::size_t i = 0; i < partners_.size(); ++i) {
    const RigLidar& lidar = lidars_[i + 1];
    frame.origins.positions_m.push_back(lidar.first_from_this.translation());
    const std::optional<std::size_t> partner = partners_[i][scan_index];
    if (!partner) continue;
    lidar.sequence->read(*partner, other);
    append(other, lidar.first_from_this,
           *lidar.sequence->stamp_ns(*partner) - *stamp_ns(scan_index), frame);
    if (frame.truth && other.truth) {
      frame.truth->insert(frame.truth->end(), other.truth->begin(), other.truth->end());
    }
  }
  if (!has_truth(scan_index)) frame.truth.reset();
}

std::vector<std::uint32_t> RigSequence::read_truth(std::size_t scan_index) const {
  if (!has_truth(scan_index)) refuse_truth(scan_index);
  std::vector<std::uint32_t> truth = lidars_.front().sequence->read_truth(scan_index);
  for (std::size_t i = 0; i < partners_.size(); ++i) {
    if (!partners_[i][scan_index]) continue;
    const auto own = lidars_[i + 1].sequence->read_truth(*partners_[i][scan_index]);
    truth.insert(truth.end(), own.begin(), own.end());
  }
  return truth;
}

}  // namespace mosbench
