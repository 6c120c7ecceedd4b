#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "datasets/sequence/reading_options.hpp"

namespace mosbench {

/// One scan as a data set gives it.
struct Frame {
  std::string stem;                                 ///< file name without extension; names outputs
  std::vector<Point> points;                        ///< sensor frame, stored order, nothing dropped
  Pose map_from_sensor = Pose::Identity();          ///< lidar frame
  std::optional<std::int64_t> stamp_ns;             ///< when the data set tells
  std::optional<std::vector<std::uint32_t>> truth;  ///< raw label ids, one per point, when labelled
};

/// An ordered recording of one sensor. Opening it checks everything that needs no scan to be read
/// (pairing of files, counts of poses, file sizes); reading a scan checks the scan.
class Sequence {
 public:
  virtual ~Sequence() = default;

  virtual std::string name() const = 0;  ///< folder for results, relative, unique in a data set
  virtual std::size_t size() const = 0;  ///< scans
  virtual std::string stem(std::size_t scan_index) const = 0;
  virtual bool has_truth(std::size_t scan_index) const = 0;
  /// The file that holds this scan and nothing else, when there is one.
  virtual std::optional<std::filesystem::path> scan_file(std::size_t scan_index) const = 0;
  /// The frame's pose and stamp without its points.
  virtual Pose map_from_sensor(std::size_t scan_index) const = 0;
  virtual std::optional<std::int64_t> stamp_ns(std::size_t scan_index) const = 0;
  /// Safe to call from several threads. The memory of `spent` may serve the frame. Throws
  /// DataError.
  Frame read(std::size_t scan_index, Frame spent = {}) const {
    return read_frame(scan_index, std::move(spent));
  }
  /// The truth of a labelled scan without its points when the format allows; throws DataError.
  virtual std::vector<std::uint32_t> read_truth(std::size_t scan_index) const = 0;
  /// Number of points of a scan without reading them.
  virtual std::size_t point_count(std::size_t scan_index) const = 0;
  /// Every file that decides the content, for fingerprints: scans, poses, calibration, truth.
  virtual std::vector<std::filesystem::path> files() const = 0;
  /// Plain sentences on what was assumed or found odd while opening (pose frame, missing labels).
  virtual std::vector<std::string> remarks() const = 0;
  /// What was read in which convention; two runs on the same files may differ in it.
  virtual ReadingStatement reading() const = 0;

 private:
  virtual Frame read_frame(std::size_t scan_index, Frame spent) const = 0;
};

/// The indices of the labelled scans, in order.
std::vector<std::size_t> scans_with_truth(const Sequence& sequence);

}  // namespace mosbench
