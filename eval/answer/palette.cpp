#include "eval/answer/palette.hpp"

#include <charconv>
#include <nlohmann/json.hpp>

#include "datasets/text/json_text.hpp"
#include "eval/answer/answer_assets.hpp"

namespace mosbench {
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

}  // namespace

Palette palette(bool dark) {
  const char* theme = dark ? "dark" : "light";
  const auto json = parse_json(palette_asset(), "palette.json");
  const auto colour = [&](const nlohmann::ordered_json& entry) {
    return colour_from(entry.at(theme));
  };
  Palette palette{
      {}, {}, colour(json.at("background")), colour(json.at("text")), colour(json.at("guide"))};
  const auto swatch = [&](const nlohmann::ordered_json& entry) {
    const std::string name = entry.at("name");
    return Swatch{colour(entry), name, entry.value("without_truth", name)};
  };
  for (const nlohmann::ordered_json& entry : json.at("outcomes")) {
    palette.outcomes.push_back(swatch(entry));
  }
  for (const nlohmann::ordered_json& entry : json.at("reasons")) {
    palette.reasons.push_back(swatch(entry));
  }
  return palette;
}

}  // namespace mosbench
