#include "eval/answer/picture.hpp"

#include <png.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <stdexcept>

#include "datasets/text/json_text.hpp"

namespace mosbench {

// Embedded by CMakeLists.txt: a PGM picture of the letters that pictures hold, and the colours of
// pictures and of the report's page as JSON.
std::string_view glyphs_asset();
std::string_view palette_asset();

namespace {

/// Parses "#rrggbb".
Colour colour_from(const std::string& text) {
  const auto channel = [&text](std::size_t start) {
    std::uint8_t value = 0;
    std::from_chars(text.data() + start, text.data() + start + 2, value, 16);
    return value;
  };
  return {channel(1), channel(3), channel(5)};
}

constexpr int kFirstGlyph = 32;
constexpr int kGlyphs = 95;
static_assert(sizeof(Colour) == 3);

/// Brightness of the glyphs in one row, without the header of their file.
std::string_view glyph_levels() {
  const std::string_view file = glyphs_asset();
  constexpr std::size_t kBytes =
      std::size_t{Picture::kGlyphWidth} * kGlyphs * Picture::kGlyphHeight;
  return file.substr(file.size() - kBytes);
}

int floor_pixel(double position) { return static_cast<int>(std::floor(position)); }

}  // namespace

Palette palette(bool dark) {
  const char* theme = dark ? "dark" : "light";
  const auto json = parse_json(palette_asset(), "palette.json");
  const auto colour = [&](const nlohmann::ordered_json& entry) {
    return colour_from(entry.at(theme));
  };
  Palette palette{
      {}, {}, {}, colour(json.at("background")), colour(json.at("text")), colour(json.at("guide"))};
  const auto swatch = [&](const nlohmann::ordered_json& entry) {
    const std::string name = entry.at("name");
    return Swatch{colour(entry), name, entry.value("without_truth", name)};
  };
  for (const auto& [key, swatches] : {std::pair{"outcomes", &palette.outcomes},
                                      {"reasons", &palette.reasons},
                                      {"scenes", &palette.scenes}}) {
    for (const nlohmann::ordered_json& entry : json.at(key)) swatches->push_back(swatch(entry));
  }
  return palette;
}

Picture::Picture(std::size_t width, std::size_t height, Colour background)
    : width_(width), height_(height), pixels_(width * height, background) {}

void Picture::blend(int x, int y, Colour colour, double opacity) {
  if (x < 0 || y < 0 || x >= static_cast<int>(width_) || y >= static_cast<int>(height_)) return;
  Colour& pixel = pixels_[static_cast<std::size_t>(y) * width_ + static_cast<std::size_t>(x)];
  const auto mix = [opacity](std::uint8_t from, std::uint8_t to) {
    return static_cast<std::uint8_t>(std::lround(from + opacity * (to - from)));
  };
  pixel = {mix(pixel.red, colour.red), mix(pixel.green, colour.green),
           mix(pixel.blue, colour.blue)};
}

void Picture::disc(double x, double y, double radius, Colour colour) {
  if (x < -radius || y < -radius || x > static_cast<double>(width_) + radius ||
      y > static_cast<double>(height_) + radius) {
    return;
  }
  for (int row = floor_pixel(y - radius); row <= floor_pixel(y + radius); ++row) {
    for (int column = floor_pixel(x - radius); column <= floor_pixel(x + radius); ++column) {
      const double distance = std::hypot(column + 0.5 - x, row + 0.5 - y);
      blend(column, row, colour, std::clamp(radius + 0.5 - distance, 0.0, 1.0));
    }
  }
}

void Picture::ring(double x, double y, double radius, Colour colour) {
  // Half a pixel apart, so that the line has no gaps.
  const auto steps = static_cast<int>(4.0 * std::numbers::pi * radius);
  for (int s = 0; s < steps; ++s) {
    const double angle_rad = 2.0 * std::numbers::pi * s / steps;
    blend(floor_pixel(x + radius * std::cos(angle_rad)),
          floor_pixel(y + radius * std::sin(angle_rad)), colour, 0.6);
  }
}

void Picture::line(double from_x, double from_y, double to_x, double to_y, double width,
                   Colour colour) {
  const double along_x = to_x - from_x, along_y = to_y - from_y;
  const double square = along_x * along_x + along_y * along_y;
  if (!std::isfinite(square)) return;
  const double reach = width / 2 + 1;
  const auto first = [&](double a, double b, std::size_t size) {
    return floor_pixel(std::clamp(std::min(a, b) - reach, 0.0, static_cast<double>(size)));
  };
  const auto last = [&](double a, double b, std::size_t size) {
    return floor_pixel(std::clamp(std::max(a, b) + reach, -1.0, static_cast<double>(size) - 1));
  };
  for (int row = first(from_y, to_y, height_); row <= last(from_y, to_y, height_); ++row) {
    for (int column = first(from_x, to_x, width_); column <= last(from_x, to_x, width_); ++column) {
      const double x = column + 0.5 - from_x, y = row + 0.5 - from_y;
      const double share =
          square > 0 ? std::clamp((x * along_x + y * along_y) / square, 0.0, 1.0) : 0.0;
      const double distance = std::hypot(x - share * along_x, y - share * along_y);
      blend(column, row, colour, std::clamp(width / 2 + 0.5 - distance, 0.0, 1.0));
    }
  }
}

void Picture::rectangle(int x, int y, int width, int height, Colour colour, double opacity) {
  for (int row = y; row < y + height; ++row) {
    for (int column = x; column < x + width; ++column) blend(column, row, colour, opacity);
  }
}

void Picture::text(int x, int y, std::string_view text, Colour colour, int scale) {
  const std::string_view levels = glyph_levels();
  for (std::size_t i = 0; i < text.size(); ++i) {
    int glyph = static_cast<unsigned char>(text[i]) - kFirstGlyph;
    if (glyph < 0 || glyph >= kGlyphs) glyph = '?' - kFirstGlyph;
    const int left = x + static_cast<int>(i) * kGlyphWidth * scale;
    for (int row = 0; row < kGlyphHeight * scale; ++row) {
      for (int column = 0; column < kGlyphWidth * scale; ++column) {
        const int level = (row / scale * kGlyphs + glyph) * kGlyphWidth + column / scale;
        blend(left + column, y + row, colour,
              static_cast<unsigned char>(levels[static_cast<std::size_t>(level)]) / 255.0);
      }
    }
  }
}

std::vector<std::string> wrapped(std::span<const std::string> lines, std::size_t most) {
  std::vector<std::string> parts;
  for (std::string_view rest : lines) {
    while (rest.size() > most) {
      const std::size_t blank = rest.rfind(' ', most);
      const bool is_word = blank == rest.npos || blank == 0;
      parts.emplace_back(rest.substr(0, is_word ? most : blank));
      rest.remove_prefix(is_word ? most : blank + 1);
    }
    parts.emplace_back(rest);
  }
  return parts;
}

std::string Picture::png() const {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width_);
  image.height = static_cast<png_uint_32>(height_);
  image.format = PNG_FORMAT_RGB;
  std::string bytes(PNG_IMAGE_PNG_SIZE_MAX(image), '\0');
  png_alloc_size_t size = bytes.size();
  if (png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels_.data(), 0, nullptr) == 0) {
    throw std::runtime_error(std::string("libpng: ") + image.message);
  }
  bytes.resize(size);
  return bytes;
}

}  // namespace mosbench
