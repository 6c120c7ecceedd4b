#include "eval/engine/window_remark.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <string_view>
#include <vector>

namespace mosbench {
namespace {

constexpr double kAssumed_s = 0.1;
constexpr double kMostOff = 0.2;  // a fraction: a sweep of 0.12 s is still called 10 Hz

/// Windows of two scans and more; a single scan is what a method looks at.
std::vector<std::string> windows_in_scans(const Settings& settings, double step_s) {
  std::vector<std::string> windows;
  for (const Setting& setting : settings.all()) {
    if (!setting.name.ends_with("_scans") || settings.number(setting.name) < 2) continue;
    const double scans = settings.number(setting.name);
    windows.push_back(fmt::format("{}={:g} lasts {:.3g} s", setting.name, scans, scans * step_s));
  }
  return windows;
}

std::vector<std::string_view> windows_in_seconds(const Settings& settings) {
  std::vector<std::string_view> windows;
  for (const Setting& setting : settings.all()) {
    const bool is_time = setting.name.ends_with("_s") && !setting.name.ends_with("_m_s");
    if (is_time && settings.number(setting.name) > 0) windows.push_back(setting.name);
  }
  return windows;
}

}  // namespace

std::string window_remark(const Settings& settings, std::optional<double> step_s) {
  const auto seconds = windows_in_seconds(settings);
  if (!step_s && seconds.empty()) return "";
  if (!step_s) {
    return fmt::format("scans have no stamps: {} {} counted as at 10 Hz", fmt::join(seconds, ", "),
                       seconds.size() == 1 ? "is" : "are");
  }
  if (std::abs(*step_s / kAssumed_s - 1) <= kMostOff) return "";
  std::vector<std::string> parts = windows_in_scans(settings, *step_s);
  if (!seconds.empty()) {
    parts.push_back(fmt::format("{} by the stamps", fmt::join(seconds, ", ")));
  }
  if (parts.empty()) return "";
  return fmt::format("scans come every {:.3g} s, not every 0.1 s: {}", *step_s,
                     fmt::join(parts, ", "));
}

}  // namespace mosbench
