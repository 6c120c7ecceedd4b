#include "eval/runs/presets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "datasets/files/errors.hpp"
#include "datasets/files/nearest_name.hpp"

namespace mosbench {
namespace {

std::vector<PresetValue> settings(double voxel_size_m, double min_range_m, double max_range_m,
                                  int delay_scans = 0) {
  return {{"voxel_size_m", voxel_size_m},
          {"min_range_m", min_range_m},
          {"max_range_m", max_range_m},
          {"delay_scans", delay_scans}};
}

}  // namespace

std::span<const Preset> presets() {
  // The first preset of a kind is its default.
  static const std::array kPresets = {
      Preset{"doals-20m", DatasetKind::kDoals, settings(0.20, 0.5, 20.0), "doals-hmm",
             "paper, Table I, rows (20m)"},
      Preset{"doals-120m", DatasetKind::kDoals, settings(0.20, 0.5, 120.0), "doals-hmm",
             "paper, Table I, full range"},
      Preset{"sipailou", DatasetKind::kSipailou, settings(0.25, 3.0, 50.0), "sipailou",
             "paper, Table II"},
      Preset{"helimos", DatasetKind::kHelimos, settings(0.25, 1.5, 50.0), "helimos-all",
             "paper, Table III, online"},
      Preset{"helimos-delayed", DatasetKind::kHelimos, settings(0.25, 1.5, 50.0, 10), "helimos-all",
             "paper, Table III, delayed by 10 scans"},
      Preset{"semantickitti", DatasetKind::kSemanticKitti, settings(0.25, 1.5, 50.0),
             "semantickitti-mos", "ours, the authors publish none: as helimos"},
      Preset{"apollo", DatasetKind::kApollo, settings(0.25, 0.5, 120.0), "semantickitti-mos",
             "authors' config of Apollo (2024)"},
      Preset{"moe", DatasetKind::kMoe, settings(0.20, 0.0, 120.0), "moe",
             "authors' config of MOE (2025)"},
      Preset{"kth", DatasetKind::kKth, settings(0.25, 1.5, 50.0), "semantickitti-mos",
             "ours, the authors publish none: as helimos"},
      Preset{"mdetector", DatasetKind::kMdetector, settings(0.20, 0.0, 120.0), "mdetector",
             "authors' config of M-detector's sets (2025)"},
  };
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
    if (settings.find(value.setting) != nullptr) settings.set(value.setting, value.value);
  }
  return settings;
}

const Preset& default_preset(DatasetKind kind) {
  return *std::ranges::find(presets(), kind, &Preset::kind);
}

}  // namespace mosbench
