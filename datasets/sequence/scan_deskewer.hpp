#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "datasets/sequence/pose_track.hpp"
#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// Moves the points of scans to where the sensor would have seen them at the scan's stamp.
class ScanDeskewer {
 public:
  ScanDeskewer() = default;
  /// Scans without stamps are taken to be 0.1 s apart.
  ScanDeskewer(Deskew by, const std::vector<ScanEntry>& scans);

  /// Moves the points of a frame that has their times, and drops the times. Where the poses do not
  /// cover the times (of the first or last scan), the frame stays as it is.
  void apply(std::size_t scan_index, Frame& frame) const;

 private:
  struct Motion {
    Pose map_from_sensor, to_next;
    std::int64_t period_ns;
  };
  std::optional<Motion> motion_at(std::size_t scan_index) const;
  bool move_by(std::size_t scan_index, Frame& frame) const;

  Deskew by_ = Deskew::kNone;
  std::vector<Pose> poses_;
  std::vector<std::int64_t> stamps_ns_;
  PoseTrack track_;
};

/// A sequence whose scans are deskewed by its own poses.
class DeskewedSequence : public SequenceAround {
 public:
  DeskewedSequence(std::unique_ptr<Sequence> inner, Deskew by);

  using SequenceAround::read;
  void read(std::size_t scan_index, Frame& frame) const override;

 private:
  ScanDeskewer deskewer_;
};

}  // namespace mosbench
