#include "eval/job/presets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "datasets/layouts/layout.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/nearest_name.hpp"

namespace mosbench {
namespace {

/// Presets that are of a data set, but not its usual one.
constexpr std::pair<std::string_view, DatasetKind> kOthers[] = {
    {"doals-120m", DatasetKind::kDoals}, {"helimos-delayed", DatasetKind::kHelimos}};

/// The data set that a preset is of; nothing: any.
std::optional<DatasetKind> kind_of(std::string_view preset) {
  for (const Layout* layout : layouts()) {
    if (layout->usual.preset == preset) return layout->kind;
  }
  for (const auto& [other, kind] : kOthers) {
    if (other == preset) return kind;
  }
  return std::nullopt;
}

/// Numbers of a data set are computed by its usual protocol with any of its presets.
std::vector<Preset> all_presets() {
  std::vector<Preset> presets;
  for (const MethodPreset& row : method_presets()) {
    const std::optional<DatasetKind> kind = kind_of(row.name);
    presets.push_back({row, kind, kind ? layout_of(*kind).usual.protocol : ""});
  }
  return presets;
}

}  // namespace

std::span<const Preset> presets() {
  static const std::vector<Preset> kPresets = all_presets();
  return kPresets;
}

const Preset& preset_named(std::string_view name) {
  const auto found = std::ranges::find(presets(), name, &Preset::name);
  if (found != presets().end()) return *found;
  std::vector<std::string_view> names;
  for (const Preset& preset : presets()) names.push_back(preset.name);
  throw UsageError(fmt::format("--preset: '{}' is not known, expected one of {} (nearest: {})",
                               name, fmt::join(names, ", "), nearest_name(name, names)));
}

Settings settings_of(const Preset& preset, const MethodKind& method) {
  Settings settings = method.defaults;
  for (const PresetValue& value : preset.values) {
    if (settings.find(value.setting) == nullptr) continue;
    try {
      settings.set(value.setting, value.value);
    } catch (const std::invalid_argument& error) {
      throw UsageError(fmt::format("--preset {}: does not suit method {}: {}", preset.name,
                                   method.name, error.what()));
    }
  }
  return settings;
}

Preset preset_for(const Preset& preset, DatasetKind kind) {
  if (preset.kind) return preset;
  const Preset& usual = default_preset(kind);
  return {{preset.name, usual.values, preset.source, preset.method}, usual.kind, usual.protocol};
}

const Preset& default_preset(DatasetKind kind) {
  return preset_named(layout_of(kind).usual.preset);
}

}  // namespace mosbench
