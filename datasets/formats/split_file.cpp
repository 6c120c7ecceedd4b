#include "datasets/formats/split_file.hpp"

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {

std::set<std::uint64_t> parse_split(std::string_view text, const std::filesystem::path& file) {
  std::set<std::uint64_t> numbers;
  for (const TextLine& line : split_lines(text, file)) {
    const auto number = parse_unsigned(line.text);
    if (!number) {
      throw DataError(file, line.number, quoted(line.text) + " is no frame number",
                      "one whole number per line");
    }
    numbers.insert(*number);
  }
  if (numbers.empty()) throw DataError(file, "holds no frame number", "one per line");
  return numbers;
}

std::string format_split(const std::set<std::uint64_t>& numbers) {
  std::string text;
  for (const std::uint64_t number : numbers) text += std::to_string(number) + '\n';
  return text;
}

std::set<std::uint64_t> read_split(const std::filesystem::path& file) {
  return parse_split(read_file(file), file);
}

void write_split(const std::filesystem::path& file, const std::set<std::uint64_t>& numbers) {
  write_file_atomic(file, format_split(numbers));
}

}  // namespace mosbench
