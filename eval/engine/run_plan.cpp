#include "eval/engine/run_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

#include "datasets/disk/folder_listing.hpp"
#include "datasets/layouts/folder_search.hpp"
#include "datasets/sequence/fingerprint.hpp"
#include "datasets/text/errors.hpp"
#include "eval/job/method_choice.hpp"
#include "eval/job/tuned_preset.hpp"
#include "eval/protocols/benchmark_split.hpp"
#include "eval/result/reading_json.hpp"
#include "eval/result/result_file.hpp"
#include "eval/result/result_json.hpp"
#include "eval/result/result_scans.hpp"
#include "eval/result/settings_json.hpp"
#include "eval/result/tell.hpp"
#include "eval/result/version.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

fs::path default_out(const RunPlan& plan) {
  const fs::path folder = fs::absolute(plan.job.data.path / "").lexically_normal().parent_path();
  const RunSettings& settings = plan.settings;
  const bool has_variant = settings.method_settings.find(common_settings::kVariant) != nullptr;
  // The default method's folders are named by its variant.
  const std::string_view kind = settings.method == &default_method() && has_variant
                                    ? settings.method_settings.choice(common_settings::kVariant)
                                    : settings.method->name;
  std::string name = fmt::format("{}-{}", folder.filename().string(), plan.preset);
  const auto add = [&](std::string_view part) { name += fmt::format("-{}", part); };
  if (!plan.shared) add(kind);
  if (!plan.job.segment.label.empty()) add(plan.job.segment.label);
  const Reading& reading = plan.job.data.reading;
  // Runs over a part, with other poses or disturbed scans have results of their own.
  if (reading.scans) {
    std::string range = to_string(*reading.scans);
    std::ranges::replace(range, ':', '_');
    add("scans" + range);
  }
  if (reading.lidars) {
    std::string lidars = *reading.lidars;
    std::ranges::replace_if(
        lidars, [](char c) { return c == '/' || c == ','; }, '_');
    add("lidars" + lidars);
  }
  if (plan.odometry) add(plan.odometry->kind->name);
  if (reading.is_static()) add(kStaticPoses);
  if (reading.perturb) add(to_string(*reading.perturb));
  if (reading.refine_poses) add("refined");
  return fs::path("results/runs") / name;
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

PlannedSequence plan_sequence(RunPlan& plan, std::size_t position, const RunPlace& place) {
  const Sequence& sequence = *plan.dataset.sequences[position];
  PlannedSequence planned{position, ResultFolder(plan.out / sequence.name()),
                          asked_result(plan, position), file_stamp(sequence)};
  if (place.overwrite) {
    planned.folder.check_replaceable();
    return planned;
  }
  planned.finished = planned.folder.finished(sequence, planned.asked, plan.settings.point_files());
  if (!planned.finished) return planned;
  // An earlier mosbench did not keep which files the command of a program named.
  const std::string& program = planned.finished->from.program;
  const bool is_other = !program.empty() && program != planned.asked.from.program;
  if (is_other || changed_program_file(*planned.finished)) {
    plan.notes.push_back(fmt::format("{}: the program has changed, it is run again",
                                     title_of(sequence, plan.settings)));
    planned.finished = std::nullopt;
  } else {
    check_unchanged(plan, planned, place.verify);
  }
  return planned;
}

/// A preset sets what a method has. Names what it changes of the paper's method but not of this
/// one; of a method that has none of it, only the protocol is left.
void note_lacking_settings(const Preset& preset, RunPlan& plan) {
  const MethodKind& method = *plan.settings.method;
  const Settings& of_paper = default_method().defaults;
  bool has_any = false;
  std::vector<std::string_view> lacking;
  for (const PresetValue& value : preset.values) {
    const bool is_known = method.defaults.find(value.setting) != nullptr;
    has_any = has_any || is_known;
    if (is_known || !of_paper.find(value.setting)) continue;
    Settings changed = of_paper;
    changed.set(value.setting, value.value);
    if (to_json(changed) != to_json(of_paper)) lacking.push_back(value.setting);
  }
  if (!has_any) {
    plan.notes.push_back(fmt::format(
        "method {} has none of the settings of preset {}: it chooses the protocol alone",
        method.name, preset.name));
  } else if (!lacking.empty()) {
    plan.notes.push_back(fmt::format("preset {}: method {} has no {}, it runs without", preset.name,
                                     method.name, fmt::join(lacking, ", ")));
  }
}

/// `root` without the name of the sequence at its end: what holds all sequences, also where a
/// single one's folder was given.
fs::path without_name(fs::path root, fs::path name) {
  while (!name.empty() && root.filename() == name.filename()) {
    root = root.parent_path();
    name = name.parent_path();
  }
  return root;
}

bool same_dataset(const fs::path& a, const std::string& sequence_a, const fs::path& b,
                  const std::string& sequence_b) {
  return is_in(a, b) || is_in(b, a) || without_name(a, sequence_a) == without_name(b, sequence_b);
}

/// Empty when a result can stand beside those of the plan.
std::string other_run(const RunPlan& plan, const nlohmann::ordered_json& rules,
                      const Result& there) {
  const std::string changed = changed_members(identity_json(there), rules);
  if (!changed.empty() || !there.places || !there.places->dataset_root) return changed;
  const fs::path& root = *there.places->dataset_root;
  const fs::path& ours = plan.dataset.root;
  const std::string our_name = plan.dataset.sequences.front()->name();
  if (same_dataset(without_slash(root), there.sequence, without_slash(ours), our_name) ||
      same_dataset(resolved(root), there.sequence, resolved(ours), our_name)) {
    return "";
  }
  return fmt::format("data set is {} there and {} now", root.string(),
                     without_slash(ours).string());
}

/// Throws UsageError naming what lies there when the plan's folder holds results that are not of
/// the plan's sequences and come from another data set, method or setting: together they would be
/// no run that `stats`, `compare` or `table` could read.
void check_shared_folder(const RunPlan& plan) {
  if (std::error_code error; !fs::is_directory(plan.out, error)) return;
  // What all sequences of a run share.
  nlohmann::ordered_json rules = identity_json(asked_result(plan, 0));
  for (const char* own : {"sequence", "reading", "code"}) rules.erase(own);
  // Sequences lie there or in scenes. Deeper ones are not looked for: it may be a home.
  constexpr int kDeepest = 2;
  for (const fs::path& file :
       find_result_files(plan.out, fs::directory_options::skip_permission_denied, kDeepest)) {
    const bool planned = std::ranges::any_of(plan.dataset.sequences, [&](const auto& sequence) {
      return plan.out / sequence->name() == file.parent_path();
    });
    std::string other;
    try {
      if (!planned) other = other_run(plan, rules, read_result(file));
    } catch (const DataError&) {  // no result of ours
    }
    if (other.empty()) continue;
    throw UsageError(fmt::format(
        "{}: holds results of another run ({}: {}), expected those of one data set and setting; "
        "give another --out",
        plan.out.string(), file.string(), other));
  }
}

/// Throws RefusedRig for a rig and a method that looks from one place.
void check_origins(const Dataset& dataset, const MethodKind& method) {
  std::vector<std::string_view> others;
  for (const MethodKind& other : methods()) {
    if (other.takes_origins && !other.is_twin) others.push_back(other.name);
  }
  for (const auto& sequence : dataset.sequences) {
    const std::string& lidars = sequence->reading().lidars;
    if (lidars.empty() || method.takes_origins) continue;
    throw RefusedRig(fmt::format(
        "{} looks from one place, not from those of {}, expected one LiDAR, {}, or one of the "
        "methods {}",
        method.name, lidars, option("lidars", "NAME"), fmt::join(others, ", ")));
  }
}

}  // namespace

RunPlan open_job(const Job& job, unsigned threads, const std::shared_ptr<SharedReading>& shared) {
  RunPlan plan;
  plan.job = job;
  plan.odometry = job.odometry;
  plan.dataset = open_dataset(job.data.path, {job.data.kind, job.data.sequences, job.data.reading},
                              progress_over_sequences("refine poses of"));
  plan.shared = shared;
  if (shared) shared->share(plan.dataset);
  const Preset preset = preset_of(job, plan.dataset.kind);
  plan.preset = preset.name;
  if (job.segment.preset == nullptr) {
    plan.notes.push_back(fmt::format("preset {} taken because the data set is {}", preset.name,
                                     to_string(plan.dataset.kind)));
  }
  RunSettings& settings = plan.settings;
  settings.method = job.segment.method;
  settings.threads = threads;
  check_origins(plan.dataset, *settings.method);
  note_lacking_settings(preset, plan);
  settings.method_settings = settings_of(job, plan.dataset.kind);
  const ScoreRule rule = rule_of(job, plan.dataset.kind);
  settings.protocol = rule.protocol;
  settings.range = rule.range;
  if (!plan.odometry) return plan;
  if (plan.odometry->drop_moving) {
    plan.odometry->filter = moving_filter(*settings.method, settings.method_settings);
  }
  expect_poses(plan.dataset, *plan.odometry);
  return plan;
}

RunPlan plan_run(const Job& job, const RunPlace& place) {
  RunPlan plan = open_job(job, place.threads, place.shared);
  plan.settings.keeps_scores = place.scores;
  plan.settings.keeps_objects = place.objects;
  plan.settings.is_one_of_several = place.shared != nullptr;
  plan.out = place.out.value_or(default_out(plan));
  if (place.shared) plan.out /= plan.settings.method->name;
  check_shared_folder(plan);
  for (std::size_t i = 0; i < plan.dataset.sequences.size(); ++i) {
    plan.sequences.push_back(plan_sequence(plan, i, place));
  }
  return plan;
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
  if (const auto& tuned = plan.job.segment.tuned) {
    asked.settings_from = tuned->title();
    for (const SettingChange& change : tuned->settings) {
      const SettingValue* value = asked.settings->find(change.name);
      if (value == nullptr || *value == change.value) continue;
      asked.settings_from += fmt::format("; here {}", to_words({{change.name, *value}}));
    }
  }
  asked.protocol = settings.protocol;
  asked.range = settings.range;
  asked.from.version = kMosbenchVersion;
  asked.from.compiler = kCompiler;
  asked.from.reading = members_of(sequence.reading());
  asked.from.program_files = files_of_program(*settings.method);
  asked.from.program = hash_of_program(asked.from.program_files);
  if (plan.odometry) asked.from.odometry = odometry_done(*plan.odometry);
  asked.splits = picked_stems(plan.dataset, position);
  const Split* benchmark = benchmark_scans(*settings.protocol, plan.dataset.splits);
  if (benchmark != nullptr) asked.summary_split = benchmark->name;
  return asked;
}

}  // namespace mosbench
