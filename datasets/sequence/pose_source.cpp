#include "datasets/sequence/pose_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "datasets/disk/files.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/formats/times_file.hpp"
#include "datasets/sequence/fingerprint.hpp"
#include "datasets/sequence/pose_clock.hpp"
#include "datasets/sequence/pose_mark.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

PoseTrack track_of(const PoseList& list) {
  std::vector<std::pair<std::int64_t, Pose>> stamped;
  for (std::size_t i = 0; i < list.poses.size(); ++i) {
    stamped.emplace_back(list.stamps_ns[i], list.poses[i]);
  }
  return PoseTrack(std::move(stamped));
}

/// The unit in which stamps that were read as seconds fit those of the scans; empty for none.
std::string fitting_unit(const std::vector<std::int64_t>& poses_ns,
                         const std::vector<std::int64_t>& scans_ns) {
  std::string unit;
  std::ptrdiff_t most = static_cast<std::ptrdiff_t>(scans_ns.size() / 2);
  std::int64_t divisor = 1;
  for (const char* name : {"milliseconds", "microseconds", "nanoseconds"}) {
    divisor *= 1000;
    const std::int64_t from_ns = poses_ns.front() / divisor, to_ns = poses_ns.back() / divisor;
    const auto inside = std::ranges::count_if(
        scans_ns, [&](std::int64_t at_ns) { return from_ns <= at_ns && at_ns <= to_ns; });
    if (inside <= most) continue;
    most = inside;
    unit = name;
  }
  return unit;
}

std::string hash_line(const fs::path& pose_file) {
  return fmt::format("XXH3-128 of {}: {}\n", pose_file.filename().string(),
                     hash_of_file(pose_file));
}

/// The stamps of the scans; none unless all have one.
std::vector<std::int64_t> stamps_of(const std::vector<ScanEntry>& scans) {
  std::vector<std::int64_t> stamps_ns;
  for (const ScanEntry& scan : scans) {
    if (!scan.stamp_ns) return {};
    stamps_ns.push_back(*scan.stamp_ns);
  }
  return stamps_ns;
}

class SensorPoseReader {
 public:
  SensorPoseReader(const fs::path& folder, const Reading& asked, fs::path file)
      : folder_(folder), asked_(asked), file_(std::move(file)) {}

  SensorPoses run(const std::vector<ScanEntry>& scans) {
    const PoseList list = read_list();
    result_.files.push_back(file_);
    const bool is_users = asked_.pose_file() != nullptr;
    if (is_users) result_.remarks.push_back("poses from " + file_.string());
    result_.done.source = is_users ? file_.string() : file_.filename().string();
    result_.done.format = list.format;
    pair_with_scans(list, scans);
    turn_into_lidars(list.format);
    if (!is_users) state_pose_origin(file_, result_.done, result_.doubts);
    return std::move(result_);
  }

  PoseAt at_any_time() {
    const PoseList list = read_list();
    if (list.stamps_ns.empty()) return {};
    pose_at_ = [track = track_of(list)](std::int64_t time_ns) { return track.at(time_ns); };
    turn_into_lidars(list.format);
    return std::move(pose_at_);
  }

 private:
  PoseList read_list() const {
    PoseList list = read_pose_list(file_, asked_.pose_format);
    for (std::int64_t& stamp_ns : list.stamps_ns) stamp_ns = asked_.moved_ns(stamp_ns);
    return list;
  }

  void turn_into_lidars(PoseFormat format) {
    invert_or_not(asked_.pose_direction.value_or(format == PoseFormat::kRollout
                                                     ? PoseDirection::kSensorFromMap
                                                     : PoseDirection::kMapFromSensor));
    result_.done.frame = move_to_lidar(format);
  }

  void pair_with_scans(const PoseList& list, const std::vector<ScanEntry>& scans) {
    for (std::string& doubt : list.remarks(file_)) result_.doubts.push_back(std::move(doubt));
    const TimeUnit unit =
        list.stamps_ns.empty() ? TimeUnit::kSeconds : unit_of_rows(read_file(file_), file_);
    if (unit != TimeUnit::kSeconds) {
      result_.doubts.push_back(fmt::format("the stamps of {} are taken as {}",
                                           file_.filename().string(), to_string(unit)));
    }
    const std::vector<std::int64_t> stamps_ns = stamps_of(scans);
    if (!list.stamps_ns.empty() && !stamps_ns.empty()) {
      interpolate(list, stamps_ns);
      return;
    }
    const bool lacks_stamps = !list.stamps_ns.empty() && !scans.empty();
    if (list.poses.size() != scans.size()) {
      throw DataError(file_,
                      fmt::format("{} pose rows for {} scans", list.poses.size(), scans.size()),
                      lacks_stamps ? "one per scan, or stamps of the scans (times.txt, or names "
                                     "that are stamps), by which poses are looked up"
                                   : "one per scan");
    }
    if (lacks_stamps) {
      result_.doubts.push_back(fmt::format(
          "{} has stamps and the scans have none: rows are paired with scans in their order",
          file_.filename().string()));
    }
    result_.map_from_sensor.assign(list.poses.begin(), list.poses.end());
    result_.done.pairing = "row by row";
  }

  /// Takes the poses at the stamps of the scans. Only scans that are asked for can lack one.
  void interpolate(const PoseList& list, const std::vector<std::int64_t>& all_ns) {
    result_.done.offset_s = asked_.pose_offset_s;
    const PoseTrack track = track_of(list);
    const ScanRange range = asked_.scans.value_or(ScanRange{});
    std::vector<std::int64_t> stamps_ns;
    std::size_t interpolated = 0, outside = 0, in_gaps = 0;
    for (const std::int64_t stamp_ns : all_ns) {
      const bool is_asked = range.holds(result_.map_from_sensor.size());
      if (is_asked) stamps_ns.push_back(stamp_ns);
      auto& pose = result_.map_from_sensor.emplace_back(track.near(stamp_ns, list.rounding_ns));
      if (pose) continue;
      pose = track.at(stamp_ns);
      const auto gap_ns = static_cast<double>(track.gap_ns(stamp_ns));
      if (!pose) {
        outside += is_asked;
      } else if (gap_ns <= std::round(asked_.max_pose_gap_s * 1e9)) {
        interpolated += is_asked;
      } else {
        in_gaps += is_asked;
        pose.reset();
      }
    }
    const std::size_t scans = stamps_ns.size();
    result_.done.pairing = fmt::format("by stamp, {} of {} interpolated", interpolated, scans);
    const std::string gaps =
        fmt::format("lie between poses more than {:g} s apart", asked_.max_pose_gap_s);
    if (in_gaps == scans && scans > 0) {
      throw DataError(file_, "all scans " + gaps,
                      "more poses, or a longer " + option("max_pose_gap_s"));
    }
    const std::size_t unknown = outside + in_gaps;
    const bool has_all = list.stamps_ns.size() == all_ns.size();
    const std::string clocks = compare_clocks(list.stamps_ns, has_all ? all_ns : stamps_ns);
    if (unknown > 0 && are_too_few(scans - unknown, scans)) {
      refuse_few(list.stamps_ns, stamps_ns, scans - unknown, clocks);
    }
    if (!clocks.empty()) result_.doubts.push_back(clocks);
    const auto left_out = [&](std::size_t count, const std::string& why) {
      if (count == 0) return;
      result_.doubts.push_back(
          fmt::format("{} of {} are left out: they {}", count, counted(scans, "scan"), why));
    };
    const std::string name = file_.filename().string();
    left_out(in_gaps, fmt::format("{} in {} ({})", gaps, name, option("max_pose_gap_s")));
    left_out(outside, fmt::format("are before or after the poses of {}", name));
    if (unknown > 0) {
      result_.done.pairing +=
          fmt::format("; {} of {} are left out", unknown, counted(scans, "scan"));
    }
  }

  std::string compare_clocks(const std::vector<std::int64_t>& poses_ns,
                             const std::vector<std::int64_t>& scans_ns) {
    const auto offset_ns = constant_offset_ns(poses_ns, scans_ns);
    if (!offset_ns) return "";
    const double late_s = seconds_of(*offset_ns);
    result_.done.fitting_offset_s = mending_offset_s(asked_.pose_offset_s, late_s);
    const std::string what = fmt::format(
        "all stamps of {} are {:.1f} ms {} those of the scans: if these are times of "
        "recording or of another clock, every pose is of another moment",
        file_.filename().string(), std::abs(late_s) * 1e3, late_s > 0.0 ? "after" : "before");
    return to_string(ClockDoubt{what, result_.done.fitting_offset_s});
  }

  /// What reads poses that have another clock, about: nobody knows when it began.
  std::string other_clock(const std::vector<std::int64_t>& poses_ns,
                          const std::vector<std::int64_t>& scans_ns) const {
    const double first_s = seconds_of(poses_ns.front() - scans_ns.front());
    const double last_s = seconds_of(poses_ns.back() - scans_ns.back());
    const double apart_s = std::abs(last_s - first_s), late_s = 0.5 * (first_s + last_s);
    if (apart_s > 0.5 * seconds_of(scans_ns.back() - scans_ns.front())) return "";
    return fmt::format(
        " (about {} if theirs is another)",
        option("pose_offset_s", fmt::format("{}", mending_offset_s(asked_.pose_offset_s, late_s))));
  }

  [[noreturn]] void refuse_few(const std::vector<std::int64_t>& poses_ns,
                               const std::vector<std::int64_t>& scans_ns, std::size_t posed,
                               const std::string& clocks) const {
    if (poses_ns.empty()) throw DataError(file_, "holds no pose", "poses of the scans");
    const std::string unit = fitting_unit(poses_ns, scans_ns);
    throw DataError(
        file_,
        fmt::format("holds poses for {} of {}: its stamps are {:.6f} to {:.6f} s, those of the "
                    "scans {:.6f} to {:.6f} s{}",
                    posed, counted(scans_ns.size(), "scan"), seconds_of(poses_ns.front()),
                    seconds_of(poses_ns.back()), seconds_of(scans_ns.front()),
                    seconds_of(scans_ns.back()), clocks.empty() ? "" : "; " + clocks),
        unit.empty() ? "stamps by the clock of the scans" + other_clock(poses_ns, scans_ns) +
                           ", or a longer " + option("max_pose_gap_s")
                     : "stamps in seconds: these fit as " + unit);
  }

  template <typename Turn>
  void turn_poses(const Turn& turn) {
    for (auto& pose : result_.map_from_sensor) {
      if (pose) pose = turn(*pose);
    }
    if (!pose_at_) return;
    pose_at_ = [turn, as_stored = std::move(pose_at_)](std::int64_t time_ns) {
      std::optional<Pose> pose = as_stored(time_ns);
      if (pose) pose = turn(*pose);
      return pose;
    };
  }

  void invert_or_not(PoseDirection direction) {
    result_.done.direction = direction;
    if (direction == PoseDirection::kMapFromSensor) return;
    turn_poses([](const Pose& pose) { return Pose(pose.inverse()); });
    result_.remarks.push_back(file_.filename().string() +
                              " is read as sensor_from_map: its poses are inverted");
  }

  PoseFrame move_to_lidar(PoseFormat format) {
    const fs::path calib = folder_ / "calib.txt";
    if (!is_there(calib)) {
      if (asked_.pose_frame == PoseFrame::kCamera) {
        throw DataError(calib, "does not exist", "Tr there, as the poses are those of a camera");
      }
      result_.remarks.push_back("no calib.txt: the poses are read as the lidar's");
      return PoseFrame::kLidar;
    }
    const Pose camera_from_lidar = read_calib(calib);
    result_.files.push_back(calib);
    const bool by_calib = !asked_.pose_frame && format == PoseFormat::kKitti;
    const bool of_camera = asked_.pose_frame == PoseFrame::kCamera || by_calib;
    if (!of_camera || is_identity(camera_from_lidar)) return PoseFrame::kLidar;
    if (by_calib && pose_mark(file_)) {
      result_.done.frame_by_mark = true;
      return PoseFrame::kLidar;
    }
    turn_poses([=](const Pose& pose) { return lidar_pose(pose, camera_from_lidar); });
    result_.remarks.push_back(fmt::format(
        "calib.txt holds a Tr other than the identity: {} is read as camera poses, lidar pose = "
        "Tr^-1 * P * Tr (KITTI)",
        file_.filename().string()));
    return PoseFrame::kCamera;
  }

  const fs::path& folder_;
  const Reading& asked_;
  fs::path file_;
  SensorPoses result_;
  PoseAt pose_at_;
};

/// Says where poses are expected, and names those that lie where KITTI's odometry benchmark has
/// them: poses/04.txt beside sequences/04.
MissingPoses missing_poses(const fs::path& folder, const fs::path& file) {
  const fs::path name = fs::absolute(folder / "").parent_path().filename();
  const fs::path others = folder / "../../poses";
  const std::string expected =
      is_there(others / (name.string() + ".txt"))
          ? "one pose per scan there, or " + option("poses", others.lexically_normal().string())
          : fmt::format("one pose per scan there, in a file given by {}, or found by odometry",
                        option("poses"));
  return {file, "does not exist", expected};
}

}  // namespace

bool are_too_few(std::size_t posed, std::size_t scans) {
  constexpr std::size_t kMany = 10, kFew = 2, kShare = 50;
  return posed == 0 || (scans >= kMany && (posed <= kFew || posed * kShare < scans));
}

std::string pose_origin_of(const PosesDone& poses) {
  if (!poses.origin.empty()) return poses.origin;  // of poses that were converted before
  std::string origin;
  for (const auto& [what, how] : members_of(poses)) {
    origin += fmt::format("{}{}: {}", origin.empty() ? "" : "; ", what, how);
  }
  std::ranges::replace(origin, '\n', ' ');
  return origin;
}

fs::path pose_origin_file(const fs::path& pose_file) {
  if (pose_file.extension() != ".h5") return pose_file.parent_path() / kPoseOriginFile;
  return pose_file.parent_path() / (pose_file.stem().string() + "." + kPoseOriginFile);
}

void write_pose_origin(const fs::path& pose_file, const std::string& origin,
                       const std::vector<std::string>& doubts) {
  std::string text = origin + "\n" + hash_line(pose_file);
  for (const std::string& doubt : doubts) text += shown_in_line(doubt) + "\n";
  write_file_atomic(pose_origin_file(pose_file), text);
}

void state_pose_origin(const fs::path& pose_file, PosesDone& poses,
                       std::vector<std::string>& doubts) {
  const fs::path file = pose_origin_file(pose_file);
  if (!is_there(file)) return;
  const std::string text = read_file(file);
  const std::string origin = text.substr(0, text.find('\n'));
  const std::string head = origin + "\n" + hash_line(pose_file);
  if (text.starts_with(head)) {
    poses.origin = origin;
    std::string_view rest = std::string_view(text).substr(head.size());
    while (!rest.empty()) doubts.push_back(shown_in_line(take_line(rest)));
  } else {
    doubts.push_back(fmt::format(
        "{} was not written for {} as it is now: where these poses came from is not known",
        file.filename().string(), pose_file.filename().string()));
  }
}

std::vector<std::size_t> place_scans(SensorPoses poses, Recording& recording) {
  std::vector<std::size_t> kept;
  std::vector<ScanEntry> scans = std::exchange(recording.scans, {});
  for (std::size_t k = 0; k < scans.size(); ++k) {
    scans[k].number = k;
    if (const auto& pose = poses.map_from_sensor[k]) {
      scans[k].map_from_sensor = *pose;
      kept.push_back(k);
      recording.scans.push_back(std::move(scans[k]));
    } else {
      scans[k].has_truth = false;
      recording.left_out.push_back(std::move(scans[k]));
    }
  }
  recording.files.insert(recording.files.end(), poses.files.begin(), poses.files.end());
  recording.remarks.insert(recording.remarks.end(), poses.remarks.begin(), poses.remarks.end());
  recording.doubts.insert(recording.doubts.end(), poses.doubts.begin(), poses.doubts.end());
  recording.reading.poses = std::move(poses.done);
  return kept;
}

std::vector<std::size_t> place_scans(const fs::path& folder, const std::string& own_file,
                                     const Reading& asked, Recording& recording) {
  if (asked.is_by_odometry()) {
    const std::vector<std::optional<Pose>> unposed(recording.scans.size(), Pose::Identity());
    return place_scans({.map_from_sensor = unposed, .done = {.source = std::string(kNoPoses)}},
                       recording);
  }
  const fs::path file = asked.has_own_poses() ? folder / own_file : *asked.pose_file();
  if (asked.has_own_poses() && !is_there(file)) throw missing_poses(folder, file);
  return place_scans(SensorPoseReader(folder, asked, file).run(recording.scans), recording);
}

PoseAt stamped_poses(const fs::path& folder, const std::string& own_file, const Reading& asked) {
  if (asked.is_by_odometry()) return {};
  const fs::path file = asked.has_own_poses() ? folder / own_file : *asked.pose_file();
  return SensorPoseReader(folder, asked, file).at_any_time();
}

SensorPoses own_poses(std::string source, const fs::path& file) {
  SensorPoses poses;
  poses.done = {.source = std::move(source),
                .direction = PoseDirection::kMapFromSensor,
                .frame = PoseFrame::kLidar};
  state_pose_origin(file, poses.done, poses.doubts);
  return poses;
}

}  // namespace mosbench
