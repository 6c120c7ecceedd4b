#pragma once

#include <deque>
#include <string>
#include <vector>

#include "core/base/fields.hpp"
#include "core/base/scan_method.hpp"
#include "core/voxel/directions.hpp"

namespace mosbench::underwood {

/// Every parameter. Angle and range are the authors' defaults; the paper compares two given scans,
/// so which scan is compared with which is ours.
struct Config {
  double min_range_m = 0.5;             ///< points at or nearer than this never take part
  double max_range_m = 20.0;            ///< points farther than this never move
  double neighbour_angle_rad = 0.0157;  ///< alpha
  double least_angle_rows = 1.15;       ///< alpha is at least so many spacings of rows
  double range_tolerance_m = 0.15;      ///< rho
  int reference_offset_scans = 10;      ///< n; 10 are 1 s at 10 Hz
  int references = 1;                   ///< scans k - n, k - 2 n, ... that scan k is compared with
  int delay_scans = 0;                  ///< d; with d > 0 scan k + d is a reference, too
  int min_votes = 1;                    ///< of references, for a point to move
};

/// The one list of fields, as fields.hpp describes it.
template <typename AnyConfig, typename Visitor>
void visit_fields(AnyConfig& config, Visitor&& visit) {
  visit("min_range_m", config.min_range_m, FieldRange{0.0, 1000.0},
        "points at or nearer than this never take part");
  visit("max_range_m", config.max_range_m, FieldRange{0.1, 1000.0},
        "points farther than this never move");
  visit("neighbour_angle_rad", config.neighbour_angle_rad, FieldRange{0.002, 0.5},
        "alpha, reference points this near in bearing and elevation are compared");
  visit("least_angle_rows", config.least_angle_rows, FieldRange{0.0, 10.0},
        "alpha is at least so many spacings of the sensor's rows, measured in the first scan with "
        "1000 returns; 0: as set");
  visit("range_tolerance_m", config.range_tolerance_m, FieldRange{0.001, 100.0},
        "rho, a point moves when all of them are this much farther away");
  visit("reference_offset_scans", config.reference_offset_scans, FieldRange{1, 1000},
        "n, scan k is compared with scan k - n; 10 are 1 s at 10 Hz");
  visit("references", config.references, FieldRange{1, 100},
        "how many earlier scans it is compared with: k - n, k - 2 n, ...");
  visit("delay_scans", config.delay_scans, FieldRange{0, 1000},
        "d, it is compared with scan k + d, too; 0 is online");
  visit("min_votes", config.min_votes, FieldRange{1, 101},
        "a point moves when it does against so many references");
}

/// Throws std::invalid_argument "<key>: <what is wrong>, <what was expected>" for the first field
/// outside its range, range limits that leave nothing, and more votes than references.
void check(const Config& config);

/// Compares each scan with scans before it, and with one after it when delayed. Scores are margins
/// in metres: that which min_votes references see past the point. Scans without a reference are not
/// judged; the last ones of a delayed run are compared with earlier ones alone.
class Pipeline final : public SequentialMethod {
 public:
  /// Throws std::invalid_argument as `check` does, and for 0 threads.
  explicit Pipeline(const Config& config, const RunContext& context = {});

  /// Keeps the last n * references + d scans.
  std::optional<MemoryUse> memory() const override;
  std::vector<std::string> remarks() const override { return angle_.remarks(); }

 private:
  struct HeldScan {
    PosedScan scan;
    std::vector<Direction> directions;  ///< as its own sensor sees its points
    LabelledScan result;
  };

  std::vector<LabelledScan> take(PosedScan& scan, LabelledScan result) override;
  std::vector<LabelledScan> release() override;
  void judge(std::size_t place);
  std::vector<const HeldScan*> references_of(std::size_t place) const;

  Config config_;
  NeighbourAngle angle_;
  std::deque<HeldScan> held_;   ///< the newest last
  std::size_t unreleased_ = 0;  ///< of them, the newest
};

}  // namespace mosbench::underwood
