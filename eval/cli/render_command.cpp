#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/flags.hpp"
#include "eval/protocols/metrics.hpp"
#include "eval/report/label_products.hpp"
#include "eval/report/scan_choice.hpp"
#include "eval/report/scan_picture.hpp"
#include "eval/result/result.hpp"
#include "eval/result/tell.hpp"

namespace mosbench {
namespace {

constexpr double kUsualTurn_deg = 90.0;

struct RenderFlags {
  std::filesystem::path input, out;
  std::optional<std::filesystem::path> dataset_root;
  std::optional<std::string> sequence;
  std::string scans, view = "top";
  double per_s = 10.0;
  std::vector<std::string> shown;
  std::optional<double> azimuth_deg, turn_deg;
  bool boxes = false;

  /// Whether one picture is drawn: of a scan by its number, or of the worst.
  bool one_scan() const {
    return scans == "worst" ||
           (!scans.empty() && scans.find_first_not_of("0123456789") == scans.npos);
  }
  ScanPictureOptions picture;
};

template <typename Text>
std::set<std::string> texts_of(const std::vector<Result>& results, Text&& text) {
  std::set<std::string> texts;
  for (const Result& result : results) texts.insert(text(result));
  return texts;
}

Result choose_result(const RenderFlags& options) {
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
  std::ranges::move(doubts_of(result), std::back_inserter(lines));
  return lines;
}

void check_has_reasons(const ResultScans& scans) {
  if (scans.has_reasons()) return;
  throw DataError(scans.result().folder() / "reasons", "is not there",
                  "a run of mosbench run --write scores by a method that says why points move");
}

bool has_ffmpeg() { return std::system("command -v ffmpeg >/dev/null 2>&1") == 0; }

std::string extension_of(const std::filesystem::path& file) {
  return lower_case(file.extension().string());
}

/// Videos that every player shows have an even size; a gif has colours of its own.
std::string ffmpeg_command(const std::string& pictures, const std::filesystem::path& file,
                           double per_s) {
  const bool gif = extension_of(file) == ".gif";
  const char* picture = gif ? "-filter_complex '[0:v]split[a][b];[a]palettegen[p];[b][p]paletteuse'"
                            : "-vf 'pad=ceil(iw/2)*2:ceil(ih/2)*2' -pix_fmt yuv420p";
  return fmt::format("ffmpeg -loglevel error -y -framerate {:g} {} {} {}", per_s, pictures, picture,
                     shell_word(file.string()));
}

/// Whether pictures of several scans go into one file.
bool is_video(const std::filesystem::path& out) {
  return extension_of(out) == ".mp4" || extension_of(out) == ".gif";
}

/// Where the pictures of several scans go: into a video (.mp4, .gif) by ffmpeg, or into a folder, a
/// PNG file each. Without ffmpeg the folder is named like the video.
class PictureSequence {
 public:
  PictureSequence(const std::filesystem::path& out, double per_s) : folder_(out) {
    if (!is_video(out)) return;
    if (!has_ffmpeg()) {
      folder_.replace_extension();
      const std::string all = "-pattern_type glob -i " + shell_word((folder_ / "*.png").string());
      tell(fmt::format(
          "ffmpeg is not there (Debian's package ffmpeg): pictures go to {} instead, of "
          "which it makes the video by\n  {}",
          folder_.string(), ffmpeg_command(all, out, per_s)));
      return;
    }
    out_ = std::filesystem::absolute(out);
    std::filesystem::create_directories(out_.parent_path());
    partial_ = out_.parent_path() /
               fmt::format("{}.partial{}", out_.stem().string(), out_.extension().string());
    ffmpeg_ = popen(ffmpeg_command("-f image2pipe -i -", partial_, per_s).c_str(), "w");
    if (ffmpeg_ == nullptr) throw DataError(out, "ffmpeg cannot be started", "room for a process");
  }
  ~PictureSequence() {
    if (ffmpeg_ != nullptr) pclose(ffmpeg_);
    std::error_code ignored;
    if (!partial_.empty()) std::filesystem::remove(partial_, ignored);
  }
  PictureSequence(const PictureSequence&) = delete;
  PictureSequence& operator=(const PictureSequence&) = delete;

  void add(const std::string& stem, std::string_view png) {
    ++pictures_;
    if (ffmpeg_ == nullptr) return write_file_atomic(folder_ / (stem + ".png"), png);
    // What ffmpeg thinks of it shows when it ends.
    std::fwrite(png.data(), 1, png.size(), ffmpeg_);
  }

  /// Returns what was made, as a sentence. Throws DataError where ffmpeg failed.
  std::string finish() {
    if (ffmpeg_ == nullptr) return fmt::format("{} pictures in {}\n", pictures_, folder_.string());
    if (pclose(std::exchange(ffmpeg_, nullptr)) != 0) {
      throw DataError(out_, "could not be made by ffmpeg",
                      "that it takes PNG files and knows H.264");
    }
    std::filesystem::rename(partial_, out_);
    return fmt::format("{} pictures in the video {}\n", pictures_, out_.string());
  }

 private:
  std::filesystem::path out_, partial_;  ///< of a video; empty for a folder
  std::filesystem::path folder_;
  FILE* ffmpeg_ = nullptr;
  std::size_t pictures_ = 0;
};

/// Where the camera looks in one of several pictures.
std::optional<double> orbit_rad_of(const RenderFlags& options, std::size_t picture,
                                   std::size_t pictures) {
  if (!options.azimuth_deg) return std::nullopt;
  const double share =
      pictures < 2 ? 0.0 : static_cast<double>(picture) / static_cast<double>(pictures - 1);
  const double degrees = *options.azimuth_deg + share * options.turn_deg.value_or(kUsualTurn_deg);
  return degrees * std::numbers::pi / 180.0;
}

/// Draws scans one after the other, each as a PNG file that `take` gets.
void draw(const RenderFlags& options, const ResultScans& scans,
          const std::vector<std::size_t>& chosen,
          const std::function<void(const std::string& stem, std::string_view png)>& take) {
  std::vector<std::vector<MovingBox>> boxes;
  if (options.boxes) boxes = boxes_of(scans, chosen);
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    ScanPictureOptions picture = options.picture;
    picture.title = title_of(scans.result(), chosen[i]);
    picture.orbit_rad = orbit_rad_of(options, i, chosen.size());
    if (options.boxes) picture.boxes = boxes[i];
    take(scans.rows()[chosen[i]].stem, scan_picture(scans.read(chosen[i]), picture).png());
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

Answer render_several(RenderFlags& options, const ResultScans& scans) {
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

/// "top", or "orbit", "orbit:30", "orbit+360" or "orbit:30+90": where the camera looks, and by how
/// much it turns.
void take_view(RenderFlags& options) {
  if (options.view == "top") return;
  constexpr std::string_view kOrbit = "orbit";
  const auto refuse = [&](const char* what) {
    throw UsageError(fmt::format("--view: '{}' {}", options.view, what));
  };
  if (!options.view.starts_with(kOrbit)) refuse("is not known, expected top or orbit[:DEG][+DEG]");
  const std::string angles = options.view.substr(kOrbit.size());
  const std::size_t plus = angles.find('+');
  const std::string azimuth = angles.substr(0, plus);
  options.azimuth_deg = 0.0;
  if (!azimuth.empty()) {
    options.azimuth_deg = azimuth.starts_with(':') ? parse_double(azimuth.substr(1)) : std::nullopt;
    if (!options.azimuth_deg || std::abs(*options.azimuth_deg) > 360.0) {
      refuse("has no azimuth, expected orbit:DEG with -360 to 360 degrees");
    }
  }
  if (plus == angles.npos) return;
  options.turn_deg = parse_double(angles.substr(plus + 1));
  if (!options.turn_deg || std::abs(*options.turn_deg) > 3600.0) {
    refuse("has no turn, expected orbit+DEG with -3600 to 3600 degrees");
  }
  if (options.one_scan()) refuse("turns over several pictures, expected several --scans");
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
  take_view(options);
  for (const std::string& what : options.shown) {
    (what == "boxes" ? options.boxes : options.picture.by_reason) = true;
  }
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

}  // namespace

CommandRun add_render(CLI::App& command) {
  auto options = std::make_shared<RenderFlags>();
  add(command, "RESULT DIR", options->input, "Folder that `mosbench run` or `mosbench score` wrote")
      ->required();
  add(command, "--scans SCANS", options->scans,
      "Number of the scan from 0, or worst; several, as for `mosbench report`, make a "
      "video or a folder of pictures")
      ->required();
  add(command, "--per-s", options->per_s, "Pictures per second of a video")
      ->check(CLI::Range(0.1, 120.0))
      ->capture_default_str();
  add(command, "-o,--out FILE", options->out,
      "PNG file to write, - is stdout; of --scans .mp4, .gif or a folder")
      ->required();
  add(command, "--sequences NAME", options->sequence, "Sequence, where RESULT holds several");
  add(command, "--data DIR", options->dataset_root,
      "Folder of the data set (default: where the run read it)");
  add(command, "--range", options->picture.range_m,
      "Metres from the sensor to the edge (default: what holds 98 % of the points)")
      ->check(CLI::Range(1.0, 1000.0));
  add(command, "--size", options->picture.size_pixels, "Width and height in pixels")
      ->check(CLI::Range(200, 8000))
      ->capture_default_str();
  add(command, "--view VIEW", options->view,
      "top, or orbit:AZIMUTH+TURN, from a camera around the sensor: degrees from the "
      "sensor's front (default: 0) and over several scans (default: 90)")
      ->capture_default_str();
  add_list(command, "--show WHAT,...", options->shown,
           "Also boxes, around what moves, with speeds; reasons, colours by why a point is "
           "called moving, of a run with --write scores")
      ->check(CLI::IsMember({"boxes", "reasons"}));
  command.add_flag("--dark", options->picture.dark, "Draw light points on a dark ground");
  return [options] { return render(*options); };
}

}  // namespace mosbench
