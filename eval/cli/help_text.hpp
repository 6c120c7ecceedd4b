#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

/// Group of flags that few people need; like those of the group Reading they stand in --help-all.
inline constexpr const char* kRareGroup = "Rarely needed";

/// Returns docs/help/<name>.txt as it was when the program was built: what --help shows of a
/// command behind its flags and, below a line "---", what only --help-all shows.
std::string_view help_page(std::string_view name);

/// Lays out help: wraps the texts of options at 100 columns and appends their defaults.
class HelpText : public CLI::Formatter {
 public:
  /// Lays out --help-all where `all`, else --help, which fits a screen.
  explicit HelpText(bool all);
  std::string make_usage(const CLI::App* app, std::string name) const override;
  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override;
  std::string make_option(const CLI::Option* option, bool is_positional) const override;

 private:
  std::string flags_of(const CLI::App& command) const;
  std::string page_of(const CLI::App& command) const;

  bool all_;
};

/// Returns the name of a type whose values are `names`, as CLI11 names those that it checks: help
/// and completion list them.
std::string type_of_names(const std::vector<std::string_view>& names);

/// Returns "mosbench", or "mosbench run" of the command run.
std::string full_name(const CLI::App& command);

/// Returns --help of a command or of the program, or --help-all.
std::string help_of(const CLI::App& command, bool all = false);

/// Returns a line of a list in a help: a name, and its meaning wrapped beside it.
std::string help_row(const std::string& name, const std::string& meaning);

/// Throws UsageError naming the nearest command when there is none of this name.
void check_command_name(const std::string& name);

}  // namespace mosbench
