#include "eval/tables/differing_settings.hpp"

#include <algorithm>

namespace mosbench {
namespace {

/// Settings of one run, and whose they are: only those of one owner say the same by one name.
struct OwnedSettings {
  std::string owner;
  RecordedSettings values = {};
};

OwnedSettings of_method(const Result& result) {
  OwnedSettings settings{result.method, result.settings.value_or(RecordedSettings{})};
  if (!result.settings && !result.setting.empty()) settings.values.set("setting", result.setting);
  return settings;
}

OwnedSettings of_poses(const Result& result) {
  OwnedSettings settings{result.method};
  const bool tells = std::ranges::find(result.from.reading, "poses", [](const auto& statement) {
                       return statement.first;
                     }) != result.from.reading.end();
  if (result.from.odometry) {
    settings.values.set("poses", result.from.odometry->name);
  } else if (tells) {
    settings.values.set("poses", std::string("as given"));
  }
  return settings;
}

OwnedSettings of_disturbance(const Result& result) {
  OwnedSettings settings{result.method};
  const std::string perturb = disturbance_of(result);
  settings.values.set("perturb", perturb.empty() ? "none" : perturb);
  return settings;
}

OwnedSettings of_odometry(const Result& result) {
  if (!result.from.odometry) return {""};
  const OdometryDone& odometry = *result.from.odometry;
  OwnedSettings settings{odometry.name};
  for (const auto& [name, value] : odometry.settings.all()) {
    settings.values.set("odometry." + name, value);
  }
  if (!odometry.map.empty()) settings.values.set("odometry.map", odometry.map);
  return settings;
}

bool are_same(const SettingValue* one, const SettingValue* other) {
  if (one == nullptr || other == nullptr) return one == other;
  return are_equal(*one, *other);
}

bool differs(const std::vector<OwnedSettings>& runs, const std::string& name) {
  const bool has_all = std::ranges::none_of(
      runs, [&](const OwnedSettings& run) { return run.values.find(name) == nullptr; });
  for (std::size_t a = 0; a < runs.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const bool comparable = has_all || runs[a].owner == runs[b].owner;
      if (comparable && !are_same(runs[a].values.find(name), runs[b].values.find(name))) {
        return true;
      }
    }
  }
  return false;
}

std::vector<std::string> names_in(const std::vector<OwnedSettings>& runs) {
  std::vector<std::string> names;
  for (const OwnedSettings& run : runs) {
    for (const auto& [name, value] : run.values.all()) {
      if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
  }
  return names;
}

}  // namespace

std::vector<DifferingSetting> differing_settings(const std::vector<const ResultSet*>& runs) {
  std::vector<DifferingSetting> differing;
  for (const auto settings_of : {of_method, of_poses, of_disturbance, of_odometry}) {
    std::vector<OwnedSettings> owned;
    for (const ResultSet* run : runs) owned.push_back(settings_of(run->front()));
    for (const std::string& name : names_in(owned)) {
      if (!differs(owned, name)) continue;
      DifferingSetting& setting = differing.emplace_back(DifferingSetting{name, {}});
      for (const OwnedSettings& run : owned) {
        const SettingValue* value = run.values.find(name);
        setting.values.push_back(value == nullptr ? std::nullopt : std::optional(*value));
      }
    }
  }
  return differing;
}

}  // namespace mosbench
