#include "eval/tables/differing_settings.hpp"

#include <algorithm>
#include <sstream>

namespace mosbench {
namespace {

using nlohmann::ordered_json;

/// Settings of one run, and whose they are: only those of one owner say the same by one name.
struct OwnedSettings {
  std::string owner;
  ordered_json values = ordered_json::object();
};

OwnedSettings of_method(const SequenceResult& result) {
  OwnedSettings settings{result.method, result.header.value("config", ordered_json::object())};
  if (!result.header.contains("config") && !result.setting.empty()) {
    settings.values["setting"] = result.setting;
  }
  return settings;
}

ordered_json reading_of(const SequenceResult& result) {
  return result.header.value("reading", ordered_json::object());
}

OwnedSettings of_poses(const SequenceResult& result) {
  OwnedSettings settings{result.method};
  const ordered_json reading = reading_of(result);
  if (!reading.contains("poses")) return settings;
  settings.values["poses"] =
      reading.contains("pose_odometry") ? reading.at("poses") : ordered_json("as given");
  return settings;
}

OwnedSettings of_disturbance(const SequenceResult& result) {
  OwnedSettings settings{result.method};
  const std::string perturb = disturbance_of(result);
  settings.values["perturb"] = perturb.empty() ? "none" : perturb;
  return settings;
}

/// Splits "voxel_size_m=0.5 ...", as the odometry states its settings.
OwnedSettings of_odometry(const SequenceResult& result) {
  const ordered_json reading = reading_of(result);
  OwnedSettings settings{reading.value("poses", "")};
  std::istringstream words(reading.value("pose_odometry", ""));
  for (std::string word; words >> word;) {
    const std::size_t equals = std::min(word.find('='), word.size() - 1);
    settings.values["odometry." + word.substr(0, equals)] = word.substr(equals + 1);
  }
  if (reading.contains("pose_map")) settings.values["odometry.map"] = reading.at("pose_map");
  return settings;
}

ordered_json value_of(const OwnedSettings& settings, const std::string& name) {
  return settings.values.value(name, ordered_json());
}

bool differs(const std::vector<OwnedSettings>& runs, const std::string& name) {
  const bool has_all = std::ranges::none_of(
      runs, [&](const OwnedSettings& run) { return value_of(run, name).is_null(); });
  for (std::size_t a = 0; a < runs.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const bool comparable = has_all || runs[a].owner == runs[b].owner;
      if (comparable && value_of(runs[a], name) != value_of(runs[b], name)) return true;
    }
  }
  return false;
}

std::vector<std::string> names_in(const std::vector<OwnedSettings>& runs) {
  std::vector<std::string> names;
  for (const OwnedSettings& run : runs) {
    for (const auto& [name, value] : run.values.items()) {
      if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
  }
  return names;
}

}  // namespace

std::string disturbance_of(const SequenceResult& result) {
  return reading_of(result).value("perturb", "");
}

std::vector<DifferingSetting> differing_settings(const std::vector<const ResultSet*>& runs) {
  std::vector<DifferingSetting> differing;
  for (const auto settings_of : {of_method, of_poses, of_disturbance, of_odometry}) {
    std::vector<OwnedSettings> owned;
    for (const ResultSet* run : runs) owned.push_back(settings_of(run->front()));
    for (const std::string& name : names_in(owned)) {
      if (!differs(owned, name)) continue;
      DifferingSetting& setting = differing.emplace_back(DifferingSetting{name, {}});
      for (const OwnedSettings& run : owned) setting.values.push_back(value_of(run, name));
    }
  }
  return differing;
}

}  // namespace mosbench
