#include "eval/job/study_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>

#include "datasets/disk/files.hpp"
#include "datasets/simulator/simulate.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/job/method_choice.hpp"
#include "eval/job/study_axes.hpp"
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
    const bool is_path = key == "poses" && value.text() != kStaticPoses;
    const std::string text = is_path ? path_of(value, file).string() : value.text();
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
    std::vector<std::string> assignments;
    for (const auto& [key, value] : set->members()) assignments.push_back(key + "=" + value.text());
    segment.method = &taking(*segment.method, assignments);
    for (const auto& [key, value] : set->members()) {
      segment.changes.push_back(change_by(key, value, *segment.method));
    }
  }
  return method;
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

std::optional<OdometryChoice> odometry_of(const YamlNode& kind) {
  if (kind.text() == "none") return std::nullopt;
  return kind.located([&] { return choose_odometry({.kind = kind.text()}, {}); });
}

Metric tuned_metric(const YamlNode& node) {
  std::vector<std::string_view> names;
  for (const Metric metric : kBriefMetrics) {
    names.push_back(row_of(metric).key);
    if (names.back() == node.text()) return metric;
  }
  node.refuse(fmt::format("metric {} is not known", mosbench::quoted(node.text())),
              fmt::format("one of {}", fmt::join(names, ", ")));
}

std::vector<std::string> names_at(const YamlNode& node, const char* key) {
  std::vector<std::string> names;
  for (const YamlNode& name : node.at(key).list()) names.push_back(name.text());
  if (names.empty()) node.at(key).refuse("is an empty list", "names of sequences or data");
  return names;
}

StudyTuning tuning_of(const YamlNode& node, const YamlNode& root) {
  node.check_keys({"metric", "tune_on", "judge_on"});
  if (!root.find("grid")) {
    node.refuse("best_of chooses among nothing", "the key grid, with settings and their values");
  }
  return {tuned_metric(node.at("metric")), names_at(node, "tune_on"), names_at(node, "judge_on")};
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
  study.axes = axes_of(root, study.methods);
  if (const auto best_of = root.find("best_of")) study.tuning = tuning_of(*best_of, root);
  check_names(root, study.axes);
  if (root.find("seeds")) study.seeds.clear();
  for (const YamlNode& seed : root.list("seeds")) study.seeds.push_back(seed.whole(0, UINT64_MAX));
}

}  // namespace

Study parse_study(const std::string& text, const fs::path& file) {
  const YamlNode root = parse_yaml(text, file);
  root.check_keys({"name", "protocol", "range_m", "data", "methods", "odometry", "disturb", "vary",
                   "grid", "best_of", "sample", "seeds"});
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
