#include "datasets/perturb/perturbation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "datasets/perturb/perturb_kinds.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

[[noreturn]] void refuse(std::string_view what, const std::string& expected) {
  throw UsageError(fmt::format("{}: {}, expected {}", option("perturb"), what, expected));
}

[[noreturn]] void refuse_name(std::string_view name) {
  std::vector<std::string_view> names;
  for (const PerturbKind& kind : perturb_kinds()) names.push_back(kind.name);
  for (const PerturbKey& key : perturb_keys()) names.push_back(key.name);
  refuse(fmt::format("{} is not known", quoted(name)),
         fmt::format("one of {} (nearest: {})", fmt::join(names, ", "), nearest_name(name, names)));
}

std::uint64_t whole_number(std::string_view name, std::string_view text, std::uint64_t lowest,
                           std::uint64_t highest) {
  const auto number = parse_unsigned(text);
  if (number && *number >= lowest && *number <= highest) return *number;
  refuse(fmt::format("{}: {} is no number for it", name, quoted(text)),
         fmt::format("a whole number from {} to {}", lowest, highest));
}

double number_within(std::string_view name, std::string_view text, double lowest, double highest) {
  const auto number = parse_double(text);
  if (number && *number >= lowest && *number <= highest) return *number;
  refuse(fmt::format("{}: {} is no number for it", name, quoted(text)),
         fmt::format("a number from {:g} to {:g}", lowest, highest));
}

/// Returns whether the name is that of a shared key, which is then set.
bool set_key(std::string_view name, std::string_view text, Perturbation& perturbation) {
  constexpr std::uint64_t kMostScans = 1'000'000'000, kMostBeams = 4096;
  if (name == "seed") {
    perturbation.seed = whole_number(name, text, 0, UINT64_MAX);
  } else if (name == "pose_jump_scan") {
    perturbation.jump_scan = whole_number(name, text, 0, kMostScans);
  } else if (name == "beams_of") {
    perturbation.beams_of = whole_number(name, text, 2, kMostBeams);
  } else if (name == "beams_top_deg") {
    perturbation.beams_top_deg = number_within(name, text, -90, 90);
  } else if (name == "beams_bottom_deg") {
    perturbation.beams_bottom_deg = number_within(name, text, -90, 90);
  } else if (name == "sensor_range_m") {
    perturbation.sensor_range_m = number_within(name, text, 1, 10'000);
  } else {
    return false;
  }
  return true;
}

void add_step(std::string_view name, std::string_view text, Perturbation& perturbation) {
  const PerturbKind& kind = perturb_kind_named(name);
  const double strength = number_within(name, text, kind.lowest, kind.highest);
  const bool counts = kind.unit == "beams" || kind.unit == "scans";
  if (counts && strength != std::floor(strength)) {
    refuse(fmt::format("{}: {} is no count", name, quoted(text)), "a whole number");
  }
  perturbation.steps.push_back({kind.name, strength});
}

void check_beams(const Perturbation& perturbation) {
  if (perturbation.beams_top_deg.has_value() != perturbation.beams_bottom_deg.has_value()) {
    refuse("one of beams_top_deg and beams_bottom_deg is missing", "both of them, or neither");
  }
  if (perturbation.beams_top_deg &&
      !(*perturbation.beams_top_deg > *perturbation.beams_bottom_deg)) {
    refuse("beams_top_deg is not above beams_bottom_deg", "elevations from top to bottom");
  }
  for (const PerturbStep& step : perturbation.steps) {
    if (step.kind != "beams") continue;
    if (perturbation.beams_of % static_cast<std::size_t>(step.strength) == 0) continue;
    refuse(fmt::format("beams: {:g} of {} cannot be evenly spaced", step.strength,
                       perturbation.beams_of),
           "a divisor of beams_of");
  }
}

/// A key that nothing uses is one whose kind was forgotten.
void check_used(const Perturbation& perturbation, const std::vector<std::string_view>& said) {
  if (perturbation.steps.empty()) refuse("no disturbance is given", "KIND=STRENGTH,...,seed=N");
  for (const PerturbKey& key : perturb_keys()) {
    if (key.kinds.empty() || std::ranges::find(said, key.name) == said.end()) continue;
    const bool is_used = std::ranges::any_of(perturbation.steps, [&](const PerturbStep& step) {
      return std::ranges::find(key.kinds, step.kind) != key.kinds.end();
    });
    if (is_used) continue;
    refuse(fmt::format("{} is given, but nothing that uses it", key.name),
           fmt::format("it with {}", fmt::join(key.kinds, " or ")));
  }
}

/// Returns the same word for a name everywhere (FNV-1a).
std::uint64_t word_of(std::string_view name) {
  std::uint64_t word = 0xCBF29CE484222325u;
  for (const char c : name) word = (word ^ static_cast<unsigned char>(c)) * 0x100000001B3u;
  return word;
}

class PerturbedSequence : public SequenceAround {
 public:
  PerturbedSequence(std::unique_ptr<Sequence> inner, const Perturbation& perturbation)
      : SequenceAround(std::move(inner)) {
    ScanList list{recording().scans, std::vector<std::size_t>(size())};
    std::iota(list.sources.begin(), list.sources.end(), std::size_t{0});
    const Draws draws = Draws(perturbation.seed).of(word_of(name()));
    for (std::size_t i = 0; i < perturbation.steps.size(); ++i) {
      const PerturbStep& step = perturbation.steps[i];
      const PerturbKind& kind = perturb_kind_named(step.kind);
      if (step.strength == kind.none) continue;
      add(kind, {kind, step.strength, draws.of(i), perturbation, this->inner().recording()}, list);
    }
    sources_ = std::move(list.sources);
    mutable_recording().scans = std::move(list.scans);
    mutable_recording().reading.perturb = perturbation;
    mutable_recording().remarks.push_back("disturbed on purpose: " + to_string(perturbation));
  }

  using Sequence::read;
  void read(std::size_t scan_index, Frame& frame) const override {
    const std::size_t source = sources_.at(scan_index);
    inner().read(source, frame);
    for (const ChangePoints& change : changes_) change(source, frame);
    frame.map_from_sensor = map_from_sensor(scan_index);
    frame.stamp_ns = stamp_ns(scan_index);
  }

  std::vector<std::uint32_t> read_truth(std::size_t scan_index) const override {
    if (!changes_truth_ || !has_truth(scan_index)) {
      return inner().read_truth(sources_.at(scan_index));
    }
    return Sequence::read_truth(scan_index);
  }

 private:
  void add(const PerturbKind& kind, const PerturbContext& context, ScanList& list) {
    if (kind.change_scans != nullptr) kind.change_scans(context, list);
    if (kind.point_change != nullptr) changes_.push_back(kind.point_change(context));
    changes_truth_ = changes_truth_ || kind.changes_truth;
  }

  std::vector<std::size_t> sources_;
  std::vector<ChangePoints> changes_;
  bool changes_truth_ = false;
};

}  // namespace

const PerturbKind& perturb_kind_named(std::string_view name) {
  const auto kind = std::ranges::find(perturb_kinds(), name, &PerturbKind::name);
  if (kind == perturb_kinds().end()) refuse_name(name);
  return *kind;
}

Perturbation parse_perturbation(std::string_view text) {
  Perturbation perturbation;
  std::vector<std::string_view> said;
  for (const std::string_view part : split_at_commas(text)) {
    const std::size_t equals = part.find('=');
    if (equals == std::string_view::npos) {
      refuse(fmt::format("{} has no value", quoted(part)), "KIND=STRENGTH,...,seed=N");
    }
    const std::string_view name = trim(part.substr(0, equals));
    const std::string_view value = trim(part.substr(equals + 1));
    if (!set_key(name, value, perturbation)) {
      add_step(name, value, perturbation);
    } else if (std::ranges::find(said, name) != said.end()) {
      refuse(fmt::format("{} is given twice", name), "it once");
    } else {
      said.push_back(name);
    }
  }
  check_beams(perturbation);
  check_used(perturbation, said);
  return perturbation;
}

bool changes_points_only(const Perturbation& perturbation) {
  return std::ranges::none_of(perturbation.steps, [](const PerturbStep& step) {
    const PerturbKind& kind = perturb_kind_named(step.kind);
    return kind.needs_poses || kind.change_scans != nullptr;
  });
}

std::unique_ptr<Sequence> perturbed(std::unique_ptr<Sequence> inner,
                                    const Perturbation& perturbation) {
  return std::make_unique<PerturbedSequence>(std::move(inner), perturbation);
}

}  // namespace mosbench
