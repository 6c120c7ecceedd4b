#include "eval/tables/list_print.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <mosbench/method.hpp>
#include <mosbench/odometry.hpp>

#include "datasets/layouts/layout.hpp"
#include "datasets/perturb/perturbation.hpp"
#include "datasets/simulator/scene.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/job/method_choice.hpp"
#include "eval/predictions/predictions.hpp"
#include "eval/protocols/protocol.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

/// Returns the unit with which the name of a setting ends; empty for numbers without one.
std::string unit_of(const Setting& setting) {
  const std::string_view last = setting.name.substr(setting.name.rfind('_') + 1);
  constexpr std::string_view kUnits[] = {"m",     "s",      "rad",    "deg",
                                         "scans", "voxels", "points", "ranges"};
  return std::ranges::find(kUnits, last) != std::end(kUnits) ? std::string(last) : "";
}

ordered_json value_json(const SettingValue& value) {
  return std::visit([](const auto& held) { return ordered_json(held); }, value);
}

ordered_json setting_json(const Setting& setting) {
  ordered_json json = {{"name", setting.name}};
  if (setting.is_set) {
    json["default"] = value_json(setting.value);
  } else {
    json["follows"] = setting.follows;
  }
  if (!setting.choices.empty()) {
    json["choices"] = setting.choices;
  } else {
    json["unit"] = unit_of(setting);
    json["lowest"] = setting.lowest;
    json["highest"] = setting.highest;
  }
  json["meaning"] = setting.meaning;
  return json;
}

template <typename Rows, typename ToJson>
ordered_json rows_json(const Rows& rows, ToJson&& row_json) {
  ordered_json json = ordered_json::array();
  std::ranges::transform(rows, std::back_inserter(json), row_json);
  return json;
}

ordered_json related_json(const RelatedSet& set) {
  return {{"title", set.title},
          {"content", set.content},
          {"published", set.published},
          {"reading", set.reading}};
}

ordered_json dataset_json(const Layout* row) {
  return {{"name", row->name},
          {"title", row->title},
          {"content", row->content},
          {"size", row->size},
          {"published", row->published},
          {"licence", row->licence},
          {"folders", row->folders},
          {"written", row->writer.has_value()},
          {"related", rows_json(row->related, related_json)}};
}

template <typename Values>
ordered_json values_json(const Values& values) {
  ordered_json json = ordered_json::object();
  for (const auto& [name, value] : values) json[std::string(name)] = value_json(value);
  return json;
}

ordered_json preset_json(const Preset& preset) {
  return {{"name", preset.name},
          {"dataset", preset.kind ? ordered_json(to_string(*preset.kind)) : nullptr},
          {"method", preset.method.empty() ? nullptr : ordered_json(preset.method)},
          {"protocol", preset.kind ? ordered_json(preset.protocol) : nullptr},
          {"settings", values_json(preset.values)},
          {"source", preset.source}};
}

/// A method or an odometry with its settings.
template <typename Kind>
ordered_json kind_json(const Kind& kind) {
  return {{"name", kind.name},
          {"title", kind.title},
          {"summary", kind.summary},
          {"source", kind.source},
          {"settings", rows_json(kind.defaults.all(), setting_json)}};
}

ordered_json odometry_preset_json(const OdometryPreset& preset) {
  return {{"name", preset.name},
          {"odometry", preset.odometry},
          {"settings", values_json(preset.settings)}};
}

ordered_json scene_json(const SceneSummary& scene) {
  return {{"name", scene.name}, {"content", scene.content}};
}

ordered_json format_json(const DescribedFormat& format) {
  return {{"name", format.name},
          {"extension", format.extension},
          {"per_scan", format.per_scan},
          {"description", format.description}};
}

ordered_json perturbation_json(const PerturbKind& kind) {
  return {{"name", kind.name},     {"unit", kind.unit},       {"none", kind.none},
          {"lowest", kind.lowest}, {"highest", kind.highest}, {"definition", kind.definition},
          {"source", kind.source}};
}

/// A member of a protocol; without a title it is not in the text.
struct ProtocolLine {
  const char *title, *key;
  std::string ProtocolDescription::*value;
};
constexpr ProtocolLine kProtocolLines[] = {
    {"rule", "rule", &ProtocolDescription::summary},
    {"truth", "truth", &ProtocolDescription::truth},
    {"moving", "moving", &ProtocolDescription::prediction},
    {"range", "range", &ProtocolDescription::range},
    {"average", "average", &ProtocolDescription::aggregation},
    {nullptr, "split", &ProtocolDescription::split},
    {"0/0", "zero_by_zero", &ProtocolDescription::empty_case},
    {"source", "source", &ProtocolDescription::source}};

ordered_json protocol_json(const ProtocolDescription& protocol) {
  ordered_json json = {{"name", protocol.name}};
  for (const ProtocolLine& line : kProtocolLines) json[line.key] = protocol.*line.value;
  return json;
}

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
    const auto value = [&](std::string_view setting) {
      const auto found = std::ranges::find(preset.values, setting, &PresetValue::setting);
      return found == preset.values.end() ? "" : to_string(found->value);
    };
    if (!preset.kind) {
      const std::string method = preset.method.empty() ? "" : fmt::format(" by {}", preset.method);
      sheet.rows.push_back({std::string(preset.name), "any", value(common_settings::kVoxelSize_m),
                            "as the data set's", "", "", std::string(preset.source) + method});
      continue;
    }
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
    for (const ProtocolLine& line : kProtocolLines) {
      if (line.title) sheet.lead.push_back(line_of(line.title, protocol.*line.value));
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
  ordered_json (*json)();
};

constexpr ListKind kKinds[] = {
    {"datasets", "Data sets", datasets_sheets, [] { return rows_json(layouts(), dataset_json); }},
    {"methods", "Methods", methods_sheets,
     [] { return rows_json(methods(), kind_json<MethodKind>); }},
    {"odometry", "Odometry", odometry_sheets,
     [] {
       return ordered_json{{"kinds", rows_json(odometries(), kind_json<OdometryKind>)},
                           {"presets", rows_json(odometry_presets(), odometry_preset_json)}};
     }},
    {"presets", "Presets", presets_sheets, [] { return rows_json(presets(), preset_json); }},
    {"protocols", "Protocols", protocols_sheets,
     [] { return rows_json(describe_protocols(), protocol_json); }},
    {"scenes", "Scenes", scenes_sheets, [] { return rows_json(built_in_scenes(), scene_json); }},
    {"formats", "Formats of predictions", formats_sheets,
     [] { return rows_json(prediction_formats(), format_json); }},
    {"perturbations", "Disturbances for --perturb", perturbations_sheets,
     [] { return rows_json(perturb_kinds(), perturbation_json); }},
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

ordered_json list_json(std::string_view what) {
  ordered_json json;
  for (const ListKind& kind : kKinds) {
    if (what == kind.name || what == kAll) json[std::string(kind.name)] = kind.json();
  }
  return json;
}

}  // namespace

std::vector<std::string> list_names() {
  std::vector<std::string> names = {std::string(kAll)};
  for (const ListKind& kind : kKinds) names.emplace_back(kind.name);
  return names;
}

Answer list_answer(const std::string& what, const std::string& name) {
  if (name.empty()) return {.sheets = list_sheets(what), .json = json_text(list_json(what))};
  if (what != "methods") {
    throw UsageError(
        fmt::format("{}: is one argument too many, expected a name after methods", name));
  }
  if (const MethodKind* method = find_method(name)) {
    return {.sheets = {settings_sheet(*method)}, .json = json_text(kind_json(*method))};
  }
  std::vector<std::string_view> names;
  for (const MethodKind& kind : methods()) names.push_back(kind.name);
  throw UsageError(fmt::format("{}: is no method, expected one of {} (nearest: {})", name,
                               fmt::join(names, ", "), nearest_name(name, names)));
}

}  // namespace mosbench
