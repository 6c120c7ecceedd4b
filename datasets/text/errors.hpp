#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

namespace mosbench {

/// A file or folder is not what it has to be. The program ends with exit code 3.
class DataError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  /// Message "<file>: <what is wrong>, expected <what was expected>".
  DataError(const std::filesystem::path& file, const std::string& wrong,
            const std::string& expected);
  /// The same with a line (from 1) or record index after the file's name: "<file>:<line>: ...".
  DataError(const std::filesystem::path& file, std::size_t line, const std::string& wrong,
            const std::string& expected);
};

/// A flag, key or value given by the user is wrong. The program ends with exit code 2.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// How the user gives an option a value, in the words of the program that runs: of "pose_frame" the
/// bare name and a blank, unless the program said otherwise when it started, as the one with flags
/// does. Errors name options so.
std::string option(std::string_view name, std::string_view value = {});
using OptionWords = std::string (*)(std::string_view name, std::string_view value);
void word_options_by(OptionWords words);

}  // namespace mosbench
