#pragma once

#include <mosbench/settings.hpp>
#include <optional>
#include <string>

namespace mosbench {

/// Says how long windows last that a method counts in scans, where scans do not come at about 10
/// Hz; of windows in seconds, that they follow the stamps, or without stamps are counted as at 10
/// Hz. `step_s` is the usual time between scans. Empty where there is nothing to say.
std::string window_remark(const Settings& settings, std::optional<double> step_s);

}  // namespace mosbench
