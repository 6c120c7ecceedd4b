#include "eval/cli/suggested_command.hpp"

#include <fmt/format.h>

#include <string_view>

#include "datasets/text/text.hpp"
#include "eval/cli/dataset_flags.hpp"

namespace mosbench {
namespace {

/// A file for one sequence, a folder for several: `--poses` takes either.
constexpr std::string_view kFoundPoses = "found-poses";

}  // namespace

std::string typed_line(const std::vector<std::string>& arguments) {
  std::string line = "\n  mosbench";
  for (const std::string& argument : arguments) line += ' ' + shell_word(argument);
  return line;
}

std::string given_words(const CLI::App& command,
                        const std::function<bool(const CLI::Option&)>& wanted) {
  std::string words;
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() == 0 || !wanted(*option)) continue;
    if (option->nonpositional()) words += ' ' + option->get_name();
    if (option->get_items_expected_max() == 0) continue;
    words += ' ' + shell_word(fmt::format("{}", fmt::join(option->results(), ",")));
  }
  return words;
}

std::string commands_with_odometry(const CLI::App& command,
                                   const std::vector<std::string>& arguments) {
  if (command.get_option_no_throw("--odometry") != nullptr) {
    return typed_line(arguments) + " --odometry simple";
  }
  if (command.get_option_no_throw("--poses") == nullptr) return "";
  return fmt::format("\n  mosbench odometry{} -o {}{} --poses {}",
                     given_words(command, chooses_scans), kFoundPoses, typed_line(arguments),
                     kFoundPoses);
}

}  // namespace mosbench
