#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

/// Lays out --help: wraps the texts of options at 100 columns and appends their defaults.
class HelpText : public CLI::Formatter {
 public:
  HelpText();
  std::string make_usage(const CLI::App* app, std::string name) const override;
  std::string make_option(const CLI::Option* option, bool is_positional) const override;
};

/// Returns the name of a type whose values are `names`, as CLI11 names those that it checks: help
/// and completion list them.
std::string type_of_names(const std::vector<std::string_view>& names);

/// Returns "mosbench", or "mosbench run" of the command run.
std::string full_name(const CLI::App& command);

std::string help_of(const CLI::App& command);

/// Throws UsageError naming the nearest command when there is none of this name.
void check_command_name(const std::string& name);

}  // namespace mosbench
