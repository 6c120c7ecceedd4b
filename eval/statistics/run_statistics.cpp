#include "eval/statistics/run_statistics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace mosbench {
namespace {

using Kind = Unlike::Kind;

std::string range_text(const RangeGate& range) {
  return fmt::format("{:g} to {:g} m", range.min_m, range.max_m);
}

std::string text_of(const SettingValue* value) {
  return value == nullptr ? "nothing" : to_json(*value).dump();
}

/// Returns "voxel_size_m: 0.25 -> 0.4, ..."; empty if the settings are equal or unknown. Two
/// methods are compared by the settings that both have. What the second one has besides is no
/// change but `added`: a later release may have more settings.
std::string changed_settings(const Result& first, const Result& second, std::string& added) {
  if (!first.settings || !second.settings) return "";
  std::vector<std::string> names;
  for (const RecordedSettings* settings : {&*second.settings, &*first.settings}) {
    for (const auto& [name, value] : settings->all()) {
      if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
  }
  std::vector<std::string> changes;
  for (const std::string& name : names) {
    const SettingValue* before = first.settings->find(name);
    const SettingValue* after = second.settings->find(name);
    const bool of_both = before != nullptr && after != nullptr;
    if ((first.method != second.method && !of_both) || (of_both && are_equal(*before, *after))) {
      continue;
    }
    if (before == nullptr) {
      added += fmt::format("{}{}: {}", added.empty() ? "" : ", ", name, text_of(after));
      continue;
    }
    changes.push_back(fmt::format("{}: {} -> {}", name, text_of(before), text_of(after)));
  }
  return fmt::format("{}", fmt::join(changes, ", "));
}

void compare_rules(const Result& first, const Result& second, PairedRuns& paired) {
  std::vector<Unlike>& unlike = paired.unlike;
  const auto differ = [&unlike](Kind kind, const char* what, const std::string& a,
                                const std::string& b) {
    if (a != b) unlike.push_back({kind, fmt::format("{} is {} and {}", what, a, b)});
  };
  differ(Kind::kProtocol, "protocol", std::string(first.protocol->name),
         std::string(second.protocol->name));
  differ(Kind::kProtocol, "counted range", range_text(first.range), range_text(second.range));
  differ(Kind::kInput, "data set", first.dataset, second.dataset);
  differ(Kind::kSetting, "method", first.method, second.method);
  const std::string changes = changed_settings(first, second, paired.added_settings);
  const bool are_recorded = first.settings && second.settings;
  if (!are_recorded && first.method == second.method) {
    differ(Kind::kSetting, "setting", first.setting, second.setting);
  } else if (!changes.empty()) {
    unlike.push_back({Kind::kSetting, changes});
  }
}

class Pairing {
 public:
  explicit Pairing(PairedRuns& paired) : paired_(paired) {}

  void add(const Result& first, const Result& second) {
    compare_frames(first, second);
    if (first.missing_predictions() != second.missing_predictions()) {
      add_unlike(Kind::kScans, first, "predictions are missing for different numbers of scans");
    }
    std::unordered_map<std::string, const ScanRow*> others;
    for (const ScanRow* row : counted_scans(second)) others.emplace(row->stem, row);
    paired_.first.emplace_back();
    paired_.second.emplace_back();
    for (const ScanRow* row : counted_scans(first)) {
      const auto other = others.find(row->stem);
      if (other == others.end()) {
        add_unlike(Kind::kScans, first, "scan " + row->stem + " is only in the first run");
        continue;
      }
      add_pair(first, *row, *other->second);
      others.erase(other);
    }
    for (const auto& [stem, row] : others) {
      add_unlike(Kind::kScans, first, "scan " + stem + " is only in the second run");
    }
  }

  void add_unlike(Kind kind, const Result& sequence, const std::string& text) {
    paired_.unlike.push_back(
        {kind, fmt::format("sequence {}: {}", sequence.sequence.text(), text)});
  }

 private:
  void compare_frames(const Result& first, const Result& second) {
    const std::string& frames = first.from.fingerprint;
    const std::string& others = second.from.fingerprint;
    if (frames.empty() || others.empty() || frames == others) return;
    const std::string& without_poses = first.from.fingerprint_without_poses;
    if (!without_poses.empty() && without_poses == second.from.fingerprint_without_poses) {
      add_unlike(Kind::kPoses, first, "the poses differ, the scans do not");
    } else {
      add_unlike(Kind::kInput, first, "fingerprints of the scans differ");
    }
  }

  void add_pair(const Result& sequence, const ScanRow& first, const ScanRow& second) {
    if (!first.truth_hash || !second.truth_hash) {
      add_unlike(Kind::kInput, sequence, "scan " + first.stem + " does not state its truth");
    } else if (first.truth_hash != second.truth_hash) {
      add_unlike(Kind::kInput, sequence, "the truth of scan " + first.stem + " differs");
    }
    paired_.scans.push_back({sequence.sequence, first.stem, &first, &second});
    paired_.first.back().push_back(*first.counts);
    paired_.second.back().push_back(*second.counts);
  }

  PairedRuns& paired_;
};

/// Rounding of a difference of two fractions must not decide at exactly max_drop.
constexpr double kRounding = 1e-12;

std::optional<double> iou_of(const Protocol& protocol, std::span<const SequenceCounts> sequences) {
  const double iou = aggregate(protocol, sequences)[static_cast<std::size_t>(Metric::kIou)];
  if (std::isnan(iou)) return std::nullopt;
  return iou;
}

/// Where nothing moves a drop of the IoU cannot tell of false positives.
constexpr double kFewFalsePositives = 10.0;

Confusion pooled(std::span<const SequenceCounts> sequences) {
  Confusion all;
  for (const SequenceCounts& scans : sequences) {
    for (const Confusion& scan : scans) all += scan;
  }
  return all;
}

void count_false_positives(std::span<const SequenceCounts> first,
                           std::span<const SequenceCounts> second, const GateLimits& limits,
                           GateCheck& check) {
  double scans = 0.0;
  for (const SequenceCounts& sequence : second) scans += static_cast<double>(sequence.size());
  const Confusion before = pooled(first), after = pooled(second);
  check.baseline_false_positives = static_cast<double>(before.fp) / scans;
  check.new_false_positives = static_cast<double>(after.fp) / scans;
  check.most_added_false_positives = limits.max_added_false_positives;
  if (!check.most_added_false_positives && after.tp + after.fn == 0) {
    check.most_added_false_positives = kFewFalsePositives;
  }
}

GateCheck check(std::string name, const Protocol& protocol, std::span<const SequenceCounts> first,
                std::span<const SequenceCounts> second, Spacing spacing, const GateLimits& limits) {
  GateCheck check;
  check.name = std::move(name);
  check.baseline = iou_of(protocol, first);
  check.newer = iou_of(protocol, second);
  check.tolerance = limits.max_drop;
  count_false_positives(first, second, limits, check);
  if (!check.baseline || !check.newer) {
    check.iou_passed = !check.baseline;
    return check;
  }
  check.difference = paired_difference(protocol, first, second, spacing)[Metric::kIou];
  const double value = *check.difference.value;
  if (limits.rule == GateRule::kStatistical && check.difference.interval) {
    check.tolerance = std::max(limits.max_drop, check.difference.interval->high - value);
  }
  check.iou_passed = value >= -check.tolerance - kRounding;
  return check;
}

bool is_whole(const IouAndTime& run) { return run.iou && run.ms_per_scan; }

/// Whether `other` is at least as good and as fast, and better in one.
bool beats(const IouAndTime& other, const IouAndTime& run) {
  if (!is_whole(other)) return false;
  const bool as_good = *other.iou >= *run.iou && *other.ms_per_scan <= *run.ms_per_scan;
  return as_good && (*other.iou > *run.iou || *other.ms_per_scan < *run.ms_per_scan);
}

}  // namespace

Spacing spacing_of(const ScanGaps& gaps) {
  constexpr double kShared = 0.05;  // the part of their objects that far scans share at most
  const bool far = gaps.neighbours > 0.0 && gaps.shared <= kShared * gaps.neighbours;
  return far ? Spacing::kFar : Spacing::kNear;
}

Spacing spacing_of(std::span<const Result> sequences) {
  ScanGaps gaps;
  for (const Result& result : sequences) gaps += gaps_of(result);
  return spacing_of(gaps);
}

Estimates estimate(std::span<const Result> sequences) {
  return estimate(*sequences.front().protocol, counts_of(sequences), spacing_of(sequences));
}

PairedRuns pair_runs(const ResultSet& first, const ResultSet& second) {
  PairedRuns paired;
  paired.spacing = spacing_of(first.sequences);
  compare_rules(first.front(), second.front(), paired);
  Pairing pairing(paired);
  const auto named = [](const ResultSet& set, const SequenceName& name) {
    return std::ranges::find(set.sequences, name, &Result::sequence);
  };
  for (const Result& sequence : first.sequences) {
    const auto other = named(second, sequence.sequence);
    if (other == second.sequences.end()) {
      pairing.add_unlike(Kind::kScans, sequence, "is only in the first run");
    } else {
      pairing.add(sequence, *other);
    }
  }
  for (const Result& sequence : second.sequences) {
    if (named(first, sequence.sequence) == first.sequences.end()) {
      pairing.add_unlike(Kind::kScans, sequence, "is only in the second run");
    }
  }
  return paired;
}

std::string unlike_text(const std::vector<Unlike>& unlike) {
  constexpr std::size_t kMost = 5;
  std::string text;
  for (std::size_t i = 0; i < std::min(kMost, unlike.size()); ++i) {
    text += (i == 0 ? "" : "; ") + unlike[i].text;
  }
  if (unlike.size() > kMost) text += fmt::format("; and {} more", unlike.size() - kMost);
  return text;
}

bool GateCheck::passed() const {
  const double added = new_false_positives - baseline_false_positives;
  return iou_passed &&
         (!most_added_false_positives || added <= *most_added_false_positives + kRounding);
}

bool GateResult::passed() const {
  return std::ranges::all_of(checks, &GateCheck::passed) &&
         std::ranges::all_of(costs, &CostCheck::passed);
}

GateResult judge(const PairedRuns& paired, const Protocol& protocol, const GateLimits& limits) {
  GateResult result{limits.rule, {}};
  std::size_t scan = 0;
  for (std::size_t s = 0; s < paired.first.size(); ++s) {
    if (paired.first[s].empty()) continue;
    result.checks.push_back(check(paired.scans[scan].sequence, protocol, {&paired.first[s], 1},
                                  {&paired.second[s], 1}, paired.spacing, limits));
    scan += paired.first[s].size();
  }
  if (result.checks.size() > 1) {
    result.checks.push_back(
        check("all", protocol, paired.first, paired.second, paired.spacing, limits));
  }
  return result;
}

std::vector<bool> pareto_front(std::span<const IouAndTime> runs) {
  std::vector<bool> front;
  for (const IouAndTime& run : runs) {
    front.push_back(is_whole(run) && std::ranges::none_of(runs, [&](const IouAndTime& other) {
                      return beats(other, run);
                    }));
  }
  return front;
}

}  // namespace mosbench
