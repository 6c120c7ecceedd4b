#include <CLI/CLI.hpp>
#include <memory>

#include "eval/cli/commands.hpp"
#include "eval/cli/help_text.hpp"

namespace mosbench {
namespace {

constexpr const char* kHelpFooter = R"(Examples:
  mosbench help
  mosbench help run)";

}  // namespace

CommandRun add_help(CLI::App& command) {
  auto name = std::make_shared<std::string>();
  command.add_option("COMMAND", *name, "A command of mosbench (default: mosbench itself)");
  command.footer(kHelpFooter);
  return [name, &program = *command.get_parent()] {
    if (name->empty()) return Answer{help_of(program)};
    check_command_name(*name);
    return Answer{help_of(*program.get_subcommand(*name))};
  };
}

}  // namespace mosbench
