#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "datasets/sequence/portable_math.hpp"
#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// Parses "KIND=STRENGTH,...,seed=N". Throws UsageError that names the
/// nearest key for unknown ones, and the limits of a strength out of them.
Perturbation parse_perturbation(std::string_view text);

/// Returns whether no kind changes scans or their poses or needs these, so that poses may be found
/// later.
bool changes_points_only(const Perturbation& perturbation);

/// Wraps a sequence so that its scans are disturbed. A disturbed scan depends on the text, the
/// sequence's name and the scan alone. The order of reading, threads and the machine do not matter.
/// Lost points become missing returns (0, 0, 0) with truth 0, so that one label per stored point
/// stays; truth follows the points. Throws UsageError if the sequence lacks what a disturbance
/// needs (stamps, beams, a scan to jump at).
std::unique_ptr<Sequence> perturbed(std::unique_ptr<Sequence> inner,
                                    const Perturbation& perturbation);

inline constexpr double kRadPerDeg = 0.0174532925199432957692;
inline constexpr double kFullTurn_rad = 6.28318530717958647692;

/// Random numbers of one disturbance of one sequence: a function of a counter, so that they cannot
/// depend on an order.
class Draws {
 public:
  explicit Draws(std::uint64_t key) : key_(key) {}
  /// Returns draws of their own for a scan, a point or a purpose.
  Draws of(std::uint64_t counter) const { return Draws(random_word(key_, ~counter)); }
  /// Uniform in [0, 1).
  double uniform(std::uint64_t counter) const {
    return mosbench::uniform(random_word(key_, counter));
  }
  /// Mean 0, standard deviation 1. Not to be mixed with `uniform` of the same draws.
  double normal(std::uint64_t counter) const { return mosbench::normal(key_, counter); }

 private:
  std::uint64_t key_;
};

/// The scans that are left, and where in the original sequence they were.
struct ScanList {
  std::vector<ScanEntry> scans;
  std::vector<std::size_t> sources;
};

struct PerturbKind;

/// What a disturbance needs to know.
struct PerturbContext {
  const PerturbKind& kind;
  double strength;
  Draws draws;
  const Perturbation& shared;
  const Recording& original;  ///< the sequence before any disturbance
};

/// Changes the points and the truth of a scan; `source` is its index in the original sequence.
using ChangePoints = std::function<void(std::size_t source, Frame& frame)>;

/// One kind of disturbance: what is known of it without a sequence, and one of the two functions.
struct PerturbKind {
  std::string_view name;
  double none = 0;  ///< the strength that changes nothing; NaN where that depends on the sensor
  double lowest = 0, highest = 1e6;
  std::string_view unit, definition, source;
  bool needs_poses = false;
  bool is_random = true;       ///< whether the seed counts
  bool changes_truth = false;  ///< points may be lost or become others
  void (*change_scans)(const PerturbContext& context, ScanList& list) = nullptr;
  ChangePoints (*point_change)(const PerturbContext& context) = nullptr;
};

/// Returns all kinds, in the order in which they are listed.
std::span<const PerturbKind> perturb_kinds();
/// Returns the kind of this name. Throws UsageError that names the nearest one.
const PerturbKind& perturb_kind_named(std::string_view name);

/// A key that several kinds share, and what it says.
struct PerturbKey {
  std::string_view name, definition;
  std::span<const std::string_view> kinds;  ///< that use it; none are named for the seed
};
std::span<const PerturbKey> perturb_keys();

/// Moves a return along its ray.
void set_range(Point& point, double range_m, double new_range_m);

// Poses, stamps and scans. Poses are changed by metres or, where the unit says so, degrees.
void add_pose_noise(const PerturbContext& context, ScanList& list);
void add_pose_drift(const PerturbContext& context, ScanList& list);
void add_pose_jump(const PerturbContext& context, ScanList& list);
void keep_every_nth_scan(const PerturbContext& context, ScanList& list);
void lose_scans(const PerturbContext& context, ScanList& list);
void jitter_stamps(const PerturbContext& context, ScanList& list);

// Points.
ChangePoints range_noise(const PerturbContext& context);
ChangePoints range_bias(const PerturbContext& context);
ChangePoints dropout(const PerturbContext& context);
ChangePoints dropout_by_range(const PerturbContext& context);
ChangePoints fewer_beams(const PerturbContext& context);
ChangePoints mount_tilt(const PerturbContext& context);
ChangePoints time_warp(const PerturbContext& context);
ChangePoints rain(const PerturbContext& context);
ChangePoints fog(const PerturbContext& context);

}  // namespace mosbench
