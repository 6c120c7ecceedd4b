#include "eval/report/birds_eye.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "eval/report/palette.hpp"
#include "eval/report/point_planes.hpp"

namespace mosbench {
namespace {

constexpr int kMargin = 12;
constexpr int kLine = Picture::kGlyphHeight + 2;

/// Whether a point is drawn over the background. Such points are drawn in stored order: where right
/// and wrong ones overlap, the picture shows the more frequent kind.
bool stands_out(PointOutcome outcome) {
  return outcome != PointOutcome::kTrueNegative && outcome != PointOutcome::kIgnoredStatic;
}

/// Returns a round number of metres that gives three to eight rings.
double ring_step_m(double range_m) {
  double step_m = 1.0;
  for (const double factor : {2.0, 2.5, 2.0, 2.0, 2.5, 2.0}) {
    if (range_m / step_m <= 8.0) break;
    step_m *= factor;
  }
  return step_m;
}

class BirdsEye {
 public:
  BirdsEye(const JudgedScan& scan, const BirdsEyeOptions& options)
      : scan_(scan),
        options_(options),
        palette_(palette(options.dark)),
        range_m_(options.range_m > 0.0 ? options.range_m : reach_m(scan)),
        middle_(static_cast<double>(options.size_pixels) / 2.0),
        pixels_per_m_(middle_ / range_m_),
        picture_(options.size_pixels, options.size_pixels, palette_.background) {}

  Picture draw() && {
    draw_rings();
    for (const bool standing_out : {false, true}) draw_points(standing_out);
    picture_.disc(middle_, middle_, 3.5, palette_.text);
    draw_box(kMargin, kMargin, options_.title);
    draw_legend();
    return std::move(picture_);
  }

 private:
  void draw_rings() {
    const double step_m = ring_step_m(range_m_);
    const Colour label_colour =
        palette_.outcomes[static_cast<std::size_t>(PointOutcome::kTrueNegative)];
    for (double radius_m = step_m; radius_m <= range_m_; radius_m += step_m) {
      picture_.ring(middle_, middle_, radius_m * pixels_per_m_, palette_.guide);
      const std::string label = fmt::format("{:g} m", radius_m);
      picture_.text(static_cast<int>(middle_) + 4,
                    static_cast<int>(middle_ - radius_m * pixels_per_m_) + 2, label, label_colour);
    }
  }

  void draw_points(bool standing_out) {
    const double radius = standing_out ? 2.0 : 0.9;
    for (std::size_t i = 0; i < scan_.outcomes.size(); ++i) {
      const PointOutcome outcome = scan_.outcomes[i];
      const Point& point = scan_.frame.points[i];
      if (stands_out(outcome) != standing_out || !is_drawable(point)) continue;
      picture_.disc(middle_ - static_cast<double>(point.y) * pixels_per_m_,
                    middle_ - static_cast<double>(point.x) * pixels_per_m_, radius,
                    palette_.outcomes[static_cast<std::size_t>(outcome)]);
    }
  }

  /// Draws lines of text on a filled box; returns its height in pixels.
  int draw_box(int x, int y, const std::vector<std::string>& lines, int indent = 0) {
    std::size_t longest = 0;
    for (const std::string& line : lines) longest = std::max(longest, line.size());
    const int width = static_cast<int>(longest) * Picture::kGlyphWidth + 2 * kMargin + indent;
    const int height = static_cast<int>(lines.size()) * kLine + kMargin;
    picture_.rectangle(x, y, width, height, palette_.background, 0.88);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      picture_.text(x + kMargin + indent, y + kMargin / 2 + static_cast<int>(i) * kLine, lines[i],
                    palette_.text);
    }
    return height;
  }

  void draw_legend() {
    OutcomeCounts counts{};
    for (const PointOutcome outcome : scan_.outcomes) ++counts[static_cast<std::size_t>(outcome)];
    std::vector<std::string> lines;
    std::vector<Colour> swatches;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      if (counts[i] == 0) continue;
      lines.push_back(fmt::format("{:<25} {:>8}", palette_.names[i], counts[i]));
      swatches.push_back(palette_.outcomes[i]);
    }
    constexpr int kIndent = 18;
    const int top = static_cast<int>(options_.size_pixels) - kMargin -
                    static_cast<int>(lines.size()) * kLine - kMargin;
    draw_box(kMargin, top, lines, kIndent);
    for (std::size_t i = 0; i < swatches.size(); ++i) {
      const int middle = top + kMargin / 2 + static_cast<int>(i) * kLine + kLine / 2;
      picture_.disc(2 * kMargin + 5, middle, 6.0, palette_.text);
      picture_.disc(2 * kMargin + 5, middle, 5.0, swatches[i]);
    }
  }

  const JudgedScan& scan_;
  const BirdsEyeOptions& options_;
  Palette palette_;
  double range_m_;
  double middle_;
  double pixels_per_m_;
  Picture picture_;
};

}  // namespace

double reach_m(const JudgedScan& scan) {
  std::vector<double> distances_m;
  for (const Point& point : scan.frame.points) {
    if (is_drawable(point))
      distances_m.push_back(std::hypot(static_cast<double>(point.x), static_cast<double>(point.y)));
  }
  if (distances_m.empty()) return 10.0;
  const auto most = distances_m.begin() +
                    static_cast<std::ptrdiff_t>(0.98 * static_cast<double>(distances_m.size() - 1));
  std::ranges::nth_element(distances_m, most);
  return 5.0 * std::max(1.0, std::ceil(*most / 5.0));
}

Picture birds_eye(const JudgedScan& scan, const BirdsEyeOptions& options) {
  return BirdsEye(scan, options).draw();
}

}  // namespace mosbench
