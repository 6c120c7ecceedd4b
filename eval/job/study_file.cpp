#include "eval/job/study_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>

#include "datasets/disk/files.hpp"
#include "datasets/sequence/portable_math.hpp"
#include "datasets/simulator/simulate.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/job/method_choice.hpp"
#include "eval/job/yaml_node.hpp"
#include "eval/result/reading_json.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

/// Names stand in tables and in files.
std::string name_of(const YamlNode& node) {
  const std::string name = node.text();
  constexpr std::string_view kLegal =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789 ._+-";
  if (name.find_first_not_of(kLegal) != std::string::npos ||
      name.find_first_not_of(' ') == std::string::npos || name.size() > 60) {
    node.refuse(fmt::format("{} is no name", mosbench::quoted(name)),
                "1 to 60 letters, digits, blanks and . _ + -");
  }
  return name;
}

/// From the study's folder; "~/" is the user's.
fs::path path_of(const YamlNode& node, const fs::path& file) {
  const std::string text = node.text();
  const char* home = std::getenv("HOME");
  if (text.starts_with("~/") && home != nullptr) return fs::path(home) / text.substr(2);
  return (fs::absolute(file).parent_path() / text).lexically_normal();
}

/// Disturbances stand in "disturb", and odometry finds poses by "odometry".
Reading reading_of_study(const YamlNode& node, const fs::path& file) {
  std::vector<std::string_view> names;
  for (const ReadingField& field : reading_fields()) {
    if (field.name != "perturb") names.push_back(field.name);
  }
  node.check_keys(names);
  Reading reading;
  for (const auto& [key, value] : node.members()) {
    const std::string text = key == "poses" ? path_of(value, file).string() : value.text();
    value.located([&, &name = key] { set_field(reading, name, text); });
  }
  return reading;
}

std::vector<StudyData> simulations_of(const std::string& name, const YamlNode& node,
                                      const fs::path& file) {
  node.check_keys({"layout", "scene", "scans", "seed"});
  Simulation simulation;
  const YamlNode layout = node.at("layout");
  const auto kind = simulated_layout_from_string(layout.text());
  if (!kind) {
    layout.refuse(fmt::format("layout {} is not known", mosbench::quoted(layout.text())),
                  simulated_layout_names());
  }
  simulation.layout = *kind;
  const YamlNode scene = node.at("scene");
  simulation.scene = scene.text().ends_with(".json") ? path_of(scene, file).string() : scene.text();
  scene.located([&] { return load_scene(simulation.scene).name; });
  simulation.scans = node.at("scans").whole(1, 1'000'000);
  std::vector<StudyData> data;
  const std::vector<YamlNode> seeds = node.at("seed").list();
  for (const YamlNode& seed : seeds) {
    simulation.seed = seed.whole(0, UINT64_MAX);
    StudyData& one = data.emplace_back();
    one.group = name;
    one.name = seeds.size() == 1 ? name : fmt::format("{}-{}", name, simulation.seed);
    one.data.simulation = simulation;
    one.data.kind = simulation.layout;  // a folder's name does not say which
  }
  return data;
}

std::vector<StudyData> data_of(const YamlNode& node, const fs::path& file) {
  node.check_keys({"name", "simulate", "path", "dataset", "sequences", "reading"});
  const std::string name = name_of(node.at("name"));
  std::vector<StudyData> data(1);
  if (const auto simulate = node.find("simulate")) {
    if (node.find("path") || node.find("dataset")) {
      node.refuse("says simulate and where data lie", "one of simulate and path");
    }
    data = simulations_of(name, *simulate, file);
  } else {
    data.front().name = data.front().group = name;
    const YamlNode path = node.at("path");
    fs::path& place = data.front().data.path;
    place = path_of(path, file);
    if (!is_there(place)) {
      path.refuse(fmt::format("{} is not there", place.string()), "a folder or file");
    }
  }
  for (StudyData& one : data) {
    if (const auto dataset = node.find("dataset")) {
      one.data.kind = dataset->located([&] { return dataset_kind_option(dataset->text()); });
    }
    for (const YamlNode& sequence : node.list("sequences")) {
      one.data.sequences.push_back(sequence.text());
    }
    if (const auto reading = node.find("reading")) {
      one.data.reading = reading_of_study(*reading, file);
    }
  }
  return data;
}

/// A method by its name, or "all" of them.
std::vector<StudyMethod> plain_methods(const YamlNode& node) {
  const auto named = [](const std::string& name) {
    return StudyMethod{name, {.method = &method_named(name)}};
  };
  if (node.text() != "all") return {node.located([&] { return named(node.text()); })};
  std::vector<StudyMethod> methods;
  for (const std::string& name : chosen_methods("all").names) methods.push_back(named(name));
  return methods;
}

SettingChange change_by(const std::string& setting, const YamlNode& value,
                        const MethodKind& method) {
  return value.located(
      [&] { return change_of(fmt::format("{}={}", setting, value.text()), method); });
}

StudyMethod described_method(const YamlNode& node) {
  node.check_keys({"name", "method", "preset", "set"});
  StudyMethod method;
  Segment& segment = method.segment;
  const YamlNode named = node.at("method");
  segment.method = named.located([&] { return &method_named(named.text()); });
  method.name = node.find("name") ? name_of(node.at("name")) : named.text();
  if (const auto preset = node.find("preset")) {
    segment.preset = preset->located([&] {
      method_of(named.text(), preset->text());
      return &preset_named(preset->text());
    });
  }
  if (const auto set = node.find("set")) {
    for (const auto& [key, value] : set->members()) {
      segment.changes.push_back(change_by(key, value, *segment.method));
    }
  }
  return method;
}

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

template <typename Named>
void check_names(const YamlNode& node, const std::vector<Named>& rows) {
  std::set<std::string> names;
  for (const Named& row : rows) {
    if (!names.insert(row.name).second) {
      node.refuse(fmt::format("name {} is given twice", mosbench::quoted(row.name)),
                  "names that differ");
    }
  }
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

std::optional<OdometryChoice> odometry_of(const YamlNode& kind) {
  if (kind.text() == "none") return std::nullopt;
  return kind.located([&] { return choose_odometry({.kind = kind.text()}, {}); });
}

void read_rest(const YamlNode& root, Study& study) {
  if (const auto protocol = root.find("protocol")) {
    study.rule.protocol = protocol->located([&] { return &protocol_named(protocol->text()); });
  }
  if (const auto range = root.find("range_m")) {
    const std::vector<YamlNode> limits = range->list();
    if (limits.size() != 2 || study.rule.protocol == nullptr) {
      range->refuse("range_m is not understood", "[MIN, MAX] together with a protocol");
    }
    const std::string text = fmt::format("{},{}", limits[0].text(), limits[1].text());
    study.rule.range = range->located([&] { return rule_of(*study.rule.protocol, text).range; });
  }
  if (root.find("odometry")) study.odometries.clear();
  for (const YamlNode& kind : root.list("odometry")) study.odometries.push_back(odometry_of(kind));
  for (const YamlNode& kind : root.list("disturb")) study.axes.push_back(disturbance_of(kind));
  for (const YamlNode& one : root.list("vary")) {
    study.axes.push_back(setting_of(one, study.methods));
  }
  if (const auto sample = root.find("sample")) {
    study.axes.push_back(sample_of(*sample, study.methods));
  }
  check_names(root, study.axes);
  if (root.find("seeds")) study.seeds.clear();
  for (const YamlNode& seed : root.list("seeds")) study.seeds.push_back(seed.whole(0, UINT64_MAX));
}

}  // namespace

Study parse_study(const std::string& text, const fs::path& file) {
  const YamlNode root = parse_yaml(text, file);
  root.check_keys({"name", "protocol", "range_m", "data", "methods", "odometry", "disturb", "vary",
                   "sample", "seeds"});
  Study study;
  study.file = file;
  study.name = name_of(root.at("name"));
  for (const YamlNode& node : root.at("data").list()) {
    for (StudyData& data : data_of(node, file)) study.data.push_back(std::move(data));
  }
  for (const YamlNode& node : root.at("methods").list()) {
    const auto methods = node.is_map() ? std::vector{described_method(node)} : plain_methods(node);
    study.methods.insert(study.methods.end(), methods.begin(), methods.end());
  }
  check_names(root.at("data"), study.data);
  check_names(root.at("methods"), study.methods);
  read_rest(root, study);
  return study;
}

Study read_study(const fs::path& file) {
  try {
    return parse_study(read_file(file), file);
  } catch (const DataError& error) {
    throw UsageError(error.what());
  }
}

}  // namespace mosbench
