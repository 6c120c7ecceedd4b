#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <mosbench/scan.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "datasets/sequence/reading.hpp"
#include "datasets/sequence/registration.hpp"
#include "datasets/sequence/sequence.hpp"

// What the scans of a sequence and its poses say of each other.

namespace mosbench {

/// What was measured in a sequence, by name: numbers that checks compare with their thresholds, and
/// words for their sentences.
class Facts {
 public:
  using Fact = std::variant<double, std::size_t, std::string>;

  Fact& operator[](std::string_view name) { return facts_[std::string(name)]; }
  /// Returns nothing for what was not measured.
  std::optional<double> number(std::string_view name) const;
  /// Puts facts into the places of a sentence, shares also as percent: "{returns_percent:.0f} % of
  /// {points}".
  std::string told(std::string_view sentence) const;

 private:
  std::map<std::string, Fact, std::less<>> facts_;
};

/// The change of the reading options that mends a fault; none where reading cannot.
struct Remedy {
  std::optional<PoseFrame> pose_frame = std::nullopt;
  std::optional<PoseDirection> pose_direction = std::nullopt;
  std::optional<double> pose_offset_s = std::nullopt;

  explicit operator bool() const { return pose_frame || pose_direction || pose_offset_s; }
  bool operator==(const Remedy&) const = default;
  Reading applied_to(Reading reading) const;
};

/// Of a note all may be well, with a warning results are doubtful, with an error there are none.
enum class Severity : std::uint8_t { kNote, kWarning, kError };

struct Symptom {
  Severity severity = Severity::kWarning;
  std::string where;  ///< sequence or file
  std::string what;   ///< a plain sentence with what was found and what was expected
  Remedy remedy = {};
};

/// What is judged at a time.
enum class Subject : std::uint8_t {
  kFolder,
  kPoints,   ///< what makes results wrong
  kReturns,  ///< what methods leave out
  kLabelIds,
  kStamps,
  kClock,  ///< of poses, by what opening a sequence shows
  kStill,  ///< poses before any scan is read, which may tell whether the sensor stands
  kPoses,
  kFit,   ///< of poses in which nothing else was found
  kRows,  ///< of sound poses: others have detours of their own
  kEgo,
  kLabels,
  kPublished,
  kWithin  ///< limits that single rows, motions or conventions were compared with already
};

/// A bound between sound data and faulty ones.
struct Limit {
  const char* fact;
  char faulty;  ///< '>' for above the threshold, '<' for at most that
  double threshold;

  bool passed(const Facts& facts) const;
};

/// A fault that is looked for. A new one is a row in `checks()`, and the facts that it compares.
struct Check {
  Subject subject;
  const char* name;
  std::vector<Limit> limits;  ///< all are passed by faulty data
  const char* sentence;       ///< with the names of facts; each line of it is a symptom
  /// Of a subject, no check after this one is asked when this one finds something.
  bool decides = false;
  Severity severity = Severity::kWarning;
  bool mended_by_reading = false;  ///< the remedy of the facts applies
};

/// All checks, the most certain ones of a subject first.
std::span<const Check> checks();

/// Returns what the checks of a subject find at `where`, notes among it. `remedy` is how to read
/// what could be read otherwise.
std::vector<Symptom> judged(std::span<const Check> table, Subject subject, const Facts& facts,
                            const std::string& where, const Remedy& remedy = {});

// --- Thresholds that are applied to single motions, conventions or rows.

/// Poses with a larger mean square deviation are faulty: noise of 5 cm gives 1, of 10 cm 4.
inline constexpr double kUnsound = 2.0;
/// A motion that is off by less (squared, in units of sound noise) fits.
inline constexpr double kFitting = 4.0;
/// An explanation has to make the measured motions more likely by this (log) than the next. Wrong
/// ones next to sound poses lost 5 and more, or differed nowhere; right ones gained 15 (one row
/// later, highway, Aeva) and more.
inline constexpr double kLeastGain = 12.0;
/// The same on average where a convention differs from the given poses.
inline constexpr double kLeastMeanGain = 0.25;
/// The same of conventions that claim less motion: where nothing holds a scan along a corridor,
/// registration makes motions shorter, with a gain of 0.35; feet on a highway gain 3.6.
inline constexpr double kLeastMeanGainOfRest = 1.0;
/// A convention explains motions of which many are measured wrongly when it leaves at most this
/// share of the deviation.
inline constexpr double kExplainedShare = 0.5;
/// Equal rows while scans move, in units of the registration's own errors.
inline constexpr double kMoves = 9.0;
/// Some equal rows that end in a jump over at least this share of the way that usual steps make
/// were frozen; a vehicle that stood starts slowly.
inline constexpr double kJumpShare = 0.6;
/// A step that is off by more is an outlier.
inline constexpr double kOutlier = 12.0;
/// Overlap per pair of scans that mended rows have to gain. Right exchanges gained 0.007 (campus,
/// Avia, 0.16 m per scan) to 0.1 and more, single rows at least 0.1, wrong exchanges lost 0.007.
inline constexpr double kLeastRowGain = 0.005;

/// More of the flat places may be above the sensor only if it hangs upside down.
inline constexpr double kMostFlatAbove = 0.8;
/// Share of the places at which poses that are off altogether are off.
inline constexpr double kMostlyOff = 0.5;
/// A smaller scan, as share of the median size of those around, was cut off while it was copied:
/// far below what scenes change.
inline constexpr double kSmallestShare = 0.6;

// --- The motions that scans show.

/// How far a motion is from the measured one, in units of what the measurement, or sound poses, may
/// err: squares, so 1 is usual.
struct Misfit {
  double translation = 0.0, rotation = 0.0;
  double both() const { return 0.5 * (translation + rotation); }
};

/// A motion that two scans may show, alone and put together from scan to scan.
struct ShownMotion : Registration {
  Pose chained = Pose::Identity();
};

/// The motion between two scans as the scans themselves show it.
struct MeasuredMotion : ShownMotion {
  ScanPair pair;
  double given_overlap = 0.0;
  double back_overlap = 0.0;  ///< under the inverse of the given motion
  ShownMotion back;           ///< registered from there
  ShownMotion best;           ///< the largest overlap found, wherever that is

  bool consecutive() const { return pair.later == pair.earlier + 1; }
  /// Against the errors of the measurement.
  Misfit misfit(const Pose& claimed) const;
  /// Against the errors of the measurement and of poses that are still sound.
  Misfit unsound(const Pose& claimed) const;
};

/// Motions over stretches of a sequence: from scan to scan, and between scans some metres apart.
struct MeasuredMotions {
  std::vector<MeasuredMotion> pairs;
  std::size_t scans_read = 0;
};

/// Returns where else to look for the motion between two scans.
using MotionGuess = std::function<std::optional<Pose>(const ScanPair&)>;

/// Registers the scans of short sequences, and of stretches of long ones, with the scan before and
/// with one some metres before. `spots` are scans around which to measure in any case; registration
/// starts from the given motion and from the guesses. Throws DataError.
MeasuredMotions measure_motions(const Sequence& sequence, const std::vector<Pose>& given,
                                const std::vector<std::size_t>& spots,
                                const std::vector<MotionGuess>& guesses);

// --- Conventions.

/// A way in which the poses of a sequence, or its points, could be stored.
struct PoseConvention {
  std::string name;    ///< "sensor_from_map (inverse)"
  std::string advice;  ///< what to do if this convention fits
  std::vector<Pose> map_from_sensor;
  /// Brings stored points to what the poses mean: swaps or mirrors axes, or turns the sensor.
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  int rows_later = 0;     ///< scan k has the pose of row k + rows_later
  std::size_t first = 0;  ///< the scan from which on rows_later holds
  int rows_before = 0;    ///< the same of the scans before it
  /// Claims that little or nothing moves, which registration falls for where it fails.
  bool stands = false;
  Remedy remedy = {};

  /// Returns the motion that brings stored points of the later scan into the frame of the earlier;
  /// nothing where the rows do not reach, or where `first` is between.
  std::optional<Pose> motion(const ScanPair& pair) const;
};

/// Returns the poses as rows that come so many scans later.
PoseConvention shifted(const std::vector<Pose>& given, int rows_later);
inline constexpr int kMostRowsShifted = 15;

/// Returns the conventions other than the given one: frames, directions, axes, and shifts by up to
/// `kMostRowsShifted` rows. `camera_from_lidar` is Tr of calib.txt unless it is the identity, and
/// `applied` says whether the given poses were transformed by it; without Tr the camera is assumed
/// to look along the LiDAR's x axis.
std::vector<PoseConvention> other_conventions(const std::vector<Pose>& given,
                                              const std::optional<Pose>& camera_from_lidar,
                                              bool applied);

/// Returns the scale, the turn of the sensor about each axis, and the lever arm with which the
/// given poses fit the measured motions best; only those large enough to matter.
std::vector<PoseConvention> fitted_corrections(const std::vector<Pose>& given,
                                               const MeasuredMotions& measured);

/// How a convention fits the measured motions, on those where it differs from the given poses.
struct ConventionScore {
  std::size_t pairs = 0;  ///< none when the two differ nowhere
  double off_m = 0.0;     ///< median difference to the measured motions
  double given_off_m = 0.0;
  /// By how much more likely (log) the measured motions are under the convention.
  double gain = 0.0;
  double unsound = 0.0;        ///< see PoseEvidence, of the convention
  double given_unsound = 0.0;  ///< of the given poses on the same motions
  double median_misfit = 0.0;  ///< of the convention, in units of sound noise
  bool is_better = false;      ///< than the given poses
  bool explains = false;       ///< is better, and fits as well as sound poses would
};

// --- Rows of the pose file.

/// Rows first ... last of a pose file, counted from 0.
struct RowRange {
  std::size_t first = 0, last = 0;
  std::size_t rows() const { return last - first + 1; }
  bool single() const { return first == last; }
};

/// Returns runs of two or more rows with the same numbers.
std::vector<RowRange> equal_rows(const std::vector<Pose>& poses);

/// Returns the rows after the steps that stand out most, and by more than `least_m`, from the steps
/// around them, longest first.
std::vector<std::size_t> odd_steps(const std::vector<Pose>& poses, std::size_t most,
                                   double least_m = -1.0);

/// How far poses are from a smooth way, by their positions alone.
struct PoseScatter {
  double noise_m = 0.0;            ///< per axis, if all of it is noise; 0 with too few poses
  double whiteness = 0.0;          ///< third by second differences: sqrt(20 / 6) for white noise
  double acceleration_m_s2 = 0.0;  ///< that a sensor on this way would have, median
};

/// Measures poses that are `step_s` apart.
PoseScatter scatter_of(const std::vector<Pose>& poses, double step_s);

/// Two rows of a pose file that were exchanged, or a single one (`first` == `last`) that is away
/// from the trajectory of its neighbours.
using MisplacedRows = RowRange;

/// Returns the poses with the two rows exchanged, or the single one midway between its neighbours.
std::vector<Pose> mended(std::vector<Pose> poses, const MisplacedRows& rows);

/// Returns rows (worst first) whose removal shortens the trajectory by more than a typical step and
/// clearly more than a typical detour. Only poses are examined, so a real jerk may be among them.
std::vector<MisplacedRows> suspected_rows(std::vector<Pose> poses);

/// Mends suspected rows without which scans overlap better, too, and tells which. Reads the scans
/// around suspected rows only. Throws DataError.
void examine_misplaced_rows(const Sequence& sequence, std::vector<Pose>& poses, Facts& facts);

// --- All together.

/// The given poses of a sequence, but for misplaced rows, beside the motions that its scans show.
struct PoseEvidence {
  std::vector<Pose> given;
  std::vector<std::string> stems;  ///< names of the scans
  MeasuredMotions measured;
  std::vector<PoseConvention> conventions;
  std::vector<ConventionScore> scores;  ///< one per convention
  /// How far off the best convention is, in units of the registration's errors, at least 1.
  double noise = 1.0;
  /// Mean square deviation of the given poses from the measured motions, in units of poses with
  /// noise of 5 cm and 0.1 degrees. Each motion counts up to 25.
  double deviation = 0.0;
  /// The same of measured motions put together from scan to scan, against those over metres: how
  /// well motions can be measured here, without regard to the poses.
  double disagreement = 0.0;
  double overlap = 0.0;       ///< of upright surfaces, median
  double best_overlap = 0.0;  ///< after moving the scans to where they overlap best
  double median_correction_m = 0.0;

  bool fits() const { return deviation < kUnsound; }  ///< the scans confirm the poses
  Pose given_motion(const MeasuredMotion& pair) const { return relative(given, pair.pair); }
  /// Returns how unlikely (log) a claimed motion is.
  double unlikeliness(const MeasuredMotion& pair, const Pose& claimed) const;
  /// Returns how far the given motion is off, in units of sound noise.
  double off(const MeasuredMotion& pair) const;
  /// Returns the median over all motions, or over steps alone.
  double median_over(const std::function<double(const MeasuredMotion&)>& value,
                     bool only_steps = false) const;
  /// Returns the mean square deviation of claimed motions from measured ones, in units of poses
  /// with sound noise. `motion_of` returns nothing for pairs that are left out.
  double unsound(const std::function<std::optional<Pose>(const MeasuredMotion&)>& motion_of) const;
};

/// Measures what there is to be known of the poses. `step_s` is the time from scan to scan, if
/// stamps tell it; `conventions` are those of `other_conventions`. Throws DataError.
PoseEvidence measure_poses(const Sequence& sequence, const std::vector<Pose>& given,
                           const std::vector<PoseConvention>& conventions,
                           std::optional<double> step_s, Facts& facts);

/// Returns how to read the poses in one of the conventions that fit about as well as the best one;
/// none where that takes more than reading, or several can be read.
Remedy remedy_of(const PoseEvidence& poses);

/// Finds what stands out in the rows of poses that are `step_s` apart.
void examine_rows(const PoseEvidence& evidence, double step_s, Facts& facts);

/// Compares a convention with the given poses.
ConventionScore score_of(const PoseEvidence& evidence, const PoseConvention& convention);

/// Returns the best of the conventions that are better than the given poses; nothing when there is
/// none.
std::optional<std::size_t> best_convention(const std::vector<ConventionScore>& scores);

}  // namespace mosbench
