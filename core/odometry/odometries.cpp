#include <algorithm>
#include <array>
#include <mosbench/odometry.hpp>
#include <stdexcept>

#include "core/odometry/config.hpp"
#include "core/odometry/scan_odometry.hpp"

namespace mosbench {
namespace {

using odometry::KissConfig;
using odometry::ScanOdometry;
using odometry::SimpleConfig;

template <typename Config>
OdometryKind kind_of(std::string_view name, std::string_view title, std::string_view source,
                     std::string_view summary) {
  return {.name = name,
          .title = title,
          .source = source,
          .summary = summary,
          .defaults = settings_of(Config{}),
          .check = [](const Settings& settings) { check(config_of<Config>(settings)); },
          .make = [](const Settings& settings, unsigned threads) -> std::unique_ptr<Odometry> {
            const auto config = checked(config_of<Config>(settings));
            if (threads == 0) throw std::invalid_argument("threads: 0, expected at least 1");
            return std::make_unique<ScanOdometry>(config, threads);
          }};
}

OdometryPreset simple_preset(std::string_view name, const SimpleConfig& config) {
  OdometryPreset preset{.name = name, .odometry = "simple", .settings = {}};
  const Settings settings = settings_of(config);
  for (const std::string_view key : {"sigma_m", "map_radius_m", "scan_radius_m", "tolerance",
                                     "min_range_m", "max_range_m", "kitti_correction"}) {
    preset.settings.emplace_back(key, settings.find(key)->value);
  }
  return preset;
}

SimpleConfig with_range(double min_range_m, double max_range_m) {
  SimpleConfig config;
  config.scan.min_range_m = min_range_m;
  config.scan.max_range_m = max_range_m;
  return config;
}

std::vector<OdometryPreset> authors_presets() {
  SimpleConfig offline = with_range(0, 120);
  offline.map_radius_m = 0.5;
  offline.scan_radius_m = 0.3;
  offline.tolerance = 1e-6;
  offline.scan.kitti_correction = odometry::Switch::kOn;
  SimpleConfig online = with_range(10, 80);
  online.scan.kitti_correction = odometry::Switch::kOn;
  SimpleConfig mulran = with_range(10, 120), urban = with_range(5, 120),
               vlp16 = with_range(10, 120);
  mulran.sigma_m = urban.sigma_m = 0.35;
  vlp16.sigma_m = 12.0;  // in the authors' saved files, too
  return {simple_preset("kitti-offline", offline), simple_preset("kitti-online", online),
          simple_preset("mulran", mulran),         simple_preset("urbannav", urban),
          simple_preset("uq-vlp16", vlp16),        simple_preset("uq-livox", with_range(0, 120))};
}

}  // namespace

std::span<const OdometryKind> odometries() {
  static const std::array<OdometryKind, 2> kinds = {
      kind_of<SimpleConfig>("simple", "SiMpLE",
                            "Bhandari, Phillips, McAree: Minimal configuration point cloud "
                            "odometry and mapping, IJRR 2024",
                            "points drawn to a thinned map by Gaussians, minimised by BFGS"),
      kind_of<KissConfig>("kiss", "KISS-ICP",
                          "Vizzo et al.: KISS-ICP, In Defense of Point-to-Point ICP, RA-L 2023",
                          "point-to-point ICP with an adaptive threshold")};
  return kinds;
}

const OdometryKind* find_odometry(std::string_view name) {
  const auto found = std::ranges::find(odometries(), name, &OdometryKind::name);
  return found == odometries().end() ? nullptr : &*found;
}

std::span<const OdometryPreset> odometry_presets() {
  static const std::vector<OdometryPreset> presets = authors_presets();
  return presets;
}

}  // namespace mosbench
