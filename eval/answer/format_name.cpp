#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "datasets/text/errors.hpp"
#include "eval/answer/render.hpp"

namespace mosbench {
namespace {

struct Ending {
  std::string_view text;
  Format format;
};
constexpr std::array<Ending, 9> kEndings = {{{".txt", Format::kText},
                                             {".json", Format::kJson},
                                             {".csv", Format::kCsv},
                                             {".tex", Format::kLatex},
                                             {".md", Format::kMarkdown},
                                             {".html", Format::kHtml},
                                             {".htm", Format::kHtml},
                                             {".xml", Format::kJunit},
                                             {".png", Format::kPng}}};

}  // namespace

std::span<const std::string_view> format_names() {
  static constexpr std::array<std::string_view, 9> kNames = {
      "text", "json", "csv", "latex", "markdown", "html", "github", "junit", "png"};
  return kNames;
}

Format format_named(std::string_view name) {
  const auto names = format_names();
  const auto found = std::ranges::find(names, name);
  if (found != names.end()) return static_cast<Format>(found - names.begin());
  throw UsageError(
      fmt::format("--as: '{}' is no format, expected one of {}", name, fmt::join(names, ", ")));
}

std::optional<Format> format_of_name(const std::filesystem::path& file) {
  const auto row = std::ranges::find(kEndings, file.extension().string(), &Ending::text);
  return row == kEndings.end() ? std::nullopt : std::optional(row->format);
}

void check_name(const std::filesystem::path& file, Format written) {
  constexpr std::array<std::string_view, 10> kNever = {".pdf", ".svg", ".jpg",  ".jpeg", ".gif",
                                                       ".eps", ".bmp", ".tiff", ".webp", ".mp4"};
  const std::string ending = file.extension().string();
  const bool never = std::ranges::find(kNever, ending) != kNever.end();
  if (!never && format_of_name(file).value_or(written) == written) return;
  std::vector<std::string_view> expected;
  for (const Ending& each : kEndings) {
    if (each.format == written) expected.push_back(each.text);
  }
  throw UsageError(fmt::format("{}: {} is not what is written, expected a name that ends in {}",
                               file.string(), ending, fmt::join(expected, " or ")));
}

}  // namespace mosbench
