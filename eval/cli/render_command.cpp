#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <memory>
#include <numbers>
#include <optional>
#include <set>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/output_file.hpp"
#include "eval/cli/picture_sequence.hpp"
#include "eval/protocols/metrics.hpp"
#include "eval/report/result_boxes.hpp"
#include "eval/report/scan_choice.hpp"
#include "eval/report/scan_picture.hpp"
#include "eval/results/progress.hpp"
#include "eval/results/result_set.hpp"

namespace mosbench {
namespace {

constexpr const char* kRenderFooter =
    R"(Draws one scan without browser or graphics card: true and false points, their counts, range rings
in metres. K counts from 0; "worst" is the scan with the most false points, not one in which the
method did not look for motion yet. RESULT is of `mosbench run` or `mosbench score --out`; points
and labels are read again from where they were read then, or points from --data.

--view top looks from above, orbit from a camera that circles the sensor and looks at it from 30
degrees above; --azimuth says where the camera looks, in degrees counterclockwise from the front of
the sensor. --scans draws several, given as for `mosbench report` (A-B, every:N, all), to a video
(.mp4 or .gif, by ffmpeg, which `apt-get install ffmpeg` brings) or else to a folder, a PNG file
each; the camera of an orbit then turns by --turn degrees from the first to the last.

--reasons colours points by why they are called moving, as `mosbench run --scores` with the method
hmm-mos-plus wrote it: arrived in space that was free, left it free behind, where an object that
moved before is expected, connected with such, or feet, what is next to the ground below them.

--boxes draws a box around each cluster of at least 5 points that are labelled moving, with its
speed: that of the cluster's middle in the map over half a second before and after, where the
clusters of the ten scans before and after are linked to it. A speed is of what is seen of an
object: where more or less of it comes into sight, it is off by some tenths of a metre per second.

Examples:
  mosbench render results/runs/sim --scan 20 -o scan.png
  mosbench render results/runs/doals --sequence hauptgebaeude/sequence_1 --scan worst -o worst.png
  mosbench render results/runs/08 --scan 120 -o dark.png --dark --range 30 --size 1600
  mosbench render results/runs/08-best --scan 120 -o why.png --reasons --range 30
  mosbench render results/runs/08 --scans 40-90 -o street.mp4
  mosbench render results/runs/08 --scan 120 -o boxes.png --view orbit --azimuth 30 --boxes
  mosbench render results/runs/08 --scans 40-90 -o orbit.gif --view orbit --turn 360
  mosbench render results/runs/08 --scans every:10 -o pictures)";

constexpr double kUsualTurn_deg = 90.0;

struct RenderFlags {
  std::filesystem::path input, out;
  std::optional<std::filesystem::path> dataset_root;
  std::optional<std::string> sequence;
  std::optional<std::string> scan, scans;
  double per_s = 10.0;
  std::string view = "top";
  std::optional<double> azimuth_deg, turn_deg;
  bool boxes = false;
  ScanPictureOptions picture;
};

std::set<std::string> names_of(const std::vector<FoundResult>& results) {
  std::set<std::string> names;
  for (const FoundResult& result : results) names.insert(result.name.text());
  return names;
}

/// Returns the folders of the runs that the results are of.
std::set<std::string> run_folders(const std::vector<FoundResult>& results) {
  std::set<std::string> runs;
  for (const FoundResult& result : results) {
    runs.insert(folder_of_run(result.folder, result.name).string());
  }
  return runs;
}

FoundResult choose_result(const RenderFlags& options) {
  std::vector<FoundResult> results = find_results(options.input);
  const std::set<std::string> names = names_of(results);
  if (options.sequence) {
    std::erase_if(results, [&](const FoundResult& result) {
      return result.name.text() != *options.sequence;
    });
  }
  if (results.size() == 1) return std::move(results.front());
  if (results.empty()) {
    throw UsageError(fmt::format("--sequence: {} holds no results of {}, expected one of {}",
                                 options.input.string(), mosbench::quoted(*options.sequence),
                                 fmt::join(names, ", ")));
  }
  if (const std::set<std::string> runs = run_folders(results); runs.size() > 1) {
    throw UsageError(fmt::format("{}: holds results of {} runs, expected one of {}",
                                 options.input.string(), runs.size(), fmt::join(runs, ", ")));
  }
  throw UsageError(fmt::format("{}: holds results of {}, expected --sequence to name one",
                               options.input.string(), fmt::join(names, ", ")));
}

std::size_t choose_scan(const std::string& text, const std::vector<ScanRow>& rows) {
  const bool has_truth =
      std::ranges::any_of(rows, [](const ScanRow& row) { return row.counts.has_value(); });
  if (text == "worst" && has_truth) return worst_first(rows).front();
  std::size_t scan = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), scan);
  if (error == std::errc() && end == text.data() + text.size() && scan < rows.size()) return scan;
  const auto last = static_cast<std::ptrdiff_t>(rows.size()) - 1;
  if (text == "worst") {
    throw UsageError(
        fmt::format("--scan: worst: no scan of the result has truth, expected 0 to {}", last));
  }
  throw UsageError(
      fmt::format("--scan: '{}' is no scan of the result, expected worst or 0 to {}", text, last));
}

/// Throws UsageError for a scan that mosbench score left out.
void check_has_labels(const ResultScans& scans, std::size_t scan_index) {
  if (scans.has(scan_index)) return;
  throw UsageError(fmt::format("--scan: scan {} ({}) was not scored, expected one that was",
                               scan_index, scans.rows()[scan_index].stem));
}

std::vector<std::string> title_of(const FoundResult& result, std::size_t scan_index) {
  const ScanRow& row = result.file.rows.scans[scan_index];
  std::vector<std::string> lines = {
      fmt::format("{}, scan {} ({})", result.name.text(), scan_index, row.stem)};
  if (row.counts) {
    const auto percent = [](const std::optional<double>& value) {
      return value ? fmt::format("{:.1f} %", 100.0 * *value) : std::string("undefined");
    };
    lines.push_back(fmt::format("IoU {}, precision {}, recall {}", percent(moving_iou(*row.counts)),
                                percent(precision(*row.counts)), percent(recall(*row.counts))));
  } else {
    lines.emplace_back("without truth");
  }
  if (result.file.content.contains("simulated")) lines.emplace_back("simulated");
  return lines;
}

void check_has_reasons(const ResultScans& scans) {
  if (scans.has_reasons()) return;
  throw DataError(scans.result().folder / "reasons", "is not there",
                  "a run of mosbench run --scores by a method that says why points move");
}

/// Where the camera looks in one of several pictures.
ScanViewpoint viewpoint_of(const RenderFlags& options, std::size_t picture, std::size_t pictures) {
  if (options.view == "top") return {};
  const double share =
      pictures < 2 ? 0.0 : static_cast<double>(picture) / static_cast<double>(pictures - 1);
  const double degrees =
      options.azimuth_deg.value_or(0.0) + share * options.turn_deg.value_or(kUsualTurn_deg);
  return {degrees * std::numbers::pi / 180.0};
}

/// Draws scans one after the other.
class Pictures {
 public:
  Pictures(const RenderFlags& options, const ResultScans& scans, std::vector<std::size_t> chosen)
      : options_(options), scans_(scans), chosen_(std::move(chosen)) {
    if (options.boxes) boxes_ = boxes_of(scans, chosen_);
  }

  std::string png(std::size_t i) const {
    ScanPictureOptions picture = options_.picture;
    picture.title = title_of(scans_.result(), chosen_[i]);
    picture.viewpoint = viewpoint_of(options_, i, chosen_.size());
    if (options_.boxes) picture.boxes = boxes_[i];
    return scan_picture(scans_.read(chosen_[i]), picture).png();
  }

 private:
  const RenderFlags& options_;
  const ResultScans& scans_;
  std::vector<std::size_t> chosen_;
  std::vector<std::vector<MovingBox>> boxes_;
};

/// The scans that --scans names, in their own order.
std::vector<std::size_t> chosen_scans(const ResultScans& scans, const std::string& text) {
  std::vector<std::size_t> chosen = ScanChoice(text).wanted(scans.rows());
  std::erase_if(chosen, [&](std::size_t k) { return !scans.has(k); });
  std::ranges::sort(chosen);
  if (!chosen.empty()) return chosen;
  throw UsageError(fmt::format("--scans: '{}' chooses no scan, expected some of 0 to {}", text,
                               static_cast<std::ptrdiff_t>(scans.rows().size()) - 1));
}

Answer render_several(RenderFlags& options, const ResultScans& scans) {
  const std::vector<std::size_t> chosen = chosen_scans(scans, *options.scans);
  // One range for all pictures, or they would jump.
  if (options.picture.range_m <= 0.0) {
    options.picture.range_m = reach_m(scans.read(chosen[chosen.size() / 2]));
  }
  const Pictures drawn(options, scans, chosen);
  PictureSequence pictures(options.out, options.per_s);
  Progress progress("render", chosen.size());
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    pictures.add(scans.rows()[chosen[i]].stem, drawn.png(i));
    progress.advance();
  }
  return {pictures.finish()};
}

void check_view(const RenderFlags& options) {
  if (options.view == "top" && (options.azimuth_deg || options.turn_deg)) {
    throw UsageError("--azimuth and --turn: are of --view orbit, expected it, too");
  }
  if (options.scan && options.turn_deg) {
    throw UsageError("--turn: is of several pictures, expected --scans, or --azimuth alone");
  }
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

Answer render(RenderFlags& options) {
  check_view(options);
  if (options.scan.has_value() == options.scans.has_value()) {
    throw UsageError("--scan or --scans: say which scans to draw, expected one of them");
  }
  const bool is_folder = options.scans && names_folder(options.out);
  check_output(is_folder ? options.out / "000000.png" : options.out);
  const FoundResult result = choose_result(options);
  const ResultScans scans(result, options.dataset_root);
  if (options.picture.by_reason) check_has_reasons(scans);
  if (options.scans) return render_several(options, scans);
  const std::size_t scan_index = choose_scan(*options.scan, scans.rows());
  check_has_labels(scans, scan_index);
  write_output(options.out, Pictures(options, scans, {scan_index}).png(0));
  return answer_beside(options.out,
                       {fmt::format("scan {} of {} in {}\n", scans.rows()[scan_index].stem,
                                    result.name.text(), options.out.string())});
}

}  // namespace

CommandRun add_render(CLI::App& command) {
  auto options = std::make_shared<RenderFlags>();
  command
      .add_option("RESULT", options->input, "Folder that `mosbench run` or `mosbench score` wrote")
      ->type_name("DIR")
      ->required();
  command.add_option("--scan", options->scan, "Number of the scan from 0, or worst")
      ->type_name("K");
  command.add_option("--scans", options->scans, "Scans of a video or a folder of pictures")
      ->type_name("SCANS");
  command.add_option("--per-s", options->per_s, "Pictures per second of a video")
      ->check(CLI::Range(0.1, 120.0))
      ->capture_default_str();
  command
      .add_option("-o,--out", options->out,
                  "PNG file to write, - is stdout; of --scans .mp4, .gif or a folder")
      ->type_name("FILE")
      ->required();
  command.add_option("--sequence", options->sequence, "Sequence, where RESULT holds several")
      ->type_name("NAME");
  command
      .add_option("--data", options->dataset_root,
                  "Folder of the data set (default: where the run read it)")
      ->type_name("DIR");
  command
      .add_option("--range", options->picture.range_m,
                  "Metres from the sensor to the edge (default: what holds 98 % of the points)")
      ->check(CLI::Range(1.0, 1000.0));
  command.add_option("--size", options->picture.size_pixels, "Width and height in pixels")
      ->check(CLI::Range(200, 8000))
      ->capture_default_str();
  command.add_option("--view", options->view, "From above, or from a camera around the sensor")
      ->check(CLI::IsMember({"top", "orbit"}))
      ->capture_default_str();
  command
      .add_option("--azimuth", options->azimuth_deg,
                  "Degrees from the sensor's front to where the camera looks (default: 0)")
      ->check(CLI::Range(-360.0, 360.0));
  command
      .add_option("--turn", options->turn_deg,
                  "Degrees by which the camera turns over --scans (default: 90)")
      ->check(CLI::Range(-3600.0, 3600.0));
  command.add_flag("--boxes", options->boxes, "Draw boxes around what moves, with speeds");
  command.add_flag("--reasons", options->picture.by_reason,
                   "Colour what is called moving by why, as `mosbench run --scores` kept it");
  command.add_flag("--dark", options->picture.dark, "Draw light points on a dark ground");
  command.footer(kRenderFooter);
  return [options] { return render(*options); };
}

}  // namespace mosbench
