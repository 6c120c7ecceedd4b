#include "eval/cli/list_json.hpp"

#include <algorithm>
#include <iterator>
#include <mosbench/odometry.hpp>

#include "datasets/layouts/layout.hpp"
#include "datasets/perturb/perturb_kinds.hpp"
#include "datasets/simulator/built_in_scenes.hpp"
#include "eval/job/method_choice.hpp"
#include "eval/predictions/predictions.hpp"
#include "eval/protocols/protocol.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

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

ordered_json preset_json(const Preset& preset) {
  ordered_json settings = ordered_json::object();
  for (const PresetValue& value : preset.values) {
    settings[std::string(value.setting)] = value_json(value.value);
  }
  return {{"name", preset.name},
          {"dataset", preset.kind ? ordered_json(to_string(*preset.kind)) : nullptr},
          {"method", preset.method.empty() ? nullptr : ordered_json(preset.method)},
          {"protocol", preset.kind ? ordered_json(preset.protocol) : nullptr},
          {"settings", settings},
          {"source", preset.source}};
}

ordered_json odometry_kind_json(const OdometryKind& kind) {
  return {{"name", kind.name},
          {"title", kind.title},
          {"summary", kind.summary},
          {"source", kind.source},
          {"settings", rows_json(kind.defaults.all(), setting_json)}};
}

ordered_json odometry_preset_json(const OdometryPreset& preset) {
  ordered_json settings = ordered_json::object();
  for (const auto& [name, value] : preset.settings) settings[std::string(name)] = value_json(value);
  return {{"name", preset.name}, {"odometry", preset.odometry}, {"settings", settings}};
}

ordered_json protocol_json(const ProtocolDescription& protocol) {
  return {{"name", protocol.name},    {"rule", protocol.summary},
          {"truth", protocol.truth},  {"moving", protocol.prediction},
          {"range", protocol.range},  {"average", protocol.aggregation},
          {"split", protocol.split},  {"zero_by_zero", protocol.empty_case},
          {"source", protocol.source}};
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

}  // namespace

std::string unit_of(const Setting& setting) {
  const std::string_view last = setting.name.substr(setting.name.rfind('_') + 1);
  constexpr std::string_view kUnits[] = {"m",     "s",      "rad",    "deg",
                                         "scans", "voxels", "points", "ranges"};
  return std::ranges::find(kUnits, last) != std::end(kUnits) ? std::string(last) : "";
}

ordered_json method_json(const MethodKind& method) {
  return {{"name", method.name},
          {"title", method.title},
          {"summary", method.summary},
          {"source", method.source},
          {"settings", rows_json(method.defaults.all(), setting_json)}};
}

ordered_json datasets_json() { return rows_json(layouts(), dataset_json); }
ordered_json methods_json() { return rows_json(methods(), method_json); }
ordered_json odometry_json() {
  return {{"kinds", rows_json(odometries(), odometry_kind_json)},
          {"presets", rows_json(odometry_presets(), odometry_preset_json)}};
}
ordered_json presets_json() { return rows_json(presets(), preset_json); }
ordered_json protocols_json() { return rows_json(describe_protocols(), protocol_json); }
ordered_json scenes_json() { return rows_json(built_in_scenes(), scene_json); }
ordered_json formats_json() { return rows_json(prediction_formats(), format_json); }
ordered_json perturbations_json() { return rows_json(perturb_kinds(), perturbation_json); }

}  // namespace mosbench
