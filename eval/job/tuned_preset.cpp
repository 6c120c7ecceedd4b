#include "eval/job/tuned_preset.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <ranges>
#include <stdexcept>

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/json_text.hpp"
#include "eval/job/study_drives.hpp"
#include "eval/result/settings_json.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

ordered_json to_json(const TunedSequence& sequence) {
  return {{"label", sequence.label},
          {"dataset", sequence.dataset},
          {"sequence", sequence.sequence},
          {"simulation", sequence.simulation},
          {"fingerprint", sequence.fingerprint},
          {"scans", sequence.scans}};
}

TunedPreset parsed(const ordered_json& json) {
  TunedPreset preset;
  preset.method = &method_named(json.at("method").get<std::string>());
  if (const ordered_json& base = json.at("preset"); !base.is_null()) {
    preset.base = &preset_named(base.get<std::string>());
  }
  std::vector<std::string> assignments;
  const RecordedSettings settings = recorded_settings(json.at("settings"));
  for (const auto& [name, value] : settings.all()) {
    assignments.push_back(fmt::format("{}={}", name, value_text(value)));
  }
  preset.method = &taking(*preset.method, assignments);
  for (const std::string& assignment : assignments) {
    preset.settings.push_back(change_of(assignment, *preset.method));
  }
  json.at("metric").get_to(preset.metric);
  json.at("study").get_to(preset.study);
  for (const ordered_json& one : json.at("tuned_on")) {
    preset.tuned_on.push_back({one.at("label"), one.at("dataset"), one.at("sequence"),
                               one.at("simulation"), one.at("fingerprint"),
                               one.value("scans", std::set<std::uint64_t>())});
  }
  return preset;
}

}  // namespace

std::string TunedPreset::words() const {
  const auto labels = tuned_on | std::views::transform(&TunedSequence::label);
  return fmt::format("preset {} with {}, tuned on {} by {} (study {})",
                     base != nullptr ? base->name : "of the data set", to_words(settings),
                     fmt::join(labels, ", "), metric, study);
}

std::string TunedPreset::title() const { return fmt::format("{}: {}", file.string(), words()); }

ordered_json to_json(const TunedPreset& preset) {
  ordered_json settings = ordered_json::object(), tuned_on = ordered_json::array();
  for (const SettingChange& change : preset.settings) {
    settings[change.name] = to_json(change.value);
  }
  for (const TunedSequence& sequence : preset.tuned_on) tuned_on.push_back(to_json(sequence));
  const bool is_program = Segment{.method = preset.method}.is_program();
  return {{"format", 1},
          {"method", std::string(is_program ? preset.method->title : preset.method->name)},
          {"preset", preset.base != nullptr ? ordered_json(preset.base->name) : ordered_json()},
          {"settings", settings},
          {"metric", preset.metric},
          {"study", preset.study},
          {"tuned_on", tuned_on}};
}

TunedPreset read_tuned_preset(const std::filesystem::path& file) {
  try {
    TunedPreset preset = parsed(parse_json(read_file(file), file));
    preset.file = file;
    return preset;
  } catch (const ordered_json::exception&) {
    throw UsageError(fmt::format(
        "{}: is no preset, expected a file that a study with best_of wrote", file.string()));
  } catch (const DataError& error) {
    throw UsageError(error.what());
  } catch (const std::invalid_argument& error) {
    throw UsageError(fmt::format("{}: {}", file.string(), error.what()));
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("{}: {}", file.string(), error.what()));
  }
}

bool is_preset_file(const std::string& preset) { return preset.ends_with(".json"); }

std::string tuning_doubt(const TunedPreset& preset, const Result& result,
                         const std::set<std::uint64_t>& scans) {
  const std::string simulation = drive_of(result.from.simulated);
  const auto named = std::ranges::find_if(preset.tuned_on, [&](const TunedSequence& one) {
    const bool has_name = one.dataset == result.dataset && one.sequence == result.sequence.text();
    const bool may_be_named = has_name && (one.scans.empty() || scans.empty());
    return one.simulation == simulation && (may_be_named || !simulation.empty());
  });
  const auto same = std::ranges::find_if(preset.tuned_on, [&](const TunedSequence& one) {
    const std::string& fingerprint = result.from.fingerprint_without_poses;
    return share_a_scan(one.scans, scans) ||
           (one.fingerprint == fingerprint && !fingerprint.empty());
  });
  if (same != preset.tuned_on.end()) {
    return fmt::format("tuned on this sequence: {} chose its settings on {}", preset.file.string(),
                       same->label);
  }
  if (named != preset.tuned_on.end()) {
    return fmt::format("tuned on a sequence of this {}: {} chose its settings on {}",
                       simulation.empty() ? "name" : "simulation", preset.file.string(),
                       named->label);
  }
  const auto seed = std::ranges::find_if(preset.tuned_on, [&](const TunedSequence& one) {
    return !simulation.empty() && scene_of(one.simulation) == scene_of(simulation);
  });
  if (seed == preset.tuned_on.end()) return "";
  return fmt::format("tuned on another seed of this scene: {} chose its settings on {}",
                     preset.file.string(), seed->label);
}

}  // namespace mosbench
