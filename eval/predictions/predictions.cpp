#include "eval/predictions/predictions.hpp"

#include <fmt/format.h>

#include "datasets/files/errors.hpp"
#include "datasets/files/files.hpp"
#include "datasets/files/text.hpp"
#include "eval/predictions/prediction_errors.hpp"
#include "eval/predictions/prediction_place.hpp"
#include "eval/predictions/scan_file_predictions.hpp"
#include "eval/predictions/sequence_file_predictions.hpp"

namespace mosbench {
namespace {

std::vector<std::string> missing_scans(const Predictions& labels, const PredictionPlace& place,
                                       const Sequence& sequence,
                                       const std::vector<std::size_t>& wanted,
                                       PredictionErrors& errors) {
  std::vector<std::string> missing;
  const DescribedFormat& format = describe(place.format);
  for (const std::size_t k : wanted) {
    if (labels.has(k)) continue;
    missing.push_back(sequence.stem(k));
    if (!format.per_scan) {
      errors.report(DataError(place.path, "has no row for scan " + sequence.stem(k),
                              "a row for every scan with truth"));
      continue;
    }
    const bool by_position = place.format == PredictionFormat::kLabelByIndex;
    const std::string name = by_position ? fmt::format("{:06d}", k) : sequence.stem(k);
    const std::filesystem::path file = place.path / (name + std::string(format.extension));
    // A file that exists was bad, which has been reported.
    if (is_there(file)) continue;
    errors.report(DataError(file, "is not there", "a prediction for every scan with truth"));
  }
  return missing;
}

/// Labels with a given mask are read as cut by range even if no file is shorter than its scan.
PredictionFormat settle_format(PredictionFormat found, const PredictionOptions& options) {
  if (!options.mask || found == PredictionFormat::kMaskedLabel) return found;
  if (found == PredictionFormat::kLabel && !options.format) return PredictionFormat::kMaskedLabel;
  throw UsageError(fmt::format("--mask: is for format {}, not for {}, expected no --mask",
                               describe(PredictionFormat::kMaskedLabel).name,
                               describe(found).name));
}

}  // namespace

LabelIdMap parse_id_map(const std::string& text) {
  LabelIdMap map;
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::string_view pair = rest.substr(0, rest.find(','));
    const std::size_t colon = pair.find(':');
    const auto from = parse_unsigned(trim(pair.substr(0, colon)));
    const auto to = colon == std::string_view::npos ? std::nullopt
                                                    : parse_unsigned(trim(pair.substr(colon + 1)));
    if (!from || !to || *from > 0xFFFF || *to > 0xFFFF) break;
    map[static_cast<std::uint16_t>(*from)] = static_cast<std::uint16_t>(*to);
    if (pair.size() == rest.size()) return map;
    rest.remove_prefix(pair.size() + 1);
  }
  throw UsageError(fmt::format(
      "--id-map: '{}' is no map of ids, expected FROM:TO,... such as 0:0,1:9,2:251", text));
}

OpenedPredictions open_predictions(const std::filesystem::path& root, const Sequence& sequence,
                                   const std::vector<std::size_t>& wanted, bool only_sequence,
                                   const PredictionOptions& options) {
  PredictionPlace place = find_predictions(root, sequence, only_sequence, options.format);
  place.format = settle_format(place.format, options);
  PredictionErrors errors(options.allow_missing);
  OpenedPredictions opened{nullptr, place.format, !options.format, place.path, {}, {}};
  opened.labels = describe(place.format).per_scan
                      ? open_scan_files(place, sequence, wanted, options, errors, opened.remarks)
                      : open_sequence_file(place, sequence, options, errors);
  opened.missing = missing_scans(*opened.labels, place, sequence, wanted, errors);
  opened.remarks.insert(opened.remarks.end(), errors.texts().begin(), errors.texts().end());
  return opened;
}

}  // namespace mosbench
