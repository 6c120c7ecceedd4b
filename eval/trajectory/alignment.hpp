#pragma once

#include <cstdint>
#include <mosbench/scan.hpp>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace mosbench {

/// How an estimate is moved onto the truth before positions are compared.
enum class PathAlignment : std::uint8_t {
  kNone,
  kOrigin,     ///< its first pose onto the true first pose
  kRigid,      ///< least squares over positions (Umeyama, PAMI 1991)
  kSimilarity  ///< the same with a scale
};

std::string_view to_string(PathAlignment alignment);
std::optional<PathAlignment> path_alignment_from_string(std::string_view name);

struct AlignedPath {
  std::vector<Pose> poses;
  double scale = 1;
};

/// Nothing where least squares have no single answer: fewer than three positions, or all on a line.
std::optional<AlignedPath> aligned(std::span<const Pose> estimate, std::span<const Pose> truth,
                                   PathAlignment alignment);

}  // namespace mosbench
