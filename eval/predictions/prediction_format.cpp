#include "eval/predictions/prediction_format.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

using Format = PredictionFormat;

constexpr std::array kFormats = {
    DescribedFormat{Format::kLabel, "label", ".label", true,
                    "uint32 per point, file named like its scan"},
    DescribedFormat{Format::kLabelByIndex, "label-index", ".label", true,
                    "uint32 per point, file named by the scan's position from 0 (HMM-MOS)"},
    DescribedFormat{Format::kMaskedLabel, "label-masked", ".label", true,
                    "uint32 per point within a range only (MapMOS, 4DMOS), label-masked:MIN,MAX"},
    DescribedFormat{Format::kText, "text", ".txt", true,
                    "a row per point: 0 or 1, or the three numbers of MOE, the second counts"},
    DescribedFormat{Format::kPcd, "pcd", ".pcd", true,
                    "intensity 0 or 1 (KTH) or a label id (ERASOR) per point"},
    DescribedFormat{Format::kCsv, "csv", ".csv", true,
                    "a row per point with a column label (id) or moving (0 or 1)"},
    DescribedFormat{Format::kNpy, "npy", ".npy", true,
                    "a confidence 0 to 1 per point, moving above 0.5 (4DMOS, also in its folders)"},
    DescribedFormat{Format::kRows, "rows", "", false,
                    "scan number from 1, then its moving points: HMM-MOS on DOALS"},
    DescribedFormat{Format::kIndices, "indices", ".csv", false,
                    "stamp in ns, then its moving points: as DOALS's indices.csv"},
    DescribedFormat{
        Format::kDynabloxClouds, "dynablox-clouds", ".csv", false,
        "clouds.csv of Dynablox, a row per point of each labelled scan, dynablox:LEVEL"},
    DescribedFormat{Format::kDynabloxScores, "dynablox-scores", ".csv", false,
                    "scores.csv of Dynablox, its own counts per labelled scan, dynablox:LEVEL"},
    DescribedFormat{Format::kHdf5, "h5", ".h5", false,
                    "dufo of each group of OpenSceneFlow's .h5, 0 or 1 per point; may be DATA"}};

}  // namespace

std::span<const DescribedFormat> prediction_formats() { return kFormats; }

const DescribedFormat& describe(PredictionFormat format) {
  return *std::ranges::find(kFormats, format, &DescribedFormat::format);
}

PredictionFormat prediction_format_named(std::string_view name) {
  const auto found = std::ranges::find(kFormats, name, &DescribedFormat::name);
  if (found != kFormats.end()) return found->format;
  std::string names;
  for (const DescribedFormat& format : kFormats) {
    names += (names.empty() ? "" : ", ") + std::string(format.name);
  }
  throw UsageError(fmt::format("--format: '{}' is not known, expected one of {}", name, names));
}

}  // namespace mosbench
