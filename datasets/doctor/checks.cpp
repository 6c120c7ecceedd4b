
#include <fmt/args.h>
#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "datasets/doctor/pose_evidence.hpp"

namespace mosbench {
namespace {

constexpr const char* kLabelsDoNotFit =
    "the labels do not fit the scans: of the points labelled moving {moving_leaves_percent:.0f} % "
    "leave their place within a second, of those labelled static {still_leaves_percent:.1f} %, and "
    "{purity_percent:.0f} % of the points around a moving one are moving; expected the labels of "
    "these scans";
constexpr const char* kPosesDoNotFit =
    "the poses do not fit the scans in any convention: they are off the motion of the scans by "
    "{off_m:.2f} m (median of {motions}), and scans overlap by {overlap:.2f} instead of "
    "{best_overlap:.2f}; expected the poses of this sequence";
constexpr const char* kPosesAreOff =
    "the poses {pose_fit_kind}: over {fit_scans} they put surfaces 10 m away "
    "{fit_10_cm:.1f} cm and 30 m away {fit_30_cm:.1f} cm off (median of {places} places, scan "
    "matching errs by {match_cm:.1f} cm), worst from {worst_fit}, {worst_fit_cm:.1f} cm; expected "
    "at most {most_off_cm:.0f} cm: run with {cure}";
constexpr const char* kUnit =
    "stamps are {step_s:g} s apart (median); expected seconds, about 0.1 from scan to scan";

/// No sensor moves like this, but noise does.
const std::vector<Limit> kScatters = {
    // Noise per axis: sound poses have 0.05 m at most.
    {"scatter_m", '>', 0.075},
    // White noise has 1.83; a sensor with other accelerations in each step sqrt(2) or less.
    {"whiteness", '>', 1.6},
    // No sensor is accelerated like this over half of its way.
    {"acceleration_m_s2", '>', 12.0},
    // Poses that no sensor has need to be off by no more than noise of 5 cm.
    {"unsound", '>', 1.0}};

std::vector<Limit> with(std::vector<Limit> limits, const Limit& more) {
  limits.push_back(more);
  return limits;
}

Check row(Subject subject, const char* name, std::vector<Limit> limits, const char* sentence,
          bool decides = false, Severity severity = Severity::kWarning, bool by_reading = false) {
  return {subject, name, std::move(limits), sentence, decides, severity, by_reading};
}

std::vector<Check> table() {
  using enum Subject;
  constexpr bool kDecides = true;
  constexpr Severity kWarning = Severity::kWarning, kNote = Severity::kNote;
  return {
      row(kFolder, "numbering", {{"gaps", '>', 0}},
          "the numbering of the scans lacks {gaps}: {gap_names}; expected all numbers from "
          "{first_scan} to {last_scan}"),
      row(kFolder, "labels without scan", {{"orphans", '>', 0}},
          "{orphans} label files have no scan: {orphan_names}; expected a scan of the same name "
          "for each",
          false, Severity::kError),
      // Data sets that label part of the scans label a minority.
      row(kFolder, "scans without label", {{"unlabelled", '>', 0}, {"labelled_share", '>', 0.8}},
          "{unlabelled} of {scans_listed} have no label: {unlabelled_names}; expected labels for "
          "all or for a part at regular distances"),
      row(kFolder, "small scans", {{"smallest_scan", '<', kSmallestShare}},
          "{small_scans} far smaller than those around them: {small_names}; expected scans of like "
          "size"),

      row(kPoints, "byte order", {{"plausible_reversed", '>', 0.5}},
          "{plausible_reversed_percent:.0f} % of the points are in range when their bytes are "
          "reversed, {plausible_percent:.0f} % as they are; expected little-endian floats",
          kDecides),
      // A smaller share comes from a wrong export, whatever the scene.
      row(kPoints, "returns", {{"returns", '<', 0.05}},
          "{returned} of {points} points are returns; expected most"),
      row(kPoints, "upside down", {{"flat_above", '>', kMostFlatAbove}},
          "{flat_above_percent:.0f} % of the flat surfaces within 10 m are above the sensor; "
          "expected the ground below it (are the points upside down, z with the wrong sign?)"),
      row(kPoints, "scans upside down", {{"turned_scans", '>', 0}},
          "in {turned_scans} of {scans_read} scans read, first {first_turned}, the flat surfaces "
          "within 10 m are above the sensor, in others below; expected the ground below it (has z "
          "the wrong sign there? the poses were not checked)"),
      // A larger share comes from another unit than metres, in which nearly all points are beyond
      // the sensor's range; single outliers are fewer.
      row(kPoints, "points in the map", {{"beyond_sensor", '>', 0.01}, {"near_place", '>', 0.5}},
          "{beyond} of {returned} points are farther than the {sensor_range_m:g} m that the sensor "
          "measures, but near its pose; expected points in the sensor's frame (are these in the "
          "map's?)"),
      row(kPoints, "smaller unit", {{"beyond_sensor", '>', 0.01}, {"near_place", '<', 0.5}},
          "{beyond} of {returned} points are farther than the {sensor_range_m:g} m that the sensor "
          "measures; expected metres (are these millimetres or feet?)"),
      row(kPoints, "larger unit", {{"nearest", '>', 0.99}},
          "nearly all points are nearer than 0.5 m; expected metres"),
      // Scans of sensors that look ahead, and of turns, see the same directions.
      row(kPoints, "parts of turns", {{"common_directions", '<', 0.3}},
          "scans in a row have {common_directions_percent:.0f} % of the directions in common that "
          "they see (median); expected most: is each turn stored in parts?"),

      row(kReturns, "empty scans", {{"empty_scans", '>', 0}},
          "{empty_scans} of {scans_hold} no points, first {first_empty}; expected some in every "
          "scan (--read drop_scans=auto leaves them out)"),
      row(kReturns, "numbers", {{"nonfinite_points", '>', 0}, {"plausible_reversed", '<', 0.5}},
          "{nonfinite_points} of {points} points are NaN or infinite; expected numbers"),
      // A sensor loses few single returns (up to 0.05), while whole regions have none.
      row(kReturns, "zeros", {{"lost_between", '>', 0.1}},
          "{lost_between_percent:.0f} % of the points between two returns are (0, 0, 0); expected "
          "returns"),

      row(kLabelIds, "classes", {{"network_classes", '>', 0}},
          "the labels are {ids}, as the classes of a network; expected the ids of the data set "
          "({expected_ids})"),
      row(kLabelIds, "unknown ids", {{"unknown_ids", '>', 0}},
          "the labels hold the ids {unknown_names}; expected only those of the data set "
          "({expected_ids})"),
      row(kLabelIds, "no labels", {{"only_unlabelled", '>', 0}},
          "all labels of all scans are 0; expected labelled points"),
      row(kLabelIds, "labels beyond", {{"labels_beyond", '>', 0}},
          "{labels_beyond} labelled points lie outside of {label_min_m:g} to {label_max_m:g} m; "
          "expected id 0 there, as published"),
      row(kLabelIds, "repeated scans", {{"repeated_scans", '>', 0}},
          "scans hold the same points: {repeated_names}; expected every scan once (--read "
          "drop_scans=auto leaves the others out)"),

      row(kStamps, "order", {{"stamps_backward", '>', 0}},
          "{stamps_backward} stamps are not later than the one before, first that of scan "
          "{first_backward}; expected them in order"),
      row(kStamps, "larger unit", {{"step_s", '<', 0.01}}, kUnit, kDecides),
      row(kStamps, "smaller unit", {{"step_s", '>', 10.0}}, kUnit, kDecides),
      // A step so many times longer than usual is a gap, not a lost scan or two.
      row(kStamps, "gap", {{"gap_steps", '>', 10.0}},
          "scan {after_gap} comes {longest_step_s:.2f} s after the one before it, others "
          "{step_s:.2f} s; expected no gap in time"),

      row(kClock, "another clock", {{"clock_off_s", '>', 0.0}},
          "scans fit poses that are stamped {clock_off_s:g} s off; expected one clock: run with "
          "{clock_cure}",
          false, kWarning, true),

      row(kStill, "equal poses", {{"equal_poses", '>', 1}},
          "all {equal_poses} poses are equal; expected those of a sensor that moves, unless it "
          "stood still",
          false, kNote),

      row(kPoses, "no rotation", {{"missing_turn", '>', kMoves}},
          "all poses have the same rotation, but the scans show that the sensor turns; expected "
          "rotations",
          kDecides),
      // Shifts repeat fewer rows at an end.
      row(kPoses, "frozen for long", {{"frozen_rows", '>', kMostRowsShifted}}, "{frozen}",
          kDecides),
      // Rows are repeated at the end to make up for lost ones.
      row(kPoses, "lost and made up for", {{"lost_rows_repeated", '>', 0}}, "{lost}", kDecides),
      row(kPoses, "convention", {{"better_conventions", '>', 0}}, "{conventions}", kDecides,
          kWarning, true),
      row(kPoses, "frozen", {{"frozen_rows", '>', 0}}, "{frozen}", kDecides),
      row(kPoses, "lost scan", {{"lost_rows", '>', 0}}, "{lost}", kDecides),
      row(kPoses, "jumps", {{"jumps", '>', 0}, {"jumps", '<', 3}}, "{jump_steps}", kDecides),
      row(kPoses, "no height", {{"lacks_height", '>', 0}},
          "all poses have the same z while they roll and pitch; expected positions in all three "
          "dimensions",
          kDecides),
      // No vehicle moves faster: feet on a highway are 80 m/s and more. Of poses that scatter by a
      // larger share of a step, the speed says nothing.
      row(kPoses, "speed", {{"speed_m_s", '>', 70.0}, {"scatter_of_step", '<', 0.2}},
          "the poses move at {speed_m_s:.0f} m/s (median); expected metres at the speed of a "
          "vehicle (are these feet or millimetres?)",
          kDecides),
      // More is no noise but other poses.
      row(kPoses, "noise", with(kScatters, {"scatter_m", '<', 0.3}),
          "the poses scatter by {scatter_m:.2f} m from scan to scan around a smooth way; expected "
          "less than 0.05 m",
          kDecides),
      row(kPoses, "scattered poses", kScatters,
          "the poses do not fit the scans in any convention: they are off the motion of the scans "
          "by {off_m:.2f} m (median of {motions}), and scans overlap by {overlap:.2f} instead of "
          "{best_overlap:.2f}, and they scatter by {scatter_m:.2f} m from scan to scan; expected "
          "the poses of this sequence",
          kDecides),
      // Poses that are off, where that is no fault of the measurement: measured motions agree, or
      // another convention is far better, or scans hardly overlap. Sound poses with noise of 5 cm
      // have 0.46 of the overlap that they can have.
      row(kPoses, "unsound", {{"unsound", '>', kUnsound}, {"far_more", '>', 3.0}}, kPosesDoNotFit,
          kDecides),
      row(kPoses, "worse than another",
          {{"unsound", '>', kUnsound}, {"better_gain", '>', kLeastGain}}, kPosesDoNotFit, kDecides),
      row(kPoses, "overlap", {{"unsound", '>', kUnsound}, {"overlap_share", '<', 0.3}},
          kPosesDoNotFit, kDecides),
      row(kPoses, "rotation not to be told", {{"missing_turn", '<', kMoves}},
          "all poses have the same rotation; the scans do not show whether the sensor turns",
          kDecides, kNote),
      row(kFit, "poses that are off", {{"off_places", '>', 1}, {"off_share", '>', kMostlyOff}},
          kPosesAreOff, kDecides),
      row(kFit, "poses that are far off somewhere", {{"far_off_places", '>', 1}}, kPosesAreOff),
      row(kEgo, "points of the vehicle", {{"ego_points", '>', 0}},
          "{ego}; --read drop_ego=auto leaves them out", false, kNote),
      row(kRows, "misplaced rows", {{"misplaced_rows", '>', 0}}, "{misplaced}"),

      // Labels without anything moving for longer, a minute at 10 Hz, are doubtful: excerpts of
      // some seconds without movers are sound, while data sets of moving objects show some each
      // minute.
      row(kLabels, "nothing moves for long", {{"scans_without_moving", '>', 600}},
          "no point of {labelled_scans} is labelled moving; expected some in a sequence over "
          "{labelled_span}",
          kDecides),
      row(kLabels, "nothing moves", {{"scans_without_moving", '>', 0}},
          "no point of {labelled_scans} is labelled moving: the IoU of these labels is undefined",
          kDecides, kNote),
      // Sound labels had 0.08 at most, exchanged ones 0.92 and more.
      row(kLabels, "most points move", {{"moving_share", '>', 0.5}},
          "the labels call {moving_share_percent:.0f} % of the points moving; expected less than "
          "half (are static and moving exchanged?)",
          kDecides),
      // Sound labels had 0.867 (simulated room) and 0.963 (KITTI), those of the next scan 0.76 and
      // less, shuffled ones 0.38 and less.
      row(kLabels, "scattered labels", {{"purity", '<', 0.82}}, kLabelsDoNotFit, kDecides),
      // Of points labelled moving to static ones that leave their place. Sound labels had 4.6
      // (campus, Avia) and more, usually hundreds; labels of another scan 1 to 14.
      row(kLabels, "labels that stay", {{"leaves_ratio", '<', 2.0}, {"poses_fit", '>', 0}},
          kLabelsDoNotFit, kDecides),

      row(kPublished, "excerpt", {{"scans_left_out", '>', 0}},
          "has {scans} of the {published_scans} scans that are published", false, kNote),
      row(kPublished, "scans", {{"scans_too_many", '>', 0}},
          "has {scans} scans; expected {published_scans}, as published"),
      row(kPublished, "points", {{"points_unlike_published", '>', 0}},
          "has {first_scan_points} points in its first scan; expected {published_points}, as "
          "published"),

      row(kWithin, "frozen rows",
          {{"moves_in_equal_rows", '>', kMoves}, {"jump_share", '>', kJumpShare}}, ""),
      row(kWithin, "conventions",
          {{"gain", '>', kLeastGain},
           {"mean_gain", '>', kLeastMeanGain},
           {"mean_gain", '>', kLeastMeanGainOfRest},
           {"explained_misfit", '>', kFitting},
           {"explained_share", '<', kExplainedShare}},
          ""),
      row(kWithin, "jumps", {{"single_jump", '>', kOutlier}}, ""),
      row(kWithin, "misplaced rows", {{"row_gain", '>', kLeastRowGain}}, "")};
}

}  // namespace

std::optional<double> Facts::number(std::string_view name) const {
  const auto fact = facts_.find(name);
  if (fact == facts_.end()) return std::nullopt;
  if (const auto* count = std::get_if<std::size_t>(&fact->second)) {
    return static_cast<double>(*count);
  }
  const auto* number = std::get_if<double>(&fact->second);
  return number == nullptr ? std::nullopt : std::optional(*number);
}

std::string Facts::told(std::string_view sentence) const {
  fmt::dynamic_format_arg_store<fmt::format_context> words;
  for (const auto& [name, fact] : facts_) {
    std::visit(
        [&, &word = name](const auto& value) { words.push_back(fmt::arg(word.c_str(), value)); },
        fact);
    const auto* share = std::get_if<double>(&fact);
    const std::string percent = name + "_percent";
    if (share != nullptr) words.push_back(fmt::arg(percent.c_str(), 100.0 * *share));
  }
  return fmt::vformat(sentence, words);
}

bool Limit::passed(const Facts& facts) const {
  const std::optional<double> number = facts.number(fact);
  return number && (faulty == '>' ? *number > threshold : *number <= threshold);
}

std::span<const Check> checks() {
  static const std::vector<Check> all = table();
  return all;
}

std::vector<Symptom> judged(std::span<const Check> table, Subject subject, const Facts& facts,
                            const std::string& where, const Remedy& remedy) {
  std::vector<Symptom> found;
  for (const Check& check : table) {
    const auto passed = [&](const Limit& limit) { return limit.passed(facts); };
    if (check.subject != subject || !std::ranges::all_of(check.limits, passed)) continue;
    std::istringstream lines(facts.told(check.sentence));
    for (std::string line; std::getline(lines, line);) {
      found.push_back({check.severity, where, line, check.mended_by_reading ? remedy : Remedy()});
    }
    if (check.decides) break;
  }
  return found;
}

}  // namespace mosbench
