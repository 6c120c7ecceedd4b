#include "eval/cli/command_line.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>
#include <mosbench/method.hpp>

#include "datasets/sequence/pose_source.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/nearest_name.hpp"
#include "datasets/text/shown_text.hpp"
#include "eval/answer/render.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/help_text.hpp"
#include "eval/cli/output_file.hpp"
#include "eval/cli/suggested_command.hpp"
#include "eval/results/version.hpp"

namespace mosbench {
namespace {

constexpr const char* kProgramFooter = R"(Examples:
  mosbench simulate --layout semantickitti --scene street --scans 40 --seed 1 --out sim
  mosbench run sim --out results/runs/sim
  mosbench score sim --predictions results/runs/sim --protocol semantickitti-mos
  mosbench report results/runs/sim -o report.html
  mosbench render results/runs/sim --scan 20 -o scan.png
  mosbench list protocols

Exit codes: 0 done, 1 done and the finding is bad (a regression, a warning), 2 wrong usage or
configuration, 3 unusable files or too little memory or threads, 70 a fault of mosbench itself.
`mosbench help COMMAND` shows the flags of a command with examples.)";

/// Otherwise `run DATA --out --json` would write into a folder "--json".
void refuse_flags_as_values(CLI::App& command) {
  const auto complaint = [](const std::string& value) {
    return value.starts_with("--") ? value + " is a flag, expected a value" : std::string();
  };
  for (CLI::Option* option : command.get_options()) {
    if (option->nonpositional() && option->get_items_expected_max() > 0) option->check(complaint);
  }
}

/// Words of old that mean --as; those that take no value name the format.
struct OldWord {
  std::string_view command, flag, format;
};
constexpr OldWord kOldWords[] = {
    {"rank", "--format", ""},           {"reproduce", "--format", ""}, {"table", "--format", ""},
    {"curve", "--format", ""},          {"study", "--format", ""},     {"stats", "--csv", "csv"},
    {"compare", "--output-format", ""}, {"trajectory", "--csv", "csv"}};

/// Adds --as, --json and the words of old to a command. `format` gets the name.
void add_format_flags(CLI::App& command, const Command& row, std::string& format) {
  std::vector<std::string> names(format_names().begin(), format_names().end());
  if (!row.draws) std::erase(names, "png");
  const CLI::IsMember known(names);
  CLI::Option* as = command.add_option("--as", format, "How to print the answer")->check(known);
  CLI::Option* json = command.get_option_no_throw("--json");  // that of profile names a file
  if (json == nullptr) {
    const auto choose = [&format] { format = "json"; };
    json = command.add_flag_callback("--json", choose, "As --as json")->excludes(as);
  }
  for (const OldWord& old : kOldWords) {
    if (old.command != row.name || command.get_option_no_throw(std::string(old.flag)) != nullptr) {
      continue;
    }
    CLI::Option* option = old.format.empty()
                              ? command.add_option(std::string(old.flag), format)->check(known)
                              : command.add_flag_callback(std::string(old.flag),
                                                          [&format, &old] { format = old.format; });
    option->group("")->excludes(as)->excludes(json);
  }
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
    app.formatter(std::make_shared<HelpText>());
    app.set_version_flag("-V,--version",
                         fmt::format("mosbench {} ({})", kMosbenchVersion, kCompiler),
                         "Print version and compiler, and exit");
    app.set_help_flag("-h,--help", "Print this help, and exit");
    app.footer(kProgramFooter);
    app.require_subcommand(1);
    for (const Command& row : commands()) {
      CLI::App* command = app.add_subcommand(std::string(row.name), std::string(row.help));
      command->group("Commands");
      if (!row.alias.empty()) command->alias(std::string(row.alias));
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
  const Format format = asked.empty() ? answer.usual : format_named(asked);
  Printed result{"", answer.exit_code, format == Format::kText || format == Format::kGithub};
  if (answer.file && !names_stdout(*answer.file)) {
    write_output(*answer.file, render(answer, format));
    result.bytes = fmt::format("wrote {}", answer.file->string());
    if (answer.standing) {
      for (const std::string& doubt : answer.standing->doubts) result.bytes += "; " + doubt;
    }
    result.bytes += '\n';
    return result;
  }
  result.bytes = render(answer, format, columns);
  // Names in it may come from files of strangers.
  if (format != Format::kPng) result.bytes = shown(result.bytes);
  if (!answer.goes_beside_stdout) return result;
  std::fputs(result.bytes.c_str(), stderr);
  result.bytes.clear();
  return result;
}

}  // namespace

Printed answer_to(std::vector<std::string> arguments, std::size_t columns) {
  refuse_unknown_command(arguments);
  Program program;
  const std::vector<std::string> typed = arguments;
  const auto chosen = [&] {
    const auto commands = program.app.get_subcommands();
    return commands.empty() ? &program.app : commands.front();
  };
  try {
    std::ranges::reverse(arguments);  // as CLI11 expects them
    program.app.parse(std::move(arguments));
  } catch (const CLI::CallForVersion& version) {
    return {std::string(version.what()) + '\n', 0, true};
  } catch (const CLI::CallForHelp&) {
    return {help_of(*chosen()), 0, true};
  } catch (const CLI::ParseError& error) {
    const std::string name = full_name(*chosen());
    refuse_unknown_arguments(*chosen(), name);
    throw UsageError(fmt::format("{}; see {} --help", error.what(), name));
  }
  try {
    return printed(program.runs.at(chosen())(), program.format, columns);
  } catch (const MissingPoses& error) {
    const std::string commands = commands_with_odometry(*chosen(), typed);
    throw DataError(error.what() + (commands.empty() ? "" : ":" + commands));
  }
}

}  // namespace mosbench
