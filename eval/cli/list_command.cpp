#include <CLI/CLI.hpp>
#include <memory>

#include "eval/cli/commands.hpp"
#include "eval/cli/flags.hpp"
#include "eval/tables/list_print.hpp"

namespace mosbench {

CommandRun add_list(CLI::App& command) {
  struct Listed {
    std::string what = "all", name;
  };
  auto listed = std::make_shared<Listed>();
  add(command, "WHAT", listed->what,
      "datasets, methods, odometry, presets, protocols, scenes, formats, perturbations or all")
      ->capture_default_str()
      ->check(CLI::IsMember(list_names()));
  add(command, "NAME", listed->name, "One of the methods");
  return [listed] { return list_answer(listed->what, listed->name); };
}

}  // namespace mosbench
