#include "eval/predictions/predictions.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/json_text.hpp"
#include "datasets/text/text.hpp"
#include "eval/predictions/prediction_errors.hpp"
#include "eval/predictions/prediction_place.hpp"
#include "eval/predictions/scan_file_predictions.hpp"
#include "eval/predictions/sequence_file_predictions.hpp"

namespace mosbench {
namespace {

/// Positions first to last in a list, both inclusive.
struct Run {
  std::size_t first, last;
};

/// Returns where `is_in` holds without a gap.
template <typename Condition>
std::vector<Run> runs_of(std::size_t size, const Condition& is_in) {
  std::vector<Run> runs;
  for (std::size_t i = 0; i < size; ++i) {
    if (!is_in(i)) continue;
    if (!runs.empty() && runs.back().last + 1 == i) {
      runs.back().last = i;
    } else {
      runs.push_back({i, i});
    }
  }
  return runs;
}

DataError no_rows(const PredictionPlace& place, const std::string& first, const std::string& last) {
  const std::string scans = first == last ? "scan " + first : "scans " + first + " to " + last;
  return {place.path, "has no row for " + scans, "a row for every scan with truth"};
}

DataError no_files(const std::filesystem::path& first, const std::filesystem::path& last) {
  const std::string wrong = first == last ? "is not there"
                                          : fmt::format("is not there, nor what follows up to {}",
                                                        last.filename().string());
  return {first, wrong, "a prediction for every scan with truth"};
}

/// Returns the stems of wanted scans without prediction and reports each stretch of them.
std::vector<std::string> missing_scans(const Predictions& labels, const PredictionPlace& place,
                                       const Sequence& sequence,
                                       const std::vector<std::size_t>& wanted,
                                       PredictionErrors& errors) {
  const DescribedFormat& format = describe(place.format);
  const auto stem = [&](std::size_t i) { return sequence.stem(wanted[i]); };
  const auto file = [&](std::size_t i) {
    const bool by_position = place.format == PredictionFormat::kLabelByIndex;
    const std::string name = by_position ? fmt::format("{:06d}", wanted[i]) : stem(i);
    return place.path / (name + std::string(format.extension));
  };
  // A file that exists was bad, which has been reported.
  const auto is_unreported = [&](std::size_t i) {
    return !labels.has(wanted[i]) && !(format.per_scan && is_there(file(i)));
  };
  for (const Run& run : runs_of(wanted.size(), is_unreported)) {
    errors.report(format.per_scan ? no_files(file(run.first), file(run.last))
                                  : no_rows(place, stem(run.first), stem(run.last)));
  }
  std::vector<std::string> missing;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (!labels.has(wanted[i])) missing.push_back(stem(i));
  }
  return missing;
}

/// Labels with a given mask are read as cut by range even if no file is shorter than its scan.
PredictionFormat settle_format(PredictionFormat found, const PredictionOptions& options) {
  if (!options.mask || found == PredictionFormat::kMaskedLabel) return found;
  if (found == PredictionFormat::kLabel && !options.format) return PredictionFormat::kMaskedLabel;
  throw UsageError(fmt::format("--format {}: a range is not for format {}, expected none",
                               describe(PredictionFormat::kMaskedLabel).name,
                               describe(found).name));
}

/// Says where labels that mosbench wrote are of scans that were disturbed in another way.
std::string disturbance_remark(const PredictionPlace& place, const Sequence& sequence) {
  const std::filesystem::path file = place.path.parent_path() / "result.json";
  std::string labelled, now;
  try {
    if (!is_there(file)) return "";
    labelled = parse_json(read_file(file), file).at("reading").value("perturb", "");
  } catch (const DataError&) {  // of another program
    return "";
  } catch (const nlohmann::json::exception&) {
    return "";
  }
  if (const auto& perturb = sequence.reading().perturb) now = to_string(*perturb);
  if (labelled == now) return "";
  const auto text = [](const std::string& perturb) {
    return perturb.empty() ? std::string("not disturbed") : "disturbed by " + perturb;
  };
  return fmt::format(
      "the scans that were labelled are {}, those read now are {}: the same --perturb "
      "makes them agree",
      text(labelled), text(now));
}

}  // namespace

std::string id_map_text(const LabelIdMap& map) {
  std::string text;
  for (const auto& [from, to] : map) {
    text += fmt::format("{}{}:{}", text.empty() ? "" : ",", from, to);
  }
  return text;
}

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

DataError OpenedPredictions::with_format(const DataError& error) const {
  return DataError(fmt::format("{} (read in format {}{})", error.what(), describe(format).name,
                               guessed ? ", recognised; --format overrides" : ""));
}

OpenedPredictions open_predictions(const std::filesystem::path& root, const Sequence& sequence,
                                   const std::vector<std::size_t>& wanted, bool only_sequence,
                                   const PredictionOptions& options) {
  PredictionPlace place = find_predictions(root, sequence, only_sequence, options.format);
  place.format = settle_format(place.format, options);
  PredictionErrors errors(options.allow_missing);
  OpenedPredictions opened{nullptr, place.format, !options.format, place.path, {}, {}};
  try {
    opened.labels = describe(place.format).per_scan
                        ? open_scan_files(place, sequence, wanted, options, errors, opened.remarks)
                        : open_sequence_file(place, sequence, options, errors);
    opened.missing = missing_scans(*opened.labels, place, sequence, wanted, errors);
  } catch (const DataError& error) {
    throw opened.with_format(error);
  }
  if (std::string remark = disturbance_remark(place, sequence); !remark.empty()) {
    opened.remarks.push_back(std::move(remark));
  }
  opened.remarks.insert(opened.remarks.end(), errors.texts().begin(), errors.texts().end());
  return opened;
}

}  // namespace mosbench
