#pragma once

#include <cstddef>
#include <functional>
#include <mosbench/scan.hpp>
#include <optional>
#include <string>
#include <vector>

namespace mosbench {

/// Returns a sentence where scans of a topic look like the second before rather than like the one
/// before, each in its sensor's frame: two sensors, or two halves of a turn, publish in turn.
/// `points_of` reads a scan; at most 24 are read.
std::optional<std::string> doubt_about_turns(
    std::size_t scans, const std::function<std::vector<Point>(std::size_t)>& points_of);

}  // namespace mosbench
