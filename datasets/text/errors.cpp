#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

std::string bare_words(std::string_view name, std::string_view value) {
  return std::string(name) + (value.empty() ? "" : " ") + std::string(value);
}

OptionWords option_words = bare_words;

}  // namespace

DataError::DataError(const std::filesystem::path& file, const std::string& wrong,
                     const std::string& expected)
    : std::runtime_error(file.string() + ": " + wrong + ", expected " + expected) {}

DataError::DataError(const std::filesystem::path& file, std::size_t line, const std::string& wrong,
                     const std::string& expected)
    : std::runtime_error(file.string() + ":" + std::to_string(line) + ": " + wrong + ", expected " +
                         expected) {}

std::string option(std::string_view name, std::string_view value) {
  return option_words(name, value);
}

void word_options_by(OptionWords words) { option_words = words; }

}  // namespace mosbench
