#pragma once

#include <cstddef>
#include <filesystem>
#include <mosbench/method.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

/// How the numbers of a score file are stored: little-endian int32 in results of format 1, float32
/// since.
enum class ScoreNumbers { kInt32, kFloat32 };

/// Reads LabelledScan::scores, one per point. Throws DataError unless there are exactly
/// `point_count`, all finite.
std::vector<float> parse_dynamic_scores(std::string_view bytes, std::size_t point_count,
                                        ScoreNumbers numbers, const std::filesystem::path& file);
/// Returns the bytes of a file, float32, without copying the scores.
std::string_view format_dynamic_scores(std::span<const float> scores);

/// scores/<stem>.score of a run's folder.
std::filesystem::path dynamic_score_file(const std::filesystem::path& folder,
                                         std::string_view stem);

/// Reads LabelledScan::reasons, a byte per point. Throws DataError unless there are exactly
/// `point_count`, all of them values of Reason.
std::vector<Reason> parse_reasons(std::string_view bytes, std::size_t point_count,
                                  const std::filesystem::path& file);
/// Returns the bytes of a file without copying the reasons.
std::string_view format_reasons(std::span<const Reason> reasons);

/// reasons/<stem>.reason of a run's folder.
std::filesystem::path reason_file(const std::filesystem::path& folder, std::string_view stem);

}  // namespace mosbench
