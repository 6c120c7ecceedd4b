#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <mosbench/method.hpp>
#include <mosbench/odometry.hpp>
#include <span>

#include "datasets/layouts/layout.hpp"
#include "datasets/perturb/perturb_kinds.hpp"
#include "datasets/simulator/built_in_scenes.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/nearest_name.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/answer/text_table.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/list_json.hpp"
#include "eval/job/presets.hpp"
#include "eval/predictions/prediction_format.hpp"
#include "eval/protocols/protocol_list.hpp"

namespace mosbench {
namespace {

constexpr const char* kListFooter = R"(Examples:
  mosbench list
  mosbench list methods
  mosbench list methods dynablox
  mosbench list odometry
  mosbench list presets
  mosbench list datasets
  mosbench list perturbations
  mosbench list methods --json)";

std::string datasets_text() {
  std::string text;
  for (const Layout* row : layouts()) {
    text += fmt::format("{} ({})\n", row->name, row->title);
    for (const auto& [what, value] :
         {std::pair{"content", row->content}, std::pair{"size", row->size},
          std::pair{"published", row->published}, std::pair{"licence", row->licence}}) {
      text += fmt::format("  {:<10}{}\n", what, value);
    }
    text += fmt::format("  {:<10}{}\n", "folders", row->folders.front());
    for (const std::string_view line : std::span(row->folders).subspan(1)) {
      text += fmt::format("  {:<10}{}\n", "", line);
    }
    for (const RelatedSet& set : row->related) {
      text += fmt::format("  {:<10}{}: {}\n  {:<10}  {}; {}\n", "also", set.title, set.content, "",
                          set.published, set.reading);
    }
  }
  return text;
}

std::string presets_text() {
  TextTable table({{"preset", TextTable::kLeft},
                   {"data set", TextTable::kLeft},
                   {"voxel m"},
                   {"range m"},
                   {"delay"},
                   {"protocol", TextTable::kLeft},
                   {"from", TextTable::kLeft}});
  for (const Preset& preset : presets()) {
    if (!preset.kind) {
      table.add_row({std::string(preset.name), "any", "", "as the data set's", "", "",
                     fmt::format("{} by {}", preset.source, preset.method)});
      continue;
    }
    const auto value = [&](std::string_view setting) {
      return to_string(std::ranges::find(preset.values, setting, &PresetValue::setting)->value);
    };
    table.add_row({std::string(preset.name), std::string(to_string(*preset.kind)),
                   value(common_settings::kVoxelSize_m),
                   fmt::format("{} to {}", value(common_settings::kMinRange_m),
                               value(common_settings::kMaxRange_m)),
                   value(common_settings::kDelay_scans), std::string(preset.protocol),
                   std::string(preset.source)});
  }
  return table.str() +
         "All other settings keep the defaults that `mosbench list methods` shows. A preset of any "
         "data "
         "set takes what\nis left open from the data set's first one; of a method, it is run by no "
         "other.\n";
}

std::string default_text(const Setting& setting) {
  return setting.is_set ? to_string(setting.value) : fmt::format("as {}", setting.follows);
}

std::string settings_text(const Settings& settings) {
  TextTable table({{"  setting", TextTable::kLeft},
                   {"default"},
                   {"unit", TextTable::kLeft},
                   {"legal", TextTable::kLeft},
                   {"meaning", TextTable::kLeft}});
  for (const Setting& setting : settings.all()) {
    table.add_row({fmt::format("  {}", setting.name), default_text(setting), unit_of(setting),
                   legal_values(setting), std::string(setting.meaning)});
  }
  return table.str();
}

std::string method_text(const MethodKind& method) {
  return fmt::format("{}: {}\n{}\n{}\n", method.name, method.summary, method.source,
                     settings_text(method.defaults));
}

std::string odometry_text() {
  std::string text;
  for (const OdometryKind& kind : odometries()) {
    text += fmt::format("{}: {}\n{}\n{}\n", kind.name, kind.summary, kind.source,
                        settings_text(kind.defaults));
  }
  TextTable table({{"preset", TextTable::kLeft},
                   {"odometry", TextTable::kLeft},
                   {"settings", TextTable::kLeft}});
  for (const OdometryPreset& preset : odometry_presets()) {
    std::vector<std::string> settings;
    for (const auto& [name, value] : preset.settings) {
      settings.push_back(fmt::format("{}={}", name, to_string(value)));
    }
    table.add_row({std::string(preset.name), std::string(preset.odometry),
                   fmt::format("{}", fmt::join(settings, ","))});
  }
  return text + table.str() + "Set by --odometry-preset and --odometry-set KEY=VALUE.\n";
}

std::string methods_text() {
  std::string text;
  for (const MethodKind& method : methods()) text += method_text(method);
  return text + "exec:COMMAND: a program of yours labels the scans, see `mosbench run --help`\n";
}

std::string protocols_text() {
  std::string text;
  for (const ProtocolDescription& protocol : describe_protocols()) {
    text += fmt::format("{}\n", protocol.name);
    for (const auto& [what, value] :
         {std::pair{"rule", &protocol.summary}, std::pair{"truth", &protocol.truth},
          std::pair{"moving", &protocol.prediction}, std::pair{"range", &protocol.range},
          std::pair{"average", &protocol.aggregation}, std::pair{"0/0", &protocol.empty_case},
          std::pair{"source", &protocol.source}}) {
      text += fmt::format("  {:<10}{}\n", what, *value);
    }
  }
  return text;
}

std::string scenes_text() {
  TextTable table({{"scene", TextTable::kLeft}, {"what", TextTable::kLeft}});
  for (const SceneSummary& scene : built_in_scenes()) {
    table.add_row({std::string(scene.name), std::string(scene.content)});
  }
  return table.str();
}

std::string formats_text() {
  TextTable table(
      {{"format", TextTable::kLeft}, {"files", TextTable::kLeft}, {"what", TextTable::kLeft}});
  for (const DescribedFormat& format : prediction_formats()) {
    table.add_row({std::string(format.name), format.per_scan ? "one per scan" : "one per sequence",
                   std::string(format.description)});
  }
  return table.str();
}

/// The strength that changes nothing.
std::string none_text(const PerturbKind& kind) {
  return std::isnan(kind.none) ? "beams_of" : fmt::format("{:g}", kind.none);
}

std::string perturbations_text() {
  TextTable table({{"kind", TextTable::kLeft},
                   {"unit", TextTable::kLeft},
                   {"none"},
                   {"from"},
                   {"to"},
                   {"what", TextTable::kLeft}});
  for (const PerturbKind& kind : perturb_kinds()) {
    table.add_row({std::string(kind.name), std::string(kind.unit), none_text(kind),
                   fmt::format("{:g}", kind.lowest), fmt::format("{:g}", kind.highest),
                   fmt::format("{} [{}]", kind.definition, kind.source)});
  }
  std::string text = table.str() + "Keys that kinds share:\n";
  for (const PerturbKey& key : perturb_keys()) {
    text += fmt::format("  {:<17}{}\n", key.name, key.definition);
  }
  return text;
}

/// One of the things that can be listed.
struct ListKind {
  std::string_view name, title;
  std::string (*text)();
  nlohmann::ordered_json (*json)();
};

constexpr ListKind kKinds[] = {
    {"datasets", "Data sets", datasets_text, datasets_json},
    {"methods", "Methods", methods_text, methods_json},
    {"odometry", "Odometry", odometry_text, odometry_json},
    {"presets", "Presets", presets_text, presets_json},
    {"protocols", "Protocols", protocols_text, protocols_json},
    {"scenes", "Scenes", scenes_text, scenes_json},
    {"formats", "Formats of predictions", formats_text, formats_json},
    {"perturbations", "Disturbances for --perturb", perturbations_text, perturbations_json},
};
constexpr std::string_view kAll = "all";

std::string list(std::string_view what) {
  std::vector<std::string> parts;
  for (const ListKind& kind : kKinds) {
    if (what == kind.name) return kind.text();
    if (what == kAll) parts.push_back(fmt::format("{}\n\n{}", kind.title, kind.text()));
  }
  return fmt::format("{}", fmt::join(parts, "\n"));
}

nlohmann::ordered_json list_json(std::string_view what) {
  nlohmann::ordered_json json;
  for (const ListKind& kind : kKinds) {
    if (what == kind.name || what == kAll) json[std::string(kind.name)] = kind.json();
  }
  return json;
}

const MethodKind& method_named_by_user(const std::string& name) {
  const MethodKind* method = find_method(name);
  if (method != nullptr) return *method;
  std::vector<std::string_view> names;
  for (const MethodKind& kind : methods()) names.push_back(kind.name);
  throw UsageError(fmt::format("{}: is no method, expected one of {} (nearest: {})", name,
                               fmt::join(names, ", "), nearest_name(name, names)));
}

}  // namespace

CommandRun add_list(CLI::App& command) {
  struct Listed {
    std::string what = "all", name;
    bool json = false;
  };
  auto listed = std::make_shared<Listed>();
  std::vector<std::string> names = {std::string(kAll)};
  for (const ListKind& kind : kKinds) names.emplace_back(kind.name);
  command
      .add_option("WHAT", listed->what,
                  "datasets, methods, odometry, presets, protocols, scenes, formats, perturbations "
                  "or all")
      ->capture_default_str()
      ->check(CLI::IsMember(names));
  command.add_option("NAME", listed->name, "One of the methods");
  command.add_flag("--json", listed->json, "Print JSON instead of text");
  command.footer(kListFooter);
  return [listed] {
    if (listed->name.empty()) {
      return Answer{listed->json ? json_text(list_json(listed->what)) : list(listed->what)};
    }
    if (listed->what != "methods") {
      throw UsageError(
          fmt::format("{}: is one argument too many, expected a name after methods", listed->name));
    }
    const MethodKind& method = method_named_by_user(listed->name);
    return Answer{listed->json ? json_text(method_json(method)) : method_text(method)};
  };
}

}  // namespace mosbench
