#include "eval/job/presets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "datasets/text/errors.hpp"
#include "datasets/text/nearest_name.hpp"

namespace mosbench {
namespace {

std::vector<PresetValue> settings(double voxel_size_m, double min_range_m, double max_range_m,
                                  int delay_scans = 0) {
  return {{"voxel_size_m", voxel_size_m},
          {"min_range_m", min_range_m},
          {"max_range_m", max_range_m},
          {"delay_scans", delay_scans}};
}

/// The same for DOALS, whose sensor Dynablox's authors describe so (their default.yaml).
std::vector<PresetValue> doals_settings(double max_range_m) {
  std::vector<PresetValue> values = settings(0.20, 0.5, max_range_m);
  values.push_back({"range_image_rows", 64});
  values.push_back({"range_image_columns", 2048});
  values.push_back({"field_of_view_down_deg", -33.22222 / 2});
  values.push_back({"field_of_view_up_deg", 33.22222 / 2});
  return values;
}

/// The same for the authors' later program, with which they measured these data sets.
std::vector<PresetValue> later_settings(double voxel_size_m, double min_range_m,
                                        double max_range_m) {
  std::vector<PresetValue> values = settings(voxel_size_m, min_range_m, max_range_m);
  values.push_back({"variant", "release-2025"});
  values.push_back({"local_window_scans", 5});
  return values;
}

}  // namespace

std::span<const Preset> presets() {
  // The first preset of a kind is its default.
  static const std::array kPresets = {
      Preset{"doals-20m", DatasetKind::kDoals, doals_settings(20.0), "doals-hmm",
             "paper, Table I, rows (20m)"},
      Preset{"doals-120m", DatasetKind::kDoals, doals_settings(120.0), "doals-hmm",
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
      Preset{"moe", DatasetKind::kMoe, later_settings(0.20, 0.0, 120.0), "moe",
             "authors' config of MOE (2025)"},
      Preset{"kth", DatasetKind::kKth, settings(0.25, 1.5, 50.0), "semantickitti-mos",
             "ours, the authors publish none: as helimos"},
      Preset{"mdetector", DatasetKind::kMdetector, later_settings(0.20, 0.0, 120.0), "mdetector",
             "authors' config of M-detector's sets (2025)"},
      Preset{"opensceneflow", DatasetKind::kOpenSceneFlow, settings(0.25, 1.5, 50.0),
             "sceneflow-dynamic", "ours, the authors publish none: as helimos"},
      Preset{"nuscenes", DatasetKind::kNuscenes, settings(0.25, 1.5, 50.0), "mapmos-nuscenes",
             "ours, the authors publish none: as helimos"},
      Preset{"helipr", DatasetKind::kHelipr, settings(0.25, 1.5, 50.0), "semantickitti-mos",
             "ours, HeLiPR has no labels: as helimos"},
      Preset{"kitti-raw", DatasetKind::kKittiRaw, settings(0.25, 1.5, 50.0), "semantickitti-mos",
             "ours, the authors publish none: as helimos"},
      Preset{"kitti-tracking", DatasetKind::kKittiTracking, settings(0.25, 1.5, 50.0),
             "semantickitti-mos", "ours, the authors publish none: as helimos"},
      Preset{"recording", DatasetKind::kRecording, settings(0.25, 1.5, 50.0), "semantickitti-mos",
             "ours, for recordings of any sensor: as helimos"},
      Preset{"best", std::nullopt, {}, "", "ours, docs/history/plus/README.md", "hmm-mos-plus"},
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
  Preset complete = default_preset(kind);
  complete.name = preset.name;
  complete.source = preset.source;
  complete.method = preset.method;
  return complete;
}

const Preset& default_preset(DatasetKind kind) {
  return *std::ranges::find(presets(), std::optional(kind), &Preset::kind);
}

}  // namespace mosbench
