#include "eval/engine/run_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include "datasets/sequence/fingerprint.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/engine/shared_folder.hpp"
#include "eval/job/method_choice.hpp"
#include "eval/job/presets.hpp"
#include "eval/protocols/benchmark_split.hpp"
#include "eval/result/reading_json.hpp"
#include "eval/result/result_json.hpp"
#include "eval/result/result_scans.hpp"
#include "eval/result/settings_json.hpp"
#include "eval/result/version.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

Preset choose_preset(const RunOptions& options, DatasetKind kind) {
  return options.preset ? preset_for(preset_named(*options.preset), kind) : default_preset(kind);
}

const Protocol& choose_protocol(const RunOptions& options, const Preset& preset) {
  return protocol_named(options.protocol.value_or(std::string(preset.protocol)));
}

/// A variant by its name.
void apply_variant(const std::string& name, const MethodKind& method, Settings& settings) {
  if (settings.find(common_settings::kVariant) == nullptr) {
    throw UsageError(
        fmt::format("--variant: method {} has no variants, leave the flag out", method.name));
  }
  try {
    settings.set(common_settings::kVariant, name);
  } catch (const std::invalid_argument&) {
    throw UsageError(
        fmt::format("--variant: '{}' is not known, expected {}", name,
                    fmt::join(settings.find(common_settings::kVariant)->choices, " or ")));
  }
}

/// moving=now, ever or ever:SECONDS: a short word of the methods that have it.
void apply_word(std::string_view name, const std::string& text, const MethodKind& method,
                Settings& settings) {
  const auto word_of = [&](const MethodKind& kind) {
    const auto found = std::ranges::find(kind.words, name, &SettingWord::name);
    return found == kind.words.end() ? nullptr : &*found;
  };
  const MethodKind& owner =
      word_of(method) != nullptr ? method : *std::ranges::find_if(methods(), word_of);
  const SettingWord& word = *word_of(owner);
  if (text == word.usual) return;
  const std::string with_number = fmt::format("{}:", word.value);
  const bool has_number =
      text.starts_with(with_number) && parse_double(text.substr(with_number.size())).has_value();
  if (text != word.value && !has_number) {
    throw UsageError(fmt::format("{}: '{}' is not known, expected {}, {} or {}{}", name, text,
                                 word.usual, word.value, with_number, word.number));
  }
  if (&owner != &method) {
    throw UsageError(fmt::format("{}={}: method {} {}, expected {}", name, text, method.name,
                                 word.lacking, owner.name));
  }
  for (const std::string_view taking : word.takes) {
    const std::string number =
        has_number ? text.substr(with_number.size()) : to_string(settings.find(taking)->highest);
    apply_setting_assignment(fmt::format("{}={}", taking, number), settings);
  }
  for (const PresetValue& set : word.sets) settings.set(set.setting, set.value);
}

Settings choose_settings(const RunOptions& options, const Preset& preset,
                         const MethodKind& method) {
  Settings settings = settings_of(preset, method);
  if (options.config_file) apply_settings_file(*options.config_file, settings);
  if (options.variant) apply_variant(*options.variant, method, settings);
  apply_word("moving", options.moving, method, settings);
  for (const std::string& assignment : options.assignments) {
    apply_setting_assignment(assignment, settings);
  }
  try {
    method.check(settings);
  } catch (const std::invalid_argument& error) {
    throw UsageError(fmt::format("configuration: {}", error.what()));
  }
  return settings;
}

/// A benchmark with a range limit is scored over the range it was run at.
bool is_scored_where_run(const Protocol& protocol) {
  return protocol.range_rule != RangeRule::kNone && protocol.default_range.max_m > 0;
}

RangeGate choose_range(const RunOptions& options, const Protocol& protocol,
                       const Settings& settings) {
  if (options.range) return range_option(*options.range, protocol);
  const bool known = settings.find(common_settings::kMinRange_m) != nullptr &&
                     settings.find(common_settings::kMaxRange_m) != nullptr;
  return is_scored_where_run(protocol) && known
             ? RangeGate{settings.number(common_settings::kMinRange_m),
                         settings.number(common_settings::kMaxRange_m)}
             : protocol.default_range;
}

fs::path default_out(const RunPlan& plan, const RunOptions& options) {
  const fs::path folder = fs::absolute(options.input / "").lexically_normal().parent_path();
  const RunSettings& settings = plan.settings;
  const bool has_variant = settings.method_settings.find(common_settings::kVariant) != nullptr;
  // The default method's folders are named by its variant.
  const std::string_view kind = settings.method == &default_method() && has_variant
                                    ? settings.method_settings.choice("variant")
                                    : settings.method->name;
  // A run with other poses has results of its own.
  const std::string poses = plan.odometry ? fmt::format("-{}", plan.odometry->kind->name) : "";
  // So has one with disturbed scans.
  const std::string perturb =
      options.reading.perturb ? "-" + to_string(*options.reading.perturb) : "";
  const std::string data = fmt::format("{}-{}", folder.filename().string(), plan.preset);
  std::string moving = options.moving == "now" ? "" : "-" + options.moving;
  std::ranges::replace(moving, ':', '-');
  const std::string method = options.shared ? "" : fmt::format("-{}", kind);
  return fs::path("results/runs") / (data + method + moving + poses + perturb);
}

/// What the results of all sequences of a run have in common.
nlohmann::ordered_json shared_rules(const RunPlan& plan) {
  nlohmann::ordered_json rules = identity_json(asked_result(plan, 0));
  for (const char* own : {"sequence", "reading", "code"}) rules.erase(own);
  return rules;
}

/// Throws UsageError unless a finished result is of the input that there is now and as it was
/// written.
void check_unchanged(const RunPlan& plan, const PlannedSequence& planned, bool verify) {
  const Sequence& sequence = *plan.dataset.sequences[planned.position];
  const Result& result = *planned.finished;
  const auto refuse = [&](const std::string& other) {
    throw UsageError(
        fmt::format("{}: holds results of other {} than {} has now, expected the "
                    "same; give another --out, or --overwrite to replace them",
                    planned.folder.path().string(), other, sequence.name()));
  };
  if (result.splits != picked_stems(plan.dataset, planned.position)) refuse("split files");
  const auto stamp = verify ? std::nullopt : std::optional(planned.stamp);
  if (!same_input(sequence, stamp, result)) refuse("input files");
  planned.folder.check_labels(result);
}

PlannedSequence plan_sequence(const RunPlan& plan, std::size_t position,
                              const RunOptions& options) {
  const Sequence& sequence = *plan.dataset.sequences[position];
  PlannedSequence planned{position, ResultFolder(plan.out / sequence.name()),
                          asked_result(plan, position), file_stamp(sequence), std::nullopt};
  if (options.overwrite) {
    planned.folder.check_replaceable();
    return planned;
  }
  planned.finished = planned.folder.finished(sequence, planned.asked, plan.settings.point_files());
  if (planned.finished) check_unchanged(plan, planned, options.verify);
  return planned;
}

/// Names what a preset changes of the paper's method, but not of this one.
void note_lacking_settings(const Preset& preset, RunPlan& plan) {
  const MethodKind& method = *plan.settings.method;
  const Settings& of_paper = default_method().defaults;
  std::vector<std::string_view> lacking;
  for (const PresetValue& value : preset.values) {
    if (method.defaults.find(value.setting) || !of_paper.find(value.setting)) continue;
    Settings changed = of_paper;
    changed.set(value.setting, value.value);
    if (to_json(changed) != to_json(of_paper)) lacking.push_back(value.setting);
  }
  if (lacking.empty()) return;
  plan.notes.push_back(fmt::format("preset {}: method {} has no {}, it runs without", preset.name,
                                   method.name, fmt::join(lacking, ", ")));
}

/// A preset sets what a method has; of a method that has none of it, only the protocol is left.
void note_preset_without_settings(const Preset& preset, RunPlan& plan) {
  const MethodKind& method = *plan.settings.method;
  const bool has_any = std::ranges::any_of(preset.values, [&](const PresetValue& value) {
    return method.defaults.find(value.setting) != nullptr;
  });
  if (has_any) return note_lacking_settings(preset, plan);
  plan.notes.push_back(
      fmt::format("method {} has none of the settings of preset {}: it chooses the protocol alone",
                  method.name, preset.name));
}

}  // namespace

RunPlan plan_method(const RunOptions& options) {
  RunPlan plan;
  plan.settings.method = &method_of(options.method, options.preset);
  plan.settings.threads = options.threads;
  plan.reading = options.reading;
  plan.odometry = named_odometry(options.odometry, options.reading);
  if (plan.odometry) plan.reading.poses = ByOdometry{};
  plan.dataset = open_dataset(
      options.input, {dataset_kind_option(options.dataset), options.sequences, plan.reading});
  plan.shared = options.shared;
  if (plan.shared) plan.shared->share(plan.dataset);
  const Preset preset = choose_preset(options, plan.dataset.kind);
  plan.preset = preset.name;
  if (!options.preset) {
    plan.notes.push_back(fmt::format("preset {} taken because the data set is {}", preset.name,
                                     to_string(plan.dataset.kind)));
  }
  note_preset_without_settings(preset, plan);
  plan.settings.method_settings = choose_settings(options, preset, *plan.settings.method);
  plan.settings.protocol = &choose_protocol(options, preset);
  plan.settings.range =
      choose_range(options, *plan.settings.protocol, plan.settings.method_settings);
  if (!plan.odometry) return plan;
  if (options.odometry.drop_moving) {
    plan.odometry->filter = moving_filter(*plan.settings.method, plan.settings.method_settings);
  }
  expect_poses(plan.dataset, *plan.odometry);
  return plan;
}

RunPlan plan_run(const RunOptions& options) {
  RunPlan plan = plan_method(options);
  plan.settings.keeps_scores = options.scores;
  plan.settings.is_one_of_several = options.shared != nullptr;
  plan.out = options.out.value_or(default_out(plan, options));
  if (options.shared) plan.out /= plan.settings.method->name;
  check_shared_folder(plan, shared_rules(plan));
  for (std::size_t i = 0; i < plan.dataset.sequences.size(); ++i) {
    plan.sequences.push_back(plan_sequence(plan, i, options));
  }
  return plan;
}

ScoreRule score_rule(const RunOptions& options, DatasetKind kind) {
  const Preset preset = choose_preset(options, kind);
  const Protocol& protocol = choose_protocol(options, preset);
  Settings settings;
  if (!options.range && is_scored_where_run(protocol)) {
    settings = choose_settings(options, preset, method_of(options.method, options.preset));
  }
  return {&protocol, choose_range(options, protocol, settings)};
}

std::optional<DatasetKind> dataset_kind_option(const std::string& name) {
  if (name == "auto") return std::nullopt;
  if (const std::optional<DatasetKind> kind = dataset_kind_from_string(name)) return kind;
  throw UsageError(
      fmt::format("--dataset: '{}' is not known, expected auto, {}", name, dataset_kind_names()));
}

Result asked_result(const RunPlan& plan, std::size_t position) {
  const RunSettings& settings = plan.settings;
  const Sequence& sequence = *plan.dataset.sequences[position];
  Result asked;
  asked.sequence = SequenceName(sequence.name(), plan.dataset.root);
  asked.dataset = to_string(plan.dataset.kind);
  asked.method = settings.method->title;
  asked.kind = settings.method->name;
  asked.settings = RecordedSettings(settings.method_settings);
  asked.preset = plan.preset;
  asked.protocol = settings.protocol;
  asked.range = settings.range;
  asked.from.version = kMosbenchVersion;
  asked.from.compiler = kCompiler;
  asked.from.reading = members_of(sequence.reading());
  if (plan.odometry) asked.from.odometry = odometry_done(*plan.odometry);
  asked.splits = picked_stems(plan.dataset, position);
  const Split* benchmark = benchmark_scans(*settings.protocol, plan.dataset.splits);
  if (benchmark != nullptr) asked.summary_split = benchmark->name;
  return asked;
}

RangeGate range_option(const std::string& text, const Protocol& protocol) {
  RangeGate range;
  int used = 0;
  const int fields = std::sscanf(text.c_str(), "%lf,%lf%n", &range.min_m, &range.max_m, &used);
  const bool whole = fields == 2 && static_cast<std::size_t>(used) == text.size();
  if (!whole || !(range.min_m >= 0.0) || !(range.max_m > range.min_m || range.max_m == -1.0)) {
    throw UsageError(fmt::format(
        "--range: '{}' is no range, expected MIN,MAX in metres with 0 <= MIN < MAX (MAX -1: none)",
        text));
  }
  if (protocol.range_rule == RangeRule::kNone && range != protocol.default_range) {
    throw UsageError(fmt::format("--range: protocol {} counts points at every range, expected none",
                                 protocol.name));
  }
  return range;
}

}  // namespace mosbench
