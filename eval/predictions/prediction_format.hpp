#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace mosbench {

/// File formats of predictions; docs/formats/predictions.md describes them.
enum class PredictionFormat : std::uint8_t {
  kLabel,
  kLabelByIndex,
  kMaskedLabel,
  kText,
  kPcd,
  kCsv,
  kNpy,
  kRows,
  kIndices,
  kDynabloxClouds,
  kDynabloxScores,
  kHdf5
};

struct DescribedFormat {
  PredictionFormat format;
  std::string_view name;       ///< for --format
  std::string_view extension;  ///< of its files
  bool per_scan;               ///< a file per scan; otherwise one for the whole sequence
  std::string_view description;
};

std::span<const DescribedFormat> prediction_formats();
const DescribedFormat& describe(PredictionFormat format);
/// Throws UsageError naming all formats.
PredictionFormat prediction_format_named(std::string_view name);

}  // namespace mosbench
