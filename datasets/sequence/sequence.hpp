#pragma once

#include <Eigen/Core>
#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mosbench/scan.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "datasets/sequence/reading.hpp"
#include "datasets/sequence/simulated_origin.hpp"

namespace mosbench {

/// Folders of a file per scan that a run keeps beside its result.json.
inline constexpr std::array<std::string_view, 4> kScanFileFolders = {"labels", "scores", "reasons",
                                                                     "moving"};

/// Name of a sequence, which is also its folder below those of results: the name of a folder, or
/// two with a slash between as in "station/sequence_1".
class SequenceName {
 public:
  SequenceName() = default;
  /// Takes what `file`, a result.json or the sequence's folder, says. Throws DataError naming it
  /// unless every part is UTF-8 of 1 to 255 bytes without control characters, no "." or "..", and
  /// none that results use themselves: kScanFileFolders, result.json, *.partial, *.replaced.
  SequenceName(std::string text, const std::filesystem::path& file);

  const std::string& text() const { return text_; }
  operator const std::string&() const { return text_; }
  /// Relative, and below the folder that it is appended to.
  std::filesystem::path folder() const { return text_; }
  auto operator<=>(const SequenceName&) const = default;

 private:
  std::string text_;
};

/// What is known of a scan before it is read.
struct ScanEntry {
  std::string stem;                           ///< file name without extension
  std::optional<std::filesystem::path> file;  ///< the one that holds this scan and nothing else
  std::optional<std::int64_t> stamp_ns;
  Pose map_from_sensor = Pose::Identity();  ///< LiDAR frame, at the scan's stamp
  std::size_t points = 0;
  bool has_truth = false;
  /// Among all of the sequence, from 0; when not set, none is left out before it.
  std::optional<std::size_t> number = std::nullopt;
};

/// What is known of a sequence once it is opened.
struct Recording {
  SequenceName name;  ///< unique in a data set
  std::vector<ScanEntry> scans;
  std::vector<ScanEntry> left_out;   ///< scans on disk whose pose is not known; without truth
  std::vector<ScanEntry> not_asked;  ///< scans on disk that `Reading` leaves out
  /// Files that decide what is read besides those of single scans: bag, poses, calibration, times.
  std::vector<std::filesystem::path> files;
  std::vector<std::filesystem::path> truth_files;
  /// Plain sentences on what was assumed (pose frame), and on what makes numbers doubtful (scans
  /// left out): every output shows these.
  std::vector<std::string> remarks, doubts;
  std::vector<std::string> lidars;  ///< that are merged, in the order of the origins of rays
  DataMark mark;                    ///< of stored data that no sensor measured so
  bool is_marked_inside = false;    ///< whether what lies beside the data says nothing more
  /// What was read in which convention; two runs on the same files may differ in it.
  ReadingDone reading;
  bool has_radial_velocities = false;  ///< whether frames have them
};

/// Returns whether a stem is that of a scan that was left out, or not asked for.
bool is_left_out(const Recording& recording, const std::string& stem);

/// Returns every file that decides the content, for fingerprints: `files`, scans, `truth_files`.
std::vector<std::filesystem::path> files_of(const Recording& recording);

/// How the points of a scan move until the next one, as data sets of scene flow tell. Each list has
/// one value per point; those that may be empty are where nothing is known.
struct PointMotions {
  /// In the sensor frame of the scan, without the sensor's own motion; NaN where it is not known.
  std::vector<Eigen::Vector3f> velocities_m_s;
  /// Argoverse 2's number of the object's class, 0 for the background; may be empty.
  std::vector<std::uint8_t> classes;
  std::vector<std::uint8_t> on_ground;  ///< 1 or 0; may be empty
  std::vector<std::uint8_t> evaluated;  ///< 1 where the benchmark looks, else 0; may be empty
};

/// One scan as a data set gives it.
struct Frame {
  std::string stem;                         ///< file name without extension; names outputs
  std::vector<Point> points;                ///< sensor frame, stored order, nothing dropped
  Pose map_from_sensor = Pose::Identity();  ///< LiDAR frame
  std::optional<std::int64_t> stamp_ns;     ///< when the data set has stamps
  /// When each point was measured after the stamp; empty unless the data set has such times and has
  /// not moved the points by them.
  std::vector<std::int64_t> point_times_ns;
  RayOrigins origins;                   ///< of a rig of several LiDARs
  std::optional<PointMotions> motions;  ///< of data sets of scene flow
  /// Of the surface relative to the sensor along each point's ray, positive away from the sensor,
  /// of sensors that measure it; else empty. NaN where it is not known.
  std::vector<float> radial_velocity_m_s;
  std::optional<std::vector<std::uint32_t>> truth;  ///< raw label ids, one per point, when labelled
};

/// Makes a point a missing return, without truth.
void lose_point(Frame& frame, std::size_t point);

/// An ordered recording of one sensor. Opening it checks everything that needs no scan to be read
/// (pairing of files, numbers of poses, file sizes) and leaves it in `recording()`; reading a scan
/// checks the scan. A data set implements `read`, and `read_truth` where truth needs no points.
class Sequence {
 public:
  virtual ~Sequence() = default;
  Sequence(const Sequence&) = delete;
  Sequence& operator=(const Sequence&) = delete;

  /// Reads a scan into `frame`, whose content is replaced and whose memory is reused. Safe to call
  /// from several threads. Throws DataError.
  virtual void read(std::size_t scan_index, Frame& frame) const = 0;
  /// Reads the truth of a labelled scan, without its points where the format allows; one raw label
  /// id per point. Safe to call from several threads. Throws DataError.
  virtual std::vector<std::uint32_t> read_truth(std::size_t scan_index) const;

  /// Memory of scans that are kept after reading, for others who read them.
  virtual std::size_t kept_bytes() const { return 0; }

  Frame read(std::size_t scan_index) const {
    Frame frame;
    read(scan_index, frame);
    return frame;
  }

  /// What is known without reading a scan.
  const Recording& recording() const { return recording_; }
  const ScanEntry& scan(std::size_t scan_index) const { return recording_.scans.at(scan_index); }
  const std::string& name() const { return recording_.name.text(); }
  std::size_t size() const { return recording_.scans.size(); }
  const std::string& stem(std::size_t scan_index) const { return scan(scan_index).stem; }
  bool has_truth(std::size_t scan_index) const { return scan(scan_index).has_truth; }
  const std::optional<std::filesystem::path>& scan_file(std::size_t scan_index) const {
    return scan(scan_index).file;
  }
  const Pose& map_from_sensor(std::size_t scan_index) const {
    return scan(scan_index).map_from_sensor;
  }
  std::optional<std::int64_t> stamp_ns(std::size_t scan_index) const {
    return scan(scan_index).stamp_ns;
  }
  std::size_t point_count(std::size_t scan_index) const { return scan(scan_index).points; }
  std::vector<std::filesystem::path> files() const { return files_of(recording_); }
  const std::vector<std::string>& remarks() const { return recording_.remarks; }
  const ReadingDone& reading() const { return recording_.reading; }
  const DataMark& mark() const { return recording_.mark; }
  void set_mark(DataMark mark) { recording_.mark = std::move(mark); }
  void add_doubt(std::string doubt) { recording_.doubts.push_back(std::move(doubt)); }
  /// Returns what made a simulated sequence; nothing for recorded data.
  const std::optional<SimulatedOrigin>& simulated() const { return recording_.mark.simulated; }

 protected:
  Sequence() = default;
  explicit Sequence(Recording recording) : recording_(std::move(recording)) {}
  /// For constructors, which fill in what they find out.
  Recording& mutable_recording() { return recording_; }

  /// Fills in what is known without reading: stem, pose, stamp; empties times and motions.
  void describe(std::size_t scan_index, Frame& frame) const;
  /// Sets the frame's truth to that of `read_truth`, or to none.
  void add_truth(std::size_t scan_index, Frame& frame) const;
  [[noreturn]] void refuse_truth(std::size_t scan_index) const;
  /// Throws DataError where the file of a scan has another number of points than when the sequence
  /// was opened.
  void check_count(std::size_t scan_index, std::size_t points) const;

 private:
  Recording recording_;
};

/// A sequence that reads another one and changes something of it. A derived class overrides what it
/// changes; what it changes of the recording it does in its constructor.
class SequenceAround : public Sequence {
 public:
  using Sequence::read;
  void read(std::size_t scan_index, Frame& frame) const override {
    inner_->read(scan_index, frame);
  }
  std::vector<std::uint32_t> read_truth(std::size_t scan_index) const override {
    return inner_->read_truth(scan_index);
  }
  std::size_t kept_bytes() const override { return inner_->kept_bytes(); }

 protected:
  explicit SequenceAround(std::unique_ptr<Sequence> inner)
      : Sequence(inner->recording()), inner_(std::move(inner)) {}
  const Sequence& inner() const { return *inner_; }

 private:
  std::unique_ptr<Sequence> inner_;
};

/// Returns the mark of the frames of a sequence, which may be disturbed while they are read.
DataMark mark_as_read(const Sequence& sequence);

/// Returns the map_from_sensor of each scan.
std::vector<Pose> poses_of(const Sequence& sequence);

/// Returns the indices of the labelled scans, in order.
std::vector<std::size_t> scans_with_truth(const Sequence& sequence);

}  // namespace mosbench
