#include "eval/cli/command_line.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <map>
#include <mosbench/method.hpp>

#include "datasets/sequence/pose_source.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/answer/render.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/flags.hpp"
#include "eval/cli/old_words.hpp"
#include "eval/result/output.hpp"
#include "eval/result/tell.hpp"
#include "eval/result/version.hpp"

namespace mosbench {
namespace {

/// Otherwise `run DATA --out --json` would write into a folder "--json".
void refuse_flags_as_values(CLI::App& command) {
  const auto complaint = [](const std::string& value) {
    return value.starts_with("--") ? value + " is a flag, expected a value" : std::string();
  };
  for (CLI::Option* option : command.get_options()) {
    if (option->nonpositional() && option->get_items_expected_max() > 0) option->check(complaint);
  }
}

/// Adds --as and --json to a command. `format` gets the name.
void add_format_flags(CLI::App& command, const Command& row, std::string& format) {
  std::vector<std::string> names(format_names().begin(), format_names().end());
  std::erase_if(names, [&](const std::string& name) {
    return (name == "png" || name == "junit") && name != row.own_format;
  });
  const CLI::IsMember known(names);
  CLI::Option* as = command.add_option("--as", format, "How to print the answer")->check(known);
  if (command.get_option_no_throw("--json") != nullptr) return;
  command
      .add_flag_callback(
          "--json", [&format] { format = "json"; }, "As --as json")
      ->excludes(as);
}

/// The parser of the program, and what runs each of its commands.
struct Program {
  CLI::App app{
      "Finds the moving points in LiDAR scans, and scores the labels of any method by each\n"
      "benchmark's own rules.",
      "mosbench"};
  std::map<const CLI::App*, CommandRun> runs;
  std::string format;  ///< empty where none was asked for

  Program() {
    app.set_version_flag("-V,--version",
                         fmt::format("mosbench {} ({})", kMosbenchVersion, kCompiler),
                         "Print version and compiler, and exit");
    app.set_help_flag("-h,--help", "Print the usual flags and examples, and exit");
    app.set_help_all_flag("--help-all", "Print all flags, details and more examples, and exit");
    app.require_subcommand(1);
    for (const Command& row : commands()) {
      CLI::App* command = app.add_subcommand(std::string(row.name), std::string(row.help));
      command->group("Commands");
      runs[command] = row.add(*command);
      add_format_flags(*command, row, format);
      refuse_flags_as_values(*command);
    }
  }
};

void refuse_unknown_command(const std::vector<std::string>& arguments) {
  if (arguments.empty()) {
    throw UsageError("no command was given; see mosbench --help");
  }
  if (!arguments.front().starts_with('-')) check_command_name(arguments.front());
}

/// The parser takes "--flag=" for "--flag", or the next word for its value.
void refuse_empty_values(const std::vector<std::string>& arguments) {
  for (const std::string& argument : arguments) {
    if (argument == "--") return;
    if (!argument.starts_with("--") || argument.find('=') != argument.size() - 1) continue;
    throw UsageError(argument + ": is empty, expected a value");
  }
}

/// Returns a hint to --set delay_scans for --delay; nothing for what begins no name of a setting.
std::string as_setting(const CLI::App& command, std::string flag) {
  if (command.get_option_no_throw("--set") == nullptr) return {};
  flag.erase(0, flag.find_first_not_of('-'));
  std::ranges::replace(flag, '-', '_');
  for (const MethodKind& method : methods()) {
    for (const Setting& setting : method.defaults.all()) {
      if (setting.name.starts_with(flag)) {
        return fmt::format("a setting of {}: --set {}=...", method.name, setting.name);
      }
    }
  }
  return {};
}

/// Throws UsageError naming the first argument that the command does not know, if there is one.
void refuse_unknown_arguments(const CLI::App& command, const std::string& name) {
  std::vector<std::string> unknown = command.remaining(true);
  const auto is_flag = [](const std::string& argument) { return argument.starts_with('-'); };
  std::ranges::stable_partition(unknown, is_flag);
  if (unknown.empty()) return;
  const std::string word = unknown.front().substr(0, unknown.front().find('='));
  if (!is_flag(word)) {
    throw UsageError(
        fmt::format("{}: is one argument too many; see {} --help", unknown.front(), name));
  }
  std::vector<std::string> flags;
  for (const CLI::Option* option : command.get_options()) {
    if (option->nonpositional()) flags.push_back(option->get_name());
  }
  const std::vector<std::string_view> candidates(flags.begin(), flags.end());
  std::string hint = as_setting(command, word);
  const bool is_short = !word.starts_with("--");  // no other is near to a single letter
  if (hint.empty() && !is_short) {
    hint = fmt::format("nearest: {}", nearest_name(word, candidates));
  }
  throw UsageError(fmt::format("{}: is no flag of {}{}; see {} --help", word, name,
                               hint.empty() ? "" : fmt::format(" ({})", hint), name));
}

/// Says on stdout where the answer is when it is in a file, or on stderr when stdout holds another.
Printed printed(const Answer& answer, const std::string& asked, std::size_t columns) {
  const bool in_file = answer.file && !names_stdout(*answer.file);
  const auto named = in_file ? format_of_name(*answer.file) : std::nullopt;
  const Format format = asked.empty() ? named.value_or(answer.usual) : format_named(asked);
  Printed result{"", answer.exit_code, format == Format::kText || format == Format::kGithub};
  if (in_file) {
    check_output(*answer.file, format);
    write_output(*answer.file, render(answer, format));
    result.bytes = fmt::format("wrote {}", answer.file->string());
    if (answer.standing) {
      for (const std::string& doubt : answer.standing->doubts) result.bytes += "; " + doubt;
    }
    result.bytes += '\n';
    return result;
  }
  result.failure = answer.failure;
  if (!answer.failure.empty() && format == Format::kText) return result;
  result.bytes = render(answer, format, columns);
  // Names in it may come from files of strangers.
  if (format != Format::kPng) result.bytes = shown(result.bytes);
  if (!answer.goes_beside_stdout) return result;
  std::fputs(result.bytes.c_str(), stderr);
  result.bytes.clear();
  return result;
}

/// Returns the arguments as a line to type, on a line of its own.
std::string typed_line(const std::vector<std::string>& arguments) {
  std::string line = "\n  mosbench";
  for (const std::string& argument : arguments) line += ' ' + shell_word(argument);
  return line;
}

/// Returns the commands that get on where the scans of `command` have no poses: the same with
/// odometry, where it has that, else odometry and then the same with its poses. `arguments` are
/// what was typed; there are no poses to refine. Empty for a command that takes no poses.
std::string commands_with_odometry(const CLI::App& command, std::vector<std::string> arguments) {
  constexpr std::string_view kRefines = "--refine-poses";
  std::erase(arguments, kRefines);
  if (command.get_option_no_throw("--odometry") != nullptr) {
    return typed_line(arguments) + " --odometry simple";
  }
  if (command.get_option_no_throw("--poses") == nullptr) return "";
  // Poses are found for all scans, so that rows without stamps are those of a part, too.
  const auto chooses_scans = [](const CLI::Option& option) {
    const std::string name = option.get_name();
    return name != kRefines && name != "--scans" &&
           (option.get_group() == kReadingGroup || name == "DATA" || name == "--dataset" ||
            name == "--sequences");
  };
  // A file for one sequence, a folder for several: `--poses` takes either.
  constexpr std::string_view kFoundPoses = "found-poses";
  return fmt::format("\n  mosbench odometry{} -o {}{} --poses {}",
                     given_words(command, chooses_scans), kFoundPoses, typed_line(arguments),
                     kFoundPoses);
}

/// Returns the line in the words of today, and says it on stderr where it was another.
std::vector<std::string> without_old_words(const CLI::App& app, std::vector<std::string> typed) {
  const auto takes_value = [&](const std::string& command,
                               const std::string& flag) -> std::optional<bool> {
    const auto named =
        app.get_subcommands([&](const CLI::App* row) { return row->get_name() == command; });
    const CLI::Option* option = named.empty() ? nullptr : named.front()->get_option_no_throw(flag);
    if (option == nullptr) return std::nullopt;
    return option->get_items_expected_max() > 0;
  };
  std::vector<std::string> now = in_new_words(typed, takes_value);
  if (now != typed) tell(fmt::format("the next release knows only the words{}", typed_line(now)));
  return now;
}

/// Returns the command that was named, or the program where none was.
const CLI::App& chosen(const Program& program) {
  const auto commands = program.app.get_subcommands();
  return commands.empty() ? program.app : *commands.front();
}

/// Parses the arguments and returns their command. Throws UsageError, and CLI::Success where help
/// or version was asked for.
const CLI::App& parse(Program& program, std::vector<std::string> arguments) {
  refuse_unknown_command(arguments);
  refuse_empty_values(arguments);
  try {
    std::ranges::reverse(arguments);  // as CLI11 expects them
    program.app.parse(std::move(arguments));
  } catch (const CLI::Success&) {
    throw;
  } catch (const CLI::ParseError& error) {
    const std::string name = full_name(chosen(program));
    refuse_unknown_arguments(chosen(program), name);
    throw UsageError(fmt::format("{}; see {} --help", error.what(), name));
  }
  return chosen(program);
}

Printed answer_to_new_words(Program& program, const std::vector<std::string>& arguments,
                            std::size_t columns) {
  const CLI::App* command = nullptr;
  try {
    command = &parse(program, arguments);
  } catch (const CLI::CallForVersion& version) {
    return {std::string(version.what()) + '\n', 0, true};
  } catch (const CLI::CallForHelp&) {
    return {help_of(chosen(program)), 0, true};
  } catch (const CLI::CallForAllHelp&) {
    return {help_of(chosen(program), true), 0, true};
  }
  try {
    return printed(program.runs.at(command)(), program.format, columns);
  } catch (const MissingPoses& error) {
    const std::string commands = commands_with_odometry(*command, arguments);
    throw DataError(error.what() + (commands.empty() ? "" : ":" + commands));
  }
}

}  // namespace

Printed answer_to(std::vector<std::string> arguments, std::size_t columns) {
  Program program;
  arguments = without_old_words(program.app, std::move(arguments));
  try {
    return answer_to_new_words(program, arguments, columns);
  } catch (...) {
    const bool compares = !arguments.empty() && arguments.front() == "compare";
    if (compares) {
      keep_failure_of_compare({arguments.begin() + 1, arguments.end()}, current_failure());
    }
    throw;
  }
}

void check_line(std::vector<std::string> arguments) {
  Program program;
  try {
    parse(program, std::move(arguments));
  } catch (const CLI::Success&) {  // asks for help
  }
}

}  // namespace mosbench
