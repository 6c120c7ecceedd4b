#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "datasets/sequence/reading_options.hpp"
#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// Everything of a sequence but its truth: scans with their poses and, where told, stamps.
class ScanSource {
 public:
  virtual ~ScanSource() = default;

  virtual std::size_t size() const = 0;
  virtual std::string stem(std::size_t scan_index) const = 0;
  /// The file a scan is in, and whether it is in there alone.
  virtual std::filesystem::path file(std::size_t scan_index) const = 0;
  virtual bool has_own_files() const = 0;
  std::optional<std::filesystem::path> own_file(std::size_t scan_index) const {
    if (!has_own_files()) return std::nullopt;
    return file(scan_index);
  }
  virtual std::size_t point_count(std::size_t scan_index) const = 0;
  /// One per scan, or empty.
  virtual const std::vector<std::int64_t>& stamps_ns() const = 0;
  virtual Pose map_from_sensor(std::size_t scan_index) const = 0;
  /// Nothing when there are no stamps.
  std::optional<std::int64_t> stamp_ns(std::size_t scan_index) const {
    if (stamps_ns().empty()) return std::nullopt;
    return stamps_ns().at(scan_index);
  }
  /// The frame without truth, as `Sequence::read`.
  Frame read(std::size_t scan_index, Frame spent = {}) const {
    return read_frame(scan_index, std::move(spent));
  }
  /// Everything that decides the frames.
  virtual std::vector<std::filesystem::path> files() const = 0;
  virtual std::vector<std::string> remarks() const = 0;
  virtual ReadingStatement reading() const = 0;

 private:
  virtual Frame read_frame(std::size_t scan_index, Frame spent) const = 0;
};

}  // namespace mosbench
