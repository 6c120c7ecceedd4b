#include "eval/runs/run_plan.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <stdexcept>

#include "core/base/thread_pool.hpp"
#include "core/hmm_mos/pipeline.hpp"
#include "datasets/files/errors.hpp"
#include "datasets/sequence/fingerprint.hpp"
#include "eval/results/config_json.hpp"
#include "eval/results/reading_json.hpp"
#include "eval/results/same_input.hpp"
#include "eval/runs/presets.hpp"
#include "eval/runs/shared_folder.hpp"
#include "mosbench_version.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

const Preset& choose_preset(const RunOptions& options, DatasetKind kind, RunPlan& plan) {
  if (options.preset) return preset_named(*options.preset);
  const Preset& preset = default_preset(kind);
  plan.notes.push_back(
      fmt::format("preset {} taken because the data set is {}", preset.name, to_string(kind)));
  return preset;
}

Config settle_config(const RunOptions& options, const Preset& preset, Variant variant) {
  Config config = preset.config;
  if (options.config_file) apply_config_file(*options.config_file, config);
  for (const std::string& assignment : options.assignments) {
    apply_config_assignment(assignment, config);
  }
  try {
    const Pipeline refuses_what_does_not_go_together(config, variant);
  } catch (const std::invalid_argument& error) {
    throw UsageError(fmt::format("configuration: {}", error.what()));
  }
  return config;
}

Variant parse_variant(const std::optional<std::string>& name) {
  if (!name) return Variant::kPaper2024;
  if (const std::optional<Variant> variant = variant_from_string(*name)) return *variant;
  throw UsageError(
      fmt::format("--variant: '{}' is not known, expected paper-2024 or release-2025", *name));
}

RangeGate choose_range(const RunOptions& options, const Protocol& protocol, const Config& config) {
  if (options.range) return range_option(*options.range, protocol);
  // A benchmark with a range limit is scored over the range it was run at.
  const bool limited = protocol.range_rule != RangeRule::kNone && protocol.default_range.max_m > 0;
  return limited ? RangeGate{config.min_range_m, config.max_range_m} : protocol.default_range;
}

fs::path default_out(const RunPlan& plan, const RunOptions& options) {
  const fs::path folder = fs::absolute(options.input / "").lexically_normal().parent_path();
  return fs::path("results/runs") / fmt::format("{}-{}-{}", folder.filename().string(), plan.preset,
                                                to_string(plan.settings.variant));
}

nlohmann::ordered_json identity_of(const RunPlan& plan, const Sequence& sequence) {
  const RunSettings& settings = plan.settings;
  return {
      {"sequence", sequence.name()},
      {"dataset", std::string(to_string(plan.dataset.kind))},
      {"reading", to_json(sequence.reading())},
      {"variant", std::string(to_string(settings.variant))},
      {"protocol",
       {{"name", std::string(settings.protocol->name)},
        {"min_range_m", settings.range.min_m},
        {"max_range_m", settings.range.max_m}}},
      {"config", to_json(settings.config, settings.variant)},
      {"code", {{"version", std::string(kMosbenchVersion)}, {"compiler", std::string(kCompiler)}}}};
}

/// What the results of all sequences of a run have in common.
nlohmann::ordered_json shared_rules(const RunPlan& plan) {
  nlohmann::ordered_json rules = identity_of(plan, *plan.dataset.sequences.front());
  for (const char* own : {"sequence", "reading", "code"}) rules.erase(own);
  return rules;
}

PlannedSequence plan_sequence(const RunPlan& plan, std::size_t position, bool overwrite) {
  const Sequence& sequence = *plan.dataset.sequences[position];
  PlannedSequence planned{position, ResultFolder(plan.out / sequence.name()),
                          identity_of(plan, sequence), file_stamp(sequence), std::nullopt};
  if (overwrite) {
    planned.folder.check_replaceable();
    return planned;
  }
  planned.finished =
      planned.folder.finished(sequence, planned.identity, plan.settings.keeps_scores);
  if (planned.finished && !same_input(sequence, planned.stamp, *planned.finished)) {
    throw UsageError(fmt::format(
        "{}: holds results of other input files than {} has now, expected the same; give another "
        "--out, or --overwrite to replace them",
        planned.folder.path().string(), sequence.name()));
  }
  return planned;
}

}  // namespace

RunPlan plan_method(const RunOptions& options) {
  RunPlan plan;
  plan.settings.variant = parse_variant(options.variant);
  plan.settings.threads = options.threads > 0 ? options.threads : hardware_threads();
  plan.dataset = open_dataset(
      options.input, {dataset_kind_option(options.dataset), options.sequences, options.reading});
  const Preset& preset = choose_preset(options, plan.dataset.kind, plan);
  plan.reading = options.reading;
  plan.preset = preset.name;
  plan.settings.config = settle_config(options, preset, plan.settings.variant);
  plan.settings.protocol = &protocol_named(options.protocol.value_or(std::string(preset.protocol)));
  plan.settings.range = choose_range(options, *plan.settings.protocol, plan.settings.config);
  return plan;
}

RunPlan plan_run(const RunOptions& options) {
  RunPlan plan = plan_method(options);
  plan.settings.keeps_scores = options.scores;
  plan.out = options.out.value_or(default_out(plan, options));
  check_shared_folder(plan, shared_rules(plan));
  for (std::size_t i = 0; i < plan.dataset.sequences.size(); ++i) {
    plan.sequences.push_back(plan_sequence(plan, i, options.overwrite));
  }
  return plan;
}

std::optional<DatasetKind> dataset_kind_option(const std::string& name) {
  if (name == "auto") return std::nullopt;
  if (const std::optional<DatasetKind> kind = dataset_kind_from_string(name)) return kind;
  throw UsageError(
      fmt::format("--dataset: '{}' is not known, expected auto, {}", name, dataset_kind_names()));
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
