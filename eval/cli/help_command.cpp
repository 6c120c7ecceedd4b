#include <CLI/CLI.hpp>
#include <memory>

#include "eval/cli/commands.hpp"
#include "eval/cli/completion.hpp"

namespace mosbench {
namespace {

struct HelpFlags {
  std::string command, shell;
};

}  // namespace

CommandRun add_help(CLI::App& command) {
  auto flags = std::make_shared<HelpFlags>();
  command.add_option("COMMAND", flags->command, "A command of mosbench (default: mosbench itself)");
  command
      .add_option("--completion", flags->shell,
                  "Print what completes words in this shell; or a table of the commands")
      ->check(CLI::IsMember({"bash", "zsh", "commands"}));
  return [flags, &program = *command.get_parent()] {
    if (!flags->shell.empty()) return Answer{completion_of(program, flags->shell)};
    if (flags->command.empty()) return Answer{help_of(program)};
    check_command_name(flags->command);
    return Answer{help_of(*program.get_subcommand(flags->command))};
  };
}

}  // namespace mosbench
