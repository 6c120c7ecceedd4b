#include "eval/study/study_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>

#include "datasets/disk/files.hpp"
#include "datasets/simulator/simulate.hpp"
#include "datasets/simulator/simulated_layouts.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/engine/odometry_choice.hpp"
#include "eval/engine/run_plan.hpp"
#include "eval/job/method_choice.hpp"
#include "eval/job/presets.hpp"
#include "eval/result/reading_json.hpp"
#include "eval/result/settings_json.hpp"
#include "eval/study/study_sampling.hpp"
#include "eval/study/yaml_node.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

/// Names stand in tables and in files.
std::string name_of(const YamlNode& node) {
  const std::string name = node.text();
  const bool plain = std::ranges::all_of(name, [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
           std::string_view(" ._+-").find(c) != std::string_view::npos;
  });
  const bool blank = name.find_first_not_of(' ') == std::string::npos;
  if (!plain || blank || name.size() > 60) {
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
  StudySimulation simulation;
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
    one.simulation = simulation;
    one.dataset = to_string(simulation.layout);  // a folder's name does not say which
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
    data.front().path = path_of(path, file);
    if (!is_there(data.front().path)) {
      path.refuse(fmt::format("{} is not there", data.front().path.string()), "a folder or file");
    }
  }
  for (StudyData& one : data) {
    if (const auto dataset = node.find("dataset")) {
      one.dataset = dataset->text();
      dataset->located([&] { return dataset_kind_option(one.dataset).has_value(); });
    }
    if (const auto sequences = node.find("sequences")) {
      for (const YamlNode& sequence : sequences->list()) one.sequences.push_back(sequence.text());
    }
    if (const auto reading = node.find("reading")) one.reading = reading_of_study(*reading, file);
  }
  return data;
}

StudyMethod plain_method(const std::string& name) {
  StudyMethod method;
  method.name = method.method = name;
  return method;
}

/// A method by its name, or "all" of them.
std::vector<StudyMethod> plain_methods(const YamlNode& node) {
  std::vector<StudyMethod> methods;
  if (node.text() == "all") {
    for (const std::string& name : chosen_methods("all").names)
      methods.push_back(plain_method(name));
  } else {
    node.located([&] { return &method_named(node.text()); });
    methods.push_back(plain_method(node.text()));
  }
  return methods;
}

StudyMethod method_of(const YamlNode& node) {
  StudyMethod method;
  node.check_keys({"name", "method", "preset", "set"});
  method.method = node.at("method").text();
  const MethodKind* kind = node.at("method").located([&] { return &method_named(method.method); });
  method.name = node.find("name") ? name_of(node.at("name")) : method.method;
  if (const auto preset = node.find("preset")) {
    method.preset = preset->text();
    preset->located([&] { return &preset_named(*method.preset); });
  }
  if (const auto set = node.find("set")) {
    Settings settings = kind->defaults;
    for (const auto& [key, value] : set->members()) {
      method.assignments.push_back(fmt::format("{}={}", key, value.text()));
      value.located([&] { apply_setting_assignment(method.assignments.back(), settings); });
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

/// Checks a setting and its values by all methods that have it, and returns what one of them says
/// of it. `place` is where its name stands.
Setting checked_setting(const std::string& name, const YamlNode& place,
                        const std::vector<YamlNode>& values,
                        const std::vector<StudyMethod>& methods) {
  std::optional<Setting> known;
  for (const StudyMethod& method : methods) {
    Settings settings = method_named(method.method).defaults;
    if (settings.find(name) == nullptr) continue;
    known = *settings.find(name);
    for (const YamlNode& value : values) {
      value.located(
          [&] { apply_setting_assignment(fmt::format("{}={}", name, value.text()), settings); });
    }
  }
  if (known) return *known;
  place.refuse(fmt::format("no method has a setting {}", mosbench::quoted(name)),
               "one of `mosbench list methods`");
}

StudyAxis setting_of(const YamlNode& node, const std::vector<StudyMethod>& methods) {
  node.check_keys({"setting", "values"});
  StudyAxis axis;
  axis.name = node.at("setting").text();
  const std::vector<YamlNode> values = node.at("values").list();
  checked_setting(axis.name, node.at("setting"), values, methods);
  for (const YamlNode& value : values) {
    axis.values.push_back(value.text());
    axis.assignments.push_back({{axis.name, value.text()}});
  }
  return axis;
}

SampledSetting sampled_setting_of(const std::string& name, const YamlNode& limits,
                                  const std::vector<StudyMethod>& methods) {
  const std::vector<YamlNode> ends = limits.list();
  const Setting setting = checked_setting(name, limits, ends, methods);
  if (ends.size() != 2 || std::holds_alternative<std::string>(setting.value)) {
    limits.refuse(fmt::format("{} cannot be drawn", name), "a number's [LOWEST, HIGHEST]");
  }
  const double low = *parse_double(ends[0].text()), high = *parse_double(ends[1].text());
  if (low >= high) limits.refuse(fmt::format("{} cannot be drawn", name), "LOWEST below HIGHEST");
  return {name, low, high, std::holds_alternative<int>(setting.value)};
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

std::string range_of(const YamlNode& node, const std::optional<std::string>& protocol) {
  const std::vector<YamlNode> limits = node.list();
  if (limits.size() != 2 || !protocol) {
    node.refuse("range_m is not understood", "[MIN, MAX] together with a protocol");
  }
  const std::string range = fmt::format("{},{}", limits[0].text(), limits[1].text());
  node.located([&] { return range_option(range, protocol_named(*protocol)).min_m; });
  return range;
}

void read_rest(const YamlNode& root, Study& study) {
  if (const auto protocol = root.find("protocol")) {
    study.protocol = protocol->text();
    protocol->located([&] { return &protocol_named(*study.protocol); });
  }
  if (const auto range = root.find("range_m")) study.range = range_of(*range, study.protocol);
  if (const auto odometry = root.find("odometry")) {
    study.odometries.clear();
    for (const YamlNode& kind : odometry->list()) {
      study.odometries.push_back(kind.text() == "none" ? "" : kind.text());
      OdometryOptions options;
      if (!study.odometries.back().empty()) options.kind = study.odometries.back();
      kind.located([&] { return choose_odometry(options, {}).kind; });
    }
  }
  if (const auto disturb = root.find("disturb")) {
    for (const YamlNode& kind : disturb->list()) study.axes.push_back(disturbance_of(kind));
  }
  if (const auto vary = root.find("vary")) {
    for (const YamlNode& one : vary->list()) {
      study.axes.push_back(setting_of(one, study.methods));
    }
  }
  if (const auto sample = root.find("sample")) {
    study.axes.push_back(sample_of(*sample, study.methods));
  }
  check_names(root, study.axes);
  if (const auto seeds = root.find("seeds")) {
    study.seeds.clear();
    for (const YamlNode& seed : seeds->list()) study.seeds.push_back(seed.whole(0, UINT64_MAX));
  }
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
    const auto methods = node.is_map() ? std::vector{method_of(node)} : plain_methods(node);
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
