#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

struct Colour {
  std::uint8_t red = 0, green = 0, blue = 0;
  bool operator==(const Colour&) const = default;
};

/// A colour and what it stands for.
struct Swatch {
  Colour colour;
  std::string name;
  std::string name_without_truth;  ///< the same but for outcomes
};

/// Colours of a light or dark picture, equal to those of the report's page. Those of outcomes and
/// those of reasons can be distinguished with any colour vision.
struct Palette {
  std::vector<Swatch> outcomes;  ///< by PointOutcome
  std::vector<Swatch> reasons;   ///< by Reason
  std::vector<Swatch> scenes;    ///< by ErrorScene
  Colour background, text, guide;
};

Palette palette(bool dark);

/// A picture in memory. Coordinates are pixels from the upper left corner; what is outside is not
/// drawn. Edges are antialiased.
class Picture {
 public:
  static constexpr int kGlyphWidth = 10;
  static constexpr int kGlyphHeight = 20;

  Picture(std::size_t width, std::size_t height, Colour background);

  std::size_t width() const { return width_; }
  std::size_t height() const { return height_; }
  Colour at(std::size_t x, std::size_t y) const { return pixels_[y * width_ + x]; }

  void disc(double x, double y, double radius, Colour colour);
  void ring(double x, double y, double radius, Colour colour);
  void line(double from_x, double from_y, double to_x, double to_y, double width, Colour colour);
  void rectangle(int x, int y, int width, int height, Colour colour, double opacity = 1.0);
  /// Draws ASCII text with (x, y) as its upper left corner, `scale` times as large; other
  /// characters become "?".
  void text(int x, int y, std::string_view text, Colour colour, int scale = 1);

  /// Returns the bytes of a PNG file.
  std::string png() const;

 private:
  void blend(int x, int y, Colour colour, double opacity);

  std::size_t width_, height_;
  std::vector<Colour> pixels_;
};

/// Breaks lines at blanks, longer words anywhere, so that none has more letters than `most`.
std::vector<std::string> wrapped(std::span<const std::string> lines, std::size_t most);

/// A line through points (x, y) that are finite; a ring around a single one.
struct Curve {
  std::string name;
  Colour colour;
  std::vector<std::array<double, 2>> points;
};

struct LineChart {
  std::string title, x_label, y_label;
  bool equal_scales = false;  ///< a metre is as long in x as in y
  std::vector<Curve> curves;
  /// Of both axes, instead of those of the points.
  std::optional<std::array<double, 2>> limits = std::nullopt;
};

/// Draws charts side by side, each `size_pixels` wide and high, with axes that show all points and
/// the names of the curves. A later curve lies over an earlier one. Below them stand the marks.
Picture line_charts(std::span<const LineChart> charts, std::size_t size_pixels,
                    std::span<const std::string> marks = {});

}  // namespace mosbench
