#include "eval/job/method_choice.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include "datasets/layouts/layout.hpp"
#include "eval/exec/exec_method.hpp"
#include "eval/result/settings_json.hpp"

namespace mosbench {
namespace {

constexpr std::string_view kExec = "exec:";

/// Presets that are of a data set, but not its usual one.
constexpr std::pair<std::string_view, DatasetKind> kOthers[] = {
    {"doals-120m", DatasetKind::kDoals}, {"helimos-delayed", DatasetKind::kHelimos}};

/// The data set that a preset is of; nothing: any.
std::optional<DatasetKind> kind_of(std::string_view preset) {
  for (const Layout* layout : layouts()) {
    if (layout->usual.preset == preset) return layout->kind();
  }
  for (const auto& [other, kind] : kOthers) {
    if (other == preset) return kind;
  }
  return std::nullopt;
}

/// All methods of a benchmark that this build can run.
MethodChoice all_methods() {
  MethodChoice choice;
  for (const MethodKind& method : methods()) {
    if (method.is_twin) continue;
    try {
      method.check(method.defaults);
      choice.names.emplace_back(method.name);
    } catch (const std::invalid_argument& error) {
      choice.notes.push_back(fmt::format("{} is left out: {}", method.name, error.what()));
    }
  }
  return choice;
}

std::string settings_text(const Settings& settings) {
  std::vector<std::string> words;
  for (const Setting& setting : settings.all()) {
    words.push_back(fmt::format("{}={}", setting.name, to_string(setting.value)));
  }
  return fmt::format("{}", fmt::join(words, " "));
}

}  // namespace

std::span<const Preset> presets() {
  // Numbers of a data set are computed by its usual protocol with any of its presets.
  static const std::vector<Preset> kPresets = [] {
    std::vector<Preset> presets;
    for (const MethodPreset& row : method_presets()) {
      const std::optional<DatasetKind> kind = kind_of(row.name);
      presets.push_back({row, kind, kind ? layout_of(*kind).usual.protocol : ""});
    }
    return presets;
  }();
  return kPresets;
}

const Preset& preset_named(std::string_view name) { return row_named(presets(), name, "--preset"); }

Settings settings_of(const Preset& preset, const MethodKind& method) {
  Settings settings = method.defaults;
  for (const PresetValue& value : preset.values) {
    if (settings.find(value.setting) == nullptr) continue;
    try {
      settings.set(value.setting, value.value);
    } catch (const std::invalid_argument& error) {
      throw UsageError(fmt::format("--preset {}: does not suit method {}: {}", preset.name,
                                   method.name, error.what()));
    }
  }
  return settings;
}

Preset preset_for(const Preset& preset, DatasetKind kind) {
  if (preset.kind) return preset;
  const Preset& usual = default_preset(kind);
  std::vector<PresetValue> values = usual.values;
  values.insert(values.end(), preset.values.begin(), preset.values.end());
  return {{preset.name, values, preset.source, preset.method}, usual.kind, usual.protocol};
}

const Preset& default_preset(DatasetKind kind) {
  return preset_named(layout_of(kind).usual.preset);
}

const MethodKind& method_named(const std::string& name) {
  if (name.starts_with(kExec)) return exec_method(name.substr(kExec.size()));
  if (const MethodKind* method = find_method(name)) return *method;
  std::vector<std::string_view> names;
  for (const MethodKind& method : methods()) names.push_back(method.name);
  throw UsageError(
      fmt::format("--method: '{}' is not known, expected one of {} or exec:COMMAND (nearest: {})",
                  name, fmt::join(names, ", "), nearest_name(name, names)));
}

const MethodKind& taking(const MethodKind& method, const std::vector<std::string>& assignments) {
  if (method.name != kExecKind) return method;
  const auto known = method.defaults.all().subspan(1);  // without timeout_s
  std::vector<Setting> own(known.begin(), known.end());
  for (const std::string& assignment : assignments) {
    const std::string_view text = assignment;
    const std::size_t equals = text.find('=');
    const std::string_view name = text.substr(0, equals);
    if (equals == text.npos || equals == 0 || name == kTimeout_s) continue;  // refused when set
    if (std::ranges::find(own, name, &Setting::name) != own.end()) continue;
    Setting& setting = own.emplace_back();
    setting.name = name;
    setting.meaning = "of the program";
    setting.lowest = std::numeric_limits<double>::lowest();
    setting.highest = std::numeric_limits<double>::max();
    setting.value = parse_double(text.substr(equals + 1)) ? SettingValue(0.0) : std::string();
  }
  return exec_method(std::string(method.title.substr(kExec.size())), own);
}

const MethodKind& method_of(const std::optional<std::string>& method,
                            const std::optional<std::string>& preset) {
  const MethodKind* named = method ? &method_named(*method) : nullptr;
  const std::string_view of_preset = preset ? preset_named(*preset).method : "";
  if (of_preset.empty()) return named != nullptr ? *named : default_method();
  if (named == nullptr || named->name == of_preset) return *find_method(of_preset);
  throw UsageError(fmt::format("--preset {}: is of method {}, expected no --method or this one",
                               *preset, of_preset));
}

bool names_several_methods(const std::string& text) {
  return text == "all" || (!text.starts_with(kExec) && text.find(',') != std::string::npos);
}

MethodChoice chosen_methods(const std::string& text) {
  if (text == "all") return all_methods();
  MethodChoice choice;
  for (std::size_t begin = 0; begin <= text.size();) {
    // A command may hold commas.
    const bool is_command = std::string_view(text).substr(begin).starts_with(kExec);
    const std::size_t end = is_command ? text.size() : std::min(text.find(',', begin), text.size());
    const std::string name = text.substr(begin, end - begin);
    method_named(name);
    if (std::ranges::find(choice.names, name) != choice.names.end()) {
      throw UsageError(fmt::format("--method: names {} twice, expected each method once", name));
    }
    choice.names.push_back(name);
    begin = end + 1;
  }
  return choice;
}

OdometryChoice choose_odometry(const OdometryOptions& options, const Reading& reading) {
  const std::string name = options.kind.value_or(std::string(odometries().front().name));
  OdometryChoice choice{.kind = &row_named(odometries(), name, "--odometry"), .settings = {}};
  choice.settings = choice.kind->defaults;
  if (options.preset) {
    const auto& preset = row_named(odometry_presets(), *options.preset, "preset of odometry");
    if (preset.odometry != choice.kind->name) {
      throw UsageError(fmt::format("preset of odometry: {} is of {}, expected one of {}",
                                   preset.name, preset.odometry, choice.kind->name));
    }
    for (const auto& [key, value] : preset.settings) choice.settings.set(key, value);
  }
  if (options.config_file) apply_settings_file(*options.config_file, choice.settings);
  if (reading.deskew) {
    choice.deskew = *reading.deskew;
    choice.says_deskew = true;
    choice.settings.set("deskew", std::string(to_string(choice.deskew)));
  }
  choice.drop_moving = options.drop_moving;
  for (const std::string& assignment : options.assignments) {
    apply_setting_assignment(assignment, choice.settings);
  }
  try {
    choice.kind->check(choice.settings);
  } catch (const std::invalid_argument& error) {
    throw UsageError(fmt::format("odometry: {}", error.what()));
  }
  return choice;
}

std::optional<OdometryChoice> named_odometry(const OdometryOptions& odometry,
                                             const Reading& reading) {
  if (!odometry.kind) {
    const bool says_nothing = !odometry.preset && !odometry.config_file &&
                              odometry.assignments.empty() && !odometry.drop_moving;
    if (says_nothing) return std::nullopt;
    throw UsageError("--odometry: is missing, expected simple or kiss before its settings");
  }
  if (reading.refine_poses) {
    throw UsageError(
        "--refine-poses and --odometry: correct given poses and find new ones, expected one of "
        "them");
  }
  if (!reading.has_own_poses()) {
    throw UsageError("--poses and --odometry: say where poses come from, expected one of them");
  }
  return choose_odometry(odometry, reading);
}

MovingFilter moving_filter(const MethodKind& method, Settings settings) {
  for (const std::string_view late :
       {common_settings::kDelay_scans, common_settings::kTrackWindow_s}) {
    if (settings.find(late) != nullptr) settings.set(late, 0);
  }
  try {
    method.check(settings);
  } catch (const std::invalid_argument& error) {
    throw UsageError(fmt::format("drop_moving: needs method {} with delay_scans=0: {}", method.name,
                                 error.what()));
  }
  return {&method, std::move(settings)};
}

OdometryDone odometry_done(const OdometryChoice& choice) {
  OdometryDone done{
      fmt::format("odometry {}", choice.kind->name), RecordedSettings(choice.settings), {}};
  if (choice.filter) {
    done.map = fmt::format("without what {} finds moving: {}", choice.filter->method->name,
                           settings_text(choice.filter->settings));
  }
  return done;
}

PosesDone statement_of(const OdometryChoice& choice) {
  const OdometryDone done = odometry_done(choice);
  return {.source = done.name, .odometry = settings_text(choice.settings), .map = done.map};
}

}  // namespace mosbench
