#include "datasets/text/errors.hpp"

namespace mosbench {

DataError::DataError(const std::filesystem::path& file, const std::string& wrong,
                     const std::string& expected)
    : std::runtime_error(file.string() + ": " + wrong + ", expected " + expected) {}

DataError::DataError(const std::filesystem::path& file, std::size_t line, const std::string& wrong,
                     const std::string& expected)
    : std::runtime_error(file.string() + ":" + std::to_string(line) + ": " + wrong + ", expected " +
                         expected) {}

}  // namespace mosbench
