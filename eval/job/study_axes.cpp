#include "eval/job/study_axes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "datasets/sequence/portable_math.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

/// Returns one value of --perturb, which cannot hold another disturbance.
std::string perturb_value(const YamlNode& node) {
  std::string text = node.text();
  if (text.find(',') == std::string::npos) return text;
  node.refuse(fmt::format("{} is more than one value", mosbench::quoted(text)), "no comma");
}

StudyAxis disturbance_of(const YamlNode& node) {
  node.check_keys({"kind", "strengths", "with"});
  StudyAxis axis;
  const YamlNode kind = node.at("kind");
  axis.name = kind.text();
  axis.kind = kind.located([&] { return &perturb_kind_named(axis.name); });
  if (const auto with = node.find("with")) {
    for (const auto& [key, value] : with->members()) {
      if (std::ranges::find(perturb_keys(), key, &PerturbKey::name) == perturb_keys().end() ||
          key == "seed") {
        value.refuse(fmt::format("key {} is no key that kinds share", mosbench::quoted(key)),
                     "one of `mosbench list perturbations` but seed");
      }
      axis.with += fmt::format(",{}={}", key, perturb_value(value));
    }
  }
  for (const YamlNode& strength : node.at("strengths").list()) {
    const std::string text = fmt::format("{}={}{}", axis.name, perturb_value(strength), axis.with);
    const Perturbation parsed = strength.located([&] { return parse_perturbation(text); });
    axis.values.push_back(fmt::format("{}", parsed.steps.front().strength));
  }
  return axis;
}

/// Returns the values of a setting, checked by all methods that have it, and what one of them says
/// of it. `place` is where its name stands.
std::pair<Setting, std::vector<SettingValue>> setting_values(
    const std::string& name, const YamlNode& place, const std::vector<YamlNode>& nodes,
    const std::vector<StudyMethod>& methods) {
  std::optional<Setting> known;
  std::vector<SettingValue> values;
  for (const StudyMethod& method : methods) {
    const Setting* setting = method.segment.method->defaults.find(name);
    if (setting == nullptr) continue;
    known = *setting;
    values.clear();
    for (const YamlNode& node : nodes) {
      values.push_back(change_by(name, node, *method.segment.method).value);
    }
  }
  if (known) return {*known, values};
  place.refuse(fmt::format("no method has a setting {}", mosbench::quoted(name)),
               "one of `mosbench list methods`");
}

StudyAxis setting_of(const YamlNode& node, const std::vector<StudyMethod>& methods) {
  node.check_keys({"setting", "values"});
  StudyAxis axis;
  axis.name = node.at("setting").text();
  const auto nodes = node.at("values").list();
  for (const SettingValue& value :
       setting_values(axis.name, node.at("setting"), nodes, methods).second) {
    axis.values.push_back(to_string(value));
    axis.changes.push_back({{axis.name, value}});
  }
  return axis;
}

/// A setting that is drawn evenly between two legal values.
struct SampledSetting {
  std::string name;
  double low, high;
  bool is_whole;
};

SampledSetting sampled_setting_of(const std::string& name, const YamlNode& limits,
                                  const std::vector<StudyMethod>& methods) {
  const std::vector<YamlNode> ends = limits.list();
  const Setting setting = setting_values(name, limits, ends, methods).first;
  if (ends.size() != 2 || std::holds_alternative<std::string>(setting.value)) {
    limits.refuse(fmt::format("{} cannot be drawn", name), "a number's [LOWEST, HIGHEST]");
  }
  const double low = *parse_double(ends[0].text()), high = *parse_double(ends[1].text());
  if (low >= high) limits.refuse(fmt::format("{} cannot be drawn", name), "LOWEST below HIGHEST");
  return {name, low, high, std::holds_alternative<int>(setting.value)};
}

/// The n-th number of one setting's stream, with six digits.
SettingValue drawn(const SampledSetting& setting, std::uint64_t stream, std::uint64_t n) {
  const double part = uniform(random_word(stream, n));
  if (setting.is_whole) {
    return static_cast<int>(setting.low + std::floor(part * (setting.high - setting.low + 1)));
  }
  const std::string number =
      fmt::format("{:.6g}", setting.low + part * (setting.high - setting.low));
  // Digits that are cut must not lead out of what is legal.
  return std::clamp(std::stod(number), setting.low, setting.high);
}

/// Draws all settings at once, after Saltelli et al. 2010: per point a value with all of them, and
/// one for each setting with that one drawn anew. The same arguments give the same values on every
/// machine.
StudyAxis sampled_axis(const std::vector<SampledSetting>& settings, std::size_t points,
                       std::uint64_t seed) {
  StudyAxis axis;
  axis.name = "sample";
  for (const SampledSetting& setting : settings) axis.sampled.push_back(setting.name);
  for (std::size_t point = 0; point < points; ++point) {
    std::vector<SettingChange> all;
    for (std::size_t i = 0; i < settings.size(); ++i) {
      all.push_back({settings[i].name, drawn(settings[i], random_word(seed, i), 2 * point)});
    }
    axis.values.push_back(std::to_string(point + 1));
    axis.changes.push_back(all);
    for (std::size_t i = 0; i < settings.size(); ++i) {
      axis.values.push_back(fmt::format("{} {}", point + 1, settings[i].name));
      axis.changes.push_back(all);
      axis.changes.back()[i].value = drawn(settings[i], random_word(seed, i), 2 * point + 1);
    }
  }
  return axis;
}

StudyAxis sample_of(const YamlNode& node, const std::vector<StudyMethod>& methods) {
  node.check_keys({"points", "seed", "settings"});
  std::vector<SampledSetting> settings;
  for (const auto& [name, limits] : node.at("settings").members()) {
    settings.push_back(sampled_setting_of(name, limits, methods));
  }
  if (settings.empty()) node.at("settings").refuse("is an empty map", "SETTING: [LOWEST, HIGHEST]");
  const std::size_t points = node.at("points").whole(3, 100'000);
  return sampled_axis(settings, points,
                      node.find("seed") ? node.at("seed").whole(0, UINT64_MAX) : 1);
}

/// All combinations of the settings' values; those of the last setting change first.
StudyAxis grid_of(const YamlNode& node, const std::vector<StudyMethod>& methods) {
  constexpr std::size_t kMostCombinations = 10'000;
  StudyAxis axis;
  axis.name = "grid";
  axis.is_grid = true;
  axis.changes.emplace_back();
  for (const auto& [name, list] : node.members()) {
    const auto values = setting_values(name, list, list.list(), methods).second;
    if (values.empty()) list.refuse("is an empty list", "values of the setting");
    std::vector<std::vector<SettingChange>> combined;
    for (const std::vector<SettingChange>& before : axis.changes) {
      for (const SettingValue& value : values) {
        combined.push_back(before);
        combined.back().push_back({name, value});
      }
    }
    if (combined.size() > kMostCombinations) {
      node.refuse(fmt::format("has {} combinations", combined.size()),
                  fmt::format("at most {}", kMostCombinations));
    }
    axis.changes = std::move(combined);
  }
  if (axis.changes.front().empty()) node.refuse("is an empty map", "SETTING: [VALUES]");
  for (const std::vector<SettingChange>& changes : axis.changes) {
    axis.values.push_back(to_words(changes));
  }
  return axis;
}

}  // namespace

SettingChange change_by(const std::string& setting, const YamlNode& value,
                        const MethodKind& method) {
  return value.located(
      [&] { return change_of(fmt::format("{}={}", setting, value.text()), method); });
}

std::vector<StudyAxis> axes_of(const YamlNode& root, const std::vector<StudyMethod>& methods) {
  std::vector<StudyAxis> axes;
  for (const YamlNode& kind : root.list("disturb")) axes.push_back(disturbance_of(kind));
  for (const YamlNode& one : root.list("vary")) axes.push_back(setting_of(one, methods));
  if (const auto grid = root.find("grid")) axes.push_back(grid_of(*grid, methods));
  if (const auto sample = root.find("sample")) axes.push_back(sample_of(*sample, methods));
  return axes;
}

}  // namespace mosbench
