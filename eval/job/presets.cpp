#include "eval/job/presets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "datasets/layouts/layout.hpp"
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

/// Numbers of a data set are computed by its usual protocol with any of its presets.
Preset preset_of(std::string_view name, DatasetKind kind, std::vector<PresetValue> values,
                 std::string_view source) {
  return {name, kind, std::move(values), layout_of(kind).usual.protocol, source};
}

}  // namespace

std::span<const Preset> presets() {
  static const std::array kPresets = {
      preset_of("doals-20m", DatasetKind::kDoals, doals_settings(20.0),
                "paper, Table I, rows (20m)"),
      preset_of("doals-120m", DatasetKind::kDoals, doals_settings(120.0),
                "paper, Table I, full range"),
      preset_of("sipailou", DatasetKind::kSipailou, settings(0.25, 3.0, 50.0), "paper, Table II"),
      preset_of("helimos", DatasetKind::kHelimos, settings(0.25, 1.5, 50.0),
                "paper, Table III, online"),
      preset_of("helimos-delayed", DatasetKind::kHelimos, settings(0.25, 1.5, 50.0, 10),
                "paper, Table III, delayed by 10 scans"),
      preset_of("semantickitti", DatasetKind::kSemanticKitti, settings(0.25, 1.5, 50.0),
                "ours, the authors publish none: as helimos"),
      preset_of("apollo", DatasetKind::kApollo, settings(0.25, 0.5, 120.0),
                "authors' config of Apollo (2024)"),
      preset_of("moe", DatasetKind::kMoe, later_settings(0.20, 0.0, 120.0),
                "authors' config of MOE (2025)"),
      preset_of("kth", DatasetKind::kKth, settings(0.25, 1.5, 50.0),
                "ours, the authors publish none: as helimos"),
      preset_of("mdetector", DatasetKind::kMdetector, later_settings(0.20, 0.0, 120.0),
                "authors' config of M-detector's sets (2025)"),
      preset_of("opensceneflow", DatasetKind::kOpenSceneFlow, settings(0.25, 1.5, 50.0),
                "ours, the authors publish none: as helimos"),
      preset_of("nuscenes", DatasetKind::kNuscenes, settings(0.25, 1.5, 50.0),
                "ours, the authors publish none: as helimos"),
      preset_of("helipr", DatasetKind::kHelipr, settings(0.25, 1.5, 50.0),
                "ours, HeLiPR has no labels: as helimos"),
      preset_of("kitti-raw", DatasetKind::kKittiRaw, settings(0.25, 1.5, 50.0),
                "ours, the authors publish none: as helimos"),
      preset_of("kitti-tracking", DatasetKind::kKittiTracking, settings(0.25, 1.5, 50.0),
                "ours, the authors publish none: as helimos"),
      preset_of("recording", DatasetKind::kRecording, settings(0.25, 1.5, 50.0),
                "ours, for recordings of any sensor: as helimos"),
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
  return preset_named(layout_of(kind).usual.preset);
}

}  // namespace mosbench
