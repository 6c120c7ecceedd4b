#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "eval/answer/picture.hpp"

namespace mosbench {
namespace {

constexpr int kLeft = 90, kTop = 94, kRight = 30, kBottom = 70;
constexpr double kCurveWidth = 2.5, kGuideWidth = 1.0, kRingRadius = 6.0;

/// What an axis shows.
struct Axis {
  double low, high, step;
};

/// 1, 2 or 5 times a power of ten, so that some six of them are the length.
double tick_step(double length) {
  const double power = std::pow(10.0, std::floor(std::log10(length / 6)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= length / 6) return factor * power;
  }
  return 10 * power;
}

Axis axis_of(const LineChart& chart, std::size_t dimension) {
  if (chart.limits) {
    const auto [low, high] = *chart.limits;
    return {low, high, tick_step(high - low)};
  }
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Curve& curve : chart.curves) {
    for (const auto& point : curve.points) {
      low = std::min(low, point[dimension]);
      high = std::max(high, point[dimension]);
    }
  }
  if (!(low <= high) || !std::isfinite(high - low)) low = high = 0;
  // So wide that ticks differ in the digits that a number has.
  const double size = std::max(std::abs(low), std::abs(high));
  const double margin = std::max({0.04 * (high - low), 1e-3, 1e-6 * size});
  return {low - margin, high + margin, tick_step(high - low + 2 * margin)};
}

/// Widens both axes to the same length.
void make_equal(Axis& x, Axis& y) {
  const double length = std::max(x.high - x.low, y.high - y.low);
  for (Axis* axis : {&x, &y}) {
    const double middle = axis->low / 2 + axis->high / 2;  // without overflow
    *axis = {middle - length / 2, middle + length / 2, tick_step(length)};
  }
}

class ChartPainter {
 public:
  ChartPainter(const LineChart& chart, int left, std::size_t size, Picture& picture)
      : chart_(chart),
        colours_(palette(false)),
        left_(left + kLeft),
        side_(static_cast<int>(size) - kTop - kBottom),
        width_(static_cast<int>(size) - kLeft - kRight),
        x_(axis_of(chart, 0)),
        y_(axis_of(chart, 1)),
        picture_(picture) {
    if (!chart.equal_scales) return;
    make_equal(x_, y_);
    width_ = side_ = std::min(width_, side_);
  }

  void draw() {
    draw_ticks();
    for (const Curve& curve : chart_.curves) draw_curve(curve);
    picture_.text(left_, 12, chart_.title, colours_.text);
    picture_.text(left_ + width_ - text_width(chart_.x_label), kTop + side_ + 34, chart_.x_label,
                  colours_.text);
    picture_.text(left_ - kLeft + 8, kTop - 26, chart_.y_label, colours_.text);
    draw_names();
  }

 private:
  static int text_width(const std::string& text) {
    return static_cast<int>(text.size()) * Picture::kGlyphWidth;
  }
  double pixel_x(double x) const { return left_ + (x - x_.low) / (x_.high - x_.low) * width_; }
  double pixel_y(double y) const { return kTop + (y_.high - y) / (y_.high - y_.low) * side_; }

  void draw_ticks() {
    for (double x = std::ceil(x_.low / x_.step) * x_.step; x <= x_.high; x += x_.step) {
      picture_.line(pixel_x(x), kTop, pixel_x(x), kTop + side_, kGuideWidth, colours_.guide);
      const std::string label = tick_text(x, x_.step);
      picture_.text(static_cast<int>(pixel_x(x)) - text_width(label) / 2, kTop + side_ + 8, label,
                    colours_.text);
    }
    for (double y = std::ceil(y_.low / y_.step) * y_.step; y <= y_.high; y += y_.step) {
      picture_.line(left_, pixel_y(y), left_ + width_, pixel_y(y), kGuideWidth, colours_.guide);
      const std::string label = tick_text(y, y_.step);
      picture_.text(left_ - 8 - text_width(label),
                    static_cast<int>(pixel_y(y)) - Picture::kGlyphHeight / 2, label, colours_.text);
    }
  }

  /// Without the rounding of a tick that is 0.
  static std::string tick_text(double value, double step) {
    if (std::abs(value) < step / 1e6) return "0";
    const double digits = std::log10(std::max(std::abs(value), step)) - std::log10(step);
    return fmt::format("{:.{}g}", value, std::clamp(2 + static_cast<int>(digits), 4, 9));
  }

  void draw_curve(const Curve& curve) {
    if (curve.points.size() == 1) {
      const auto& [x, y] = curve.points.front();
      picture_.ring(pixel_x(x), pixel_y(y), kRingRadius, curve.colour);
    }
    for (std::size_t i = 0; i < curve.points.size(); ++i) {
      const auto& from = curve.points[i == 0 ? 0 : i - 1];
      const auto& to = curve.points[i];
      picture_.line(pixel_x(from[0]), pixel_y(from[1]), pixel_x(to[0]), pixel_y(to[1]), kCurveWidth,
                    curve.colour);
    }
  }

  void draw_names() {
    int x = left_;
    for (const Curve& curve : chart_.curves) {
      picture_.line(x, kTop - 42, x + 24, kTop - 42, kCurveWidth, curve.colour);
      picture_.text(x + 32, kTop - 52, curve.name, colours_.text);
      x += 56 + text_width(curve.name);
    }
  }

  const LineChart& chart_;
  Palette colours_;
  int left_, side_, width_;
  Axis x_, y_;
  Picture& picture_;
};

}  // namespace

Picture line_charts(std::span<const LineChart> charts, std::size_t size_pixels,
                    std::span<const std::string> marks) {
  constexpr int kMarkLine = Picture::kGlyphHeight + 4;
  const Palette colours = palette(false);
  constexpr int kIndent = 8;
  const std::size_t width = charts.size() * size_pixels;
  const std::vector<std::string> lines =
      wrapped(marks, (width - 2 * kIndent) / Picture::kGlyphWidth);
  Picture picture(width, size_pixels + lines.size() * kMarkLine, colours.background);
  int below = static_cast<int>(size_pixels);
  for (const std::string& mark : lines) {
    picture.text(kIndent, below, mark, colours.text);
    below += kMarkLine;
  }
  int left = 0;
  for (const LineChart& chart : charts) {
    ChartPainter(chart, left, size_pixels, picture).draw();
    left += static_cast<int>(size_pixels);
  }
  return picture;
}

}  // namespace mosbench
