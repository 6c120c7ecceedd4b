#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/flags.hpp"
#include "eval/report/render_scans.hpp"

namespace mosbench {
namespace {

struct RenderFlags : RenderOptions {
  std::string view = "top";
  std::vector<std::string> shown;
};

/// "top", or "orbit", "orbit:30", "orbit+360" or "orbit:30+90": where the camera looks, and by how
/// much it turns.
void take_view(const std::string& view, RenderOptions& options) {
  if (view == "top") return;
  constexpr std::string_view kOrbit = "orbit";
  const auto refuse = [&](const char* what) {
    throw UsageError(fmt::format("--view: '{}' {}", view, what));
  };
  if (!view.starts_with(kOrbit)) refuse("is not known, expected top or orbit[:DEG][+DEG]");
  const std::string angles = view.substr(kOrbit.size());
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

Answer render(RenderFlags flags) {
  take_view(flags.view, flags);
  for (const std::string& what : flags.shown) {
    (what == "boxes"    ? flags.boxes
     : what == "scenes" ? flags.scenes
                        : flags.picture.by_reason) = true;
  }
  if (flags.scenes && flags.picture.by_reason) {
    throw UsageError("--show: reasons and scenes both colour points, expected one of them");
  }
  return render_scans(std::move(flags));
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
      ->check(number_in(0.1, 120.0))
      ->capture_default_str();
  add(command, "-o,--out FILE", options->out,
      "PNG file to write, - is stdout; of --scans .mp4, .gif or a folder")
      ->required();
  add(command, "--sequences NAME", options->sequence, "Sequence, where RESULT holds several");
  add(command, "--data DIR", options->dataset_root,
      "Folder of the data set (default: where the run read it)");
  add(command, "--range", options->picture.range_m,
      "Metres from the sensor to the edge (default: what holds 98 % of the points)")
      ->check(number_in(1.0, 1000.0));
  add(command, "--size", options->picture.size_pixels, "Width and height in pixels")
      ->check(CLI::Range(200, 8000))
      ->capture_default_str();
  add(command, "--view VIEW", options->view,
      "top, or orbit:AZIMUTH+TURN, from a camera around the sensor: degrees from the "
      "sensor's front (default: 0) and over several scans (default: 90)")
      ->capture_default_str();
  add_list(command, "--show WHAT,...", options->shown,
           "Also boxes, around what moves, with speeds; reasons, colours by why a point is "
           "called moving, of a run with --write scores; scenes, colours by what lies around false "
           "and missed points")
      ->check(CLI::IsMember({"boxes", "reasons", "scenes"}));
  command.add_flag("--dark", options->picture.dark, "Draw light points on a dark ground");
  return [options] { return render(*options); };
}

}  // namespace mosbench
