#include "eval/report/render_scans.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <numbers>
#include <set>
#include <utility>

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/protocols/metrics.hpp"
#include "eval/report/label_products.hpp"
#include "eval/report/picture_sequence.hpp"
#include "eval/report/scan_choice.hpp"
#include "eval/result/output.hpp"
#include "eval/result/result.hpp"
#include "eval/result/tell.hpp"

namespace mosbench {
namespace {

constexpr double kUsualTurn_deg = 90.0;

template <typename Text>
std::set<std::string> texts_of(const std::vector<Result>& results, Text&& text) {
  std::set<std::string> texts;
  for (const Result& result : results) texts.insert(text(result));
  return texts;
}

Result choose_result(const RenderOptions& options) {
  std::vector<Result> results = read_results(options.input);
  const std::set<std::string> names =
      texts_of(results, [](const Result& result) { return result.sequence.text(); });
  if (options.sequence) {
    std::erase_if(
        results, [&](const Result& result) { return result.sequence.text() != *options.sequence; });
  }
  if (results.size() == 1) return std::move(results.front());
  if (results.empty()) {
    throw UsageError(fmt::format("--sequences: {} holds no results of {}, expected one of {}",
                                 options.input.string(), mosbench::quoted(*options.sequence),
                                 fmt::join(names, ", ")));
  }
  const std::set<std::string> runs = texts_of(results, [](const Result& result) {
    return folder_of_run(result.folder(), result.sequence).string();
  });
  if (runs.size() > 1) {
    throw UsageError(fmt::format("{}: holds results of {} runs, expected one of {}",
                                 options.input.string(), runs.size(), fmt::join(runs, ", ")));
  }
  throw UsageError(fmt::format("{}: holds results of {}, expected --sequences to name one",
                               options.input.string(), fmt::join(names, ", ")));
}

std::size_t choose_scan(const std::string& text, const std::vector<ScanRow>& rows) {
  const bool has_truth =
      std::ranges::any_of(rows, [](const ScanRow& row) { return row.counts.has_value(); });
  if (text == "worst" && has_truth) return worst_first(rows).front();
  const auto scan = parse_unsigned(text);
  if (scan && *scan < rows.size()) return *scan;
  const auto last = static_cast<std::ptrdiff_t>(rows.size()) - 1;
  if (text == "worst") {
    throw UsageError(
        fmt::format("--scans: worst: no scan of the result has truth, expected 0 to {}", last));
  }
  throw UsageError(
      fmt::format("--scans: '{}' is no scan of the result, expected worst or 0 to {}", text, last));
}

/// Throws UsageError for a scan that mosbench score left out.
void check_has_labels(const ResultScans& scans, std::size_t scan_index) {
  if (scans.has(scan_index)) return;
  throw UsageError(fmt::format("--scans: scan {} ({}) was not scored, expected one that was",
                               scan_index, scans.rows()[scan_index].stem));
}

std::vector<std::string> title_of(const Result& result, std::size_t scan_index) {
  const ScanRow& row = result.scans[scan_index];
  std::vector<std::string> lines = {
      fmt::format("{}, scan {} ({})", result.sequence.text(), scan_index, row.stem)};
  if (row.counts) {
    const auto percent = [](const std::optional<double>& value) {
      return value ? fmt::format("{:.1f} %", 100.0 * *value) : std::string("undefined");
    };
    lines.push_back(fmt::format("IoU {}, precision {}, recall {}", percent(moving_iou(*row.counts)),
                                percent(precision(*row.counts)), percent(recall(*row.counts))));
  } else {
    lines.emplace_back("without truth");
  }
  if (result.is_simulated()) lines.emplace_back("simulated");
  std::ranges::move(notices_of(result), std::back_inserter(lines));
  return lines;
}

void check_has_reasons(const ResultScans& scans) {
  if (scans.has_reasons()) return;
  throw DataError(scans.result().folder() / "reasons", "is not there",
                  "a run of mosbench run --write scores by a method that says why points move");
}

/// Throws DataError where no scan can have an error.
void check_has_truth(const ResultScans& scans, const std::vector<std::size_t>& chosen) {
  const auto has_truth = [&](std::size_t k) { return scans.rows()[k].counts.has_value(); };
  if (std::ranges::any_of(chosen, has_truth)) return;
  throw DataError(scans.result().folder(), "has no truth of the chosen scans",
                  "scans with labels, around whose errors --show scenes looks");
}

/// Where the camera looks in one of several pictures.
std::optional<double> orbit_rad_of(const RenderOptions& options, std::size_t picture,
                                   std::size_t pictures) {
  if (!options.azimuth_deg) return std::nullopt;
  const double share =
      pictures < 2 ? 0.0 : static_cast<double>(picture) / static_cast<double>(pictures - 1);
  const double degrees = *options.azimuth_deg + share * options.turn_deg.value_or(kUsualTurn_deg);
  return degrees * std::numbers::pi / 180.0;
}

/// Draws scans one after the other, each as a PNG file that `take` gets.
void draw(const RenderOptions& options, const ResultScans& scans,
          const std::vector<std::size_t>& chosen,
          const std::function<void(const std::string& stem, std::string_view png)>& take) {
  if (options.scenes) check_has_truth(scans, chosen);
  std::vector<std::vector<MovingBox>> boxes;
  if (options.boxes) boxes = boxes_of(scans, chosen);
  const std::vector<double> times_s = times_of_all(scans.sequence());
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const JudgedScan scan = scans.read(chosen[i]);
    ScanPictureOptions picture = options.picture;
    picture.title = title_of(scans.result(), chosen[i]);
    picture.orbit_rad = orbit_rad_of(options, i, chosen.size());
    if (options.boxes) picture.boxes = boxes[i];
    if (options.scenes) picture.scenes = error_scenes(scans, chosen[i], scan, times_s);
    take(scans.rows()[chosen[i]].stem, scan_picture(scan, picture).png());
  }
}

/// The scans that --scans names, in their own order.
std::vector<std::size_t> chosen_scans(const ResultScans& scans, const std::string& text) {
  std::vector<std::size_t> chosen = ScanChoice(text).wanted(scans.rows());
  std::erase_if(chosen, [&](std::size_t k) { return !scans.has(k); });
  std::ranges::sort(chosen);
  if (!chosen.empty()) return chosen;
  throw UsageError(fmt::format("--scans: '{}' chooses no scan, expected some of 0 to {}", text,
                               static_cast<std::ptrdiff_t>(scans.rows().size()) - 1));
}

Answer render_several(RenderOptions& options, const ResultScans& scans) {
  const std::vector<std::size_t> chosen = chosen_scans(scans, options.scans);
  // One range for all pictures, or they would jump.
  if (options.picture.range_m <= 0.0) {
    options.picture.range_m = reach_m(scans.read(chosen[chosen.size() / 2]));
  }
  PictureSequence pictures(options.out, options.per_s);
  Progress progress("render", chosen.size());
  draw(options, scans, chosen, [&](const std::string& stem, std::string_view png) {
    pictures.add(stem, png);
    progress.advance();
  });
  return {pictures.finish()};
}

/// Whether --out of --scans is a folder of pictures. Throws UsageError for another kind of file.
bool names_folder(const std::filesystem::path& out) {
  if (is_video(out)) return false;
  const std::string extension = lower_case(out.extension().string());
  for (const char* other : {".png", ".jpg", ".avi", ".mkv", ".mov", ".webm"}) {
    if (extension != other) continue;
    throw UsageError(
        fmt::format("-o: {} is not written of several scans, expected .mp4, .gif or a "
                    "folder for a .png each",
                    out.string()));
  }
  return true;
}

}  // namespace

Answer render_scans(RenderOptions options) {
  const bool is_folder = !options.one_scan() && names_folder(options.out);
  const bool is_film = !options.one_scan() && is_video(options.out);
  check_output(is_folder ? options.out / "000000.png" : options.out,
               is_film ? std::nullopt : std::optional(Format::kPng));
  const Result result = choose_result(options);
  const ResultScans scans(result, options.dataset_root);
  if (options.picture.by_reason) check_has_reasons(scans);
  if (!options.one_scan()) return render_several(options, scans);
  const std::size_t scan_index = choose_scan(options.scans, scans.rows());
  check_has_labels(scans, scan_index);
  draw(options, scans, {scan_index},
       [&](const std::string&, std::string_view png) { write_output(options.out, png); });
  return answer_beside(options.out,
                       {fmt::format("scan {} of {} in {}\n", scans.rows()[scan_index].stem,
                                    result.sequence.text(), options.out.string())});
}

}  // namespace mosbench
