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
#include "datasets/text/text.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/list_json.hpp"
#include "eval/job/method_choice.hpp"
#include "eval/predictions/predictions.hpp"
#include "eval/protocols/protocol.hpp"

namespace mosbench {
namespace {

/// "  what      value", below the name of a thing.
std::string line_of(std::string_view what, std::string_view value) {
  return fmt::format("  {:<10}{}", what, value);
}

std::vector<Sheet> datasets_sheets() {
  Sheet sheet;
  for (const Layout* row : layouts()) {
    std::vector<std::string>& lines = sheet.lead;
    lines.push_back(fmt::format("{} ({})", row->name, row->title));
    for (const auto& [what, value] :
         {std::pair{"content", row->content}, std::pair{"size", row->size},
          std::pair{"published", row->published}, std::pair{"licence", row->licence}}) {
      lines.push_back(line_of(what, value));
    }
    for (const std::string_view folder : row->folders) {
      lines.push_back(line_of(folder == row->folders.front() ? "folders" : "", folder));
    }
    for (const RelatedSet& set : row->related) {
      lines.push_back(line_of("also", fmt::format("{}: {}", set.title, set.content)));
      lines.push_back(line_of("", fmt::format("  {}; {}", set.published, set.reading)));
    }
  }
  return {sheet};
}

std::vector<Sheet> presets_sheets() {
  Sheet sheet{.columns = {{"preset", Unit::kText},
                          {"data set", Unit::kText},
                          {"voxel m"},
                          {"range m"},
                          {"delay"},
                          {"protocol", Unit::kText},
                          {"from", Unit::kText}},
              .notes = {"All other settings keep the defaults that `mosbench list methods` shows. "
                        "A preset of any data set takes what",
                        "is left open from the data set's first one; of a method, it is run by no "
                        "other."}};
  for (const Preset& preset : presets()) {
    if (!preset.kind) {
      sheet.rows.push_back({std::string(preset.name), "any", "", "as the data set's", "", "",
                            fmt::format("{} by {}", preset.source, preset.method)});
      continue;
    }
    const auto value = [&](std::string_view setting) {
      return to_string(std::ranges::find(preset.values, setting, &PresetValue::setting)->value);
    };
    sheet.rows.push_back({std::string(preset.name), std::string(to_string(*preset.kind)),
                          value(common_settings::kVoxelSize_m),
                          fmt::format("{} to {}", value(common_settings::kMinRange_m),
                                      value(common_settings::kMaxRange_m)),
                          value(common_settings::kDelay_scans), std::string(preset.protocol),
                          std::string(preset.source)});
  }
  return {sheet};
}

std::string default_text(const Setting& setting) {
  return setting.is_set ? to_string(setting.value) : fmt::format("as {}", setting.follows);
}

/// A method or an odometry with its settings.
template <typename Kind>
Sheet settings_sheet(const Kind& kind) {
  Sheet sheet{.lead = {fmt::format("{}: {}", kind.name, kind.summary), std::string(kind.source)},
              .columns = {{"  setting", Unit::kText},
                          {"default"},
                          {"unit", Unit::kText},
                          {"legal", Unit::kText},
                          {"meaning", Unit::kText}}};
  for (const Setting& setting : kind.defaults.all()) {
    sheet.rows.push_back({fmt::format("  {}", setting.name), default_text(setting),
                          unit_of(setting), legal_values(setting), std::string(setting.meaning)});
  }
  return sheet;
}

std::vector<Sheet> odometry_sheets() {
  std::vector<Sheet> sheets;
  for (const OdometryKind& kind : odometries()) sheets.push_back(settings_sheet(kind));
  Sheet& sheet = sheets.emplace_back();
  sheet.columns = {{"preset", Unit::kText}, {"odometry", Unit::kText}, {"settings", Unit::kText}};
  sheet.notes = {"Set by --odometry KIND:PRESET,KEY=VALUE."};
  for (const OdometryPreset& preset : odometry_presets()) {
    std::vector<std::string> settings;
    for (const auto& [name, value] : preset.settings) {
      settings.push_back(fmt::format("{}={}", name, to_string(value)));
    }
    sheet.rows.push_back({std::string(preset.name), std::string(preset.odometry),
                          fmt::format("{}", fmt::join(settings, ","))});
  }
  return sheets;
}

std::vector<Sheet> methods_sheets() {
  std::vector<Sheet> sheets;
  for (const MethodKind& method : methods()) sheets.push_back(settings_sheet(method));
  sheets.push_back(
      {.lead = {"exec:COMMAND: a program of yours labels the scans, see `mosbench run --help`"}});
  return sheets;
}

std::vector<Sheet> protocols_sheets() {
  Sheet sheet;
  for (const ProtocolDescription& protocol : describe_protocols()) {
    sheet.lead.emplace_back(protocol.name);
    for (const auto& [what, value] :
         {std::pair{"rule", &protocol.summary}, std::pair{"truth", &protocol.truth},
          std::pair{"moving", &protocol.prediction}, std::pair{"range", &protocol.range},
          std::pair{"average", &protocol.aggregation}, std::pair{"0/0", &protocol.empty_case},
          std::pair{"source", &protocol.source}}) {
      sheet.lead.push_back(line_of(what, *value));
    }
  }
  return {sheet};
}

std::vector<Sheet> scenes_sheets() {
  Sheet sheet{.columns = {{"scene", Unit::kText}, {"what", Unit::kText}}};
  for (const SceneSummary& scene : built_in_scenes()) {
    sheet.rows.push_back({std::string(scene.name), std::string(scene.content)});
  }
  return {sheet};
}

std::vector<Sheet> formats_sheets() {
  Sheet sheet{.columns = {{"format", Unit::kText}, {"files", Unit::kText}, {"what", Unit::kText}}};
  for (const DescribedFormat& format : prediction_formats()) {
    sheet.rows.push_back({std::string(format.name),
                          format.per_scan ? "one per scan" : "one per sequence",
                          std::string(format.description)});
  }
  return {sheet};
}

/// The strength that changes nothing.
std::string none_text(const PerturbKind& kind) {
  return std::isnan(kind.none) ? "beams_of" : fmt::format("{:g}", kind.none);
}

std::vector<Sheet> perturbations_sheets() {
  Sheet sheet{.columns = {{"kind", Unit::kText},
                          {"unit", Unit::kText},
                          {"none"},
                          {"from"},
                          {"to"},
                          {"what", Unit::kText}},
              .notes = {"Keys that kinds share:"}};
  for (const PerturbKind& kind : perturb_kinds()) {
    sheet.rows.push_back({std::string(kind.name), std::string(kind.unit), none_text(kind),
                          kind.lowest, kind.highest,
                          fmt::format("{} [{}]", kind.definition, kind.source)});
  }
  for (const PerturbKey& key : perturb_keys()) {
    sheet.notes.push_back(fmt::format("  {:<17}{}", key.name, key.definition));
  }
  return {sheet};
}

/// One of the things that can be listed.
struct ListKind {
  std::string_view name, title;
  std::vector<Sheet> (*sheets)();
  nlohmann::ordered_json (*json)();
};

constexpr ListKind kKinds[] = {
    {"datasets", "Data sets", datasets_sheets, datasets_json},
    {"methods", "Methods", methods_sheets, methods_json},
    {"odometry", "Odometry", odometry_sheets, odometry_json},
    {"presets", "Presets", presets_sheets, presets_json},
    {"protocols", "Protocols", protocols_sheets, protocols_json},
    {"scenes", "Scenes", scenes_sheets, scenes_json},
    {"formats", "Formats of predictions", formats_sheets, formats_json},
    {"perturbations", "Disturbances for --perturb", perturbations_sheets, perturbations_json},
};
constexpr std::string_view kAll = "all";

std::vector<Sheet> list_sheets(std::string_view what) {
  std::vector<Sheet> all;
  for (const ListKind& kind : kKinds) {
    if (what != kind.name && what != kAll) continue;
    if (what == kAll) all.push_back({.title = std::string(kind.title)});
    const std::vector<Sheet> sheets = kind.sheets();
    all.insert(all.end(), sheets.begin(), sheets.end());
  }
  return all;
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
  return [listed] {
    if (listed->name.empty()) {
      return Answer{.sheets = list_sheets(listed->what),
                    .json = json_text(list_json(listed->what))};
    }
    if (listed->what != "methods") {
      throw UsageError(
          fmt::format("{}: is one argument too many, expected a name after methods", listed->name));
    }
    const MethodKind& method = method_named_by_user(listed->name);
    return Answer{.sheets = {settings_sheet(method)}, .json = json_text(method_json(method))};
  };
}

}  // namespace mosbench
