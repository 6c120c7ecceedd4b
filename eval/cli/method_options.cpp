#include "eval/cli/method_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "datasets/text/errors.hpp"
#include "eval/cli/dataset_flags.hpp"
#include "eval/cli/help_text.hpp"

namespace mosbench {
namespace {

bool looks_like_assignment(const std::string& argument) {
  const std::size_t equals = argument.find('=');
  if (equals == std::string::npos || equals == 0) return false;
  return std::all_of(argument.begin(), argument.begin() + static_cast<std::ptrdiff_t>(equals),
                     [](char c) { return std::strchr("_.-", c) || (c >= 'a' && c <= 'z'); });
}

void append_split(const std::string& assignments, std::vector<std::string>& list) {
  for (std::size_t begin = 0; begin <= assignments.size();) {
    const std::size_t end = std::min(assignments.find(',', begin), assignments.size());
    list.push_back(assignments.substr(begin, end - begin));
    begin = end + 1;
  }
}

/// "@FILE", "moving=ever" or an assignment to one of the method's settings.
void take_setting(const std::string& text, JobWords& words) {
  constexpr std::string_view kMoving = "moving=";
  if (text.starts_with('@')) {
    if (words.config_file) {
      throw UsageError(fmt::format("--set {}: is a second file, expected one", text));
    }
    words.config_file = text.substr(1);
  } else if (text.starts_with(kMoving)) {
    words.moving = text.substr(kMoving.size());
  } else {
    words.assignments.push_back(text);
  }
}

// --set takes one argument; what follows it as in `--set a=1 b=2 DATA` goes to a positional option
// of its own, defined before DATA, that accepts assignments only.
void add_set_flag(CLI::App& command, JobWords& words) {
  CLI::Option* set = command.add_option_function<std::vector<std::string>>(
      "--set", [](const auto&) {},
      "Settings, which win over all others; @FILE holds a JSON object of them");
  set->type_name("KEY=VALUE,...")->allow_extra_args(false)->check([](const std::string& text) {
    return text.starts_with('@') || text.find('=') != std::string::npos
               ? ""
               : text + " has no value, expected key=value or @FILE";
  });
  CLI::Option* further = command.add_option_function<std::vector<std::string>>(
      "SETTING", [](const auto&) {}, "Further settings of --set");
  further->group("")->check([set](const std::string& text) {
    return set->count() > 0 && looks_like_assignment(text) ? "" : "is no setting";
  });
  command.validate_positionals();
  // Where a setting is given twice, the later one counts.
  command.final_callback([&command, &words, set, further] {
    std::vector<std::string> assignments;
    std::size_t of_flag = 0, positional = 0;
    for (const CLI::Option* option : command.parse_order()) {
      if (option == set) append_split(set->results().at(of_flag++), assignments);
      if (option == further) append_split(further->results().at(positional++), assignments);
    }
    for (const std::string& assignment : assignments) take_setting(assignment, words);
  });
}

}  // namespace

void add_method_options(CLI::App& command, JobWords& words, unsigned& threads) {
  add_set_flag(command, words);
  add_dataset_flags(command, words.input, words.dataset, words.sequences, words.reading);
  command
      .add_option("--method", words.method,
                  "Method that segments, see `mosbench list methods`; for run also A,B or all "
                  "(default: hmm-mos)")
      ->type_name("METHOD");
  command
      .add_option("--preset", words.preset, "Published settings, or `best` (default: by data set)")
      ->type_name("PRESET");
  add_threads_flag(command, threads);
}

}  // namespace mosbench
