#include "datasets/formats/moe_labels.hpp"

#include <mosbench/scan.hpp>
#include <string>

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {

std::vector<std::uint32_t> parse_moe_labels(std::string_view text, std::size_t point_count,
                                            const std::filesystem::path& file) {
  constexpr std::size_t kNumbers = 3;
  std::vector<std::uint32_t> labels;
  for (const TextLine& line : split_lines(text, file)) {
    const auto words = split_at_blanks(line.text);
    const bool numbers = words.size() == kNumbers && parse_double(words[0]) &&
                         parse_double(words[1]) && parse_double(words[2]);
    const double moving = numbers ? *parse_double(words[1]) : -1.0;
    if (moving != 0.0 && moving != 1.0) {
      throw DataError(file, line.number, quoted(line.text) + " is no label of MOE",
                      "Moveable_ID Moving_Status Class_ID, the second 0 or 1");
    }
    labels.push_back(moving == 1.0 ? kMovingLabel : kStaticLabel);
  }
  if (labels.size() != point_count) {
    throw DataError(file, std::to_string(labels.size()) + " rows",
                    "one for each of the " + std::to_string(point_count) + " points of its scan");
  }
  return labels;
}

std::vector<std::uint32_t> read_moe_labels(const std::filesystem::path& file,
                                           std::size_t point_count) {
  return parse_moe_labels(read_file(file), point_count, file);
}

}  // namespace mosbench
