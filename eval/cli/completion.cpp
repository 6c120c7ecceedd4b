#include "eval/cli/completion.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <functional>
#include <mosbench/method.hpp>
#include <sstream>
#include <string_view>
#include <vector>

#include "datasets/layouts/layout.hpp"
#include "datasets/simulator/scene.hpp"
#include "eval/cli/commands.hpp"
#include "eval/job/method_choice.hpp"
#include "eval/predictions/predictions.hpp"
#include "eval/protocols/protocol.hpp"

namespace mosbench {
namespace {

constexpr const char* kBash =
    R"(# Completes commands, flags and their values. Made by `mosbench help --completion bash`.
_mosbench() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} words=
  if [ "$COMP_CWORD" = 1 ]; then
    words='{} --help --version'
  else
    case "${{COMP_WORDS[1]}} ${{COMP_WORDS[COMP_CWORD - 1]}}" in
{}      *) case "${{COMP_WORDS[1]}}" in
{}      esac ;;
    esac
  fi
  # shellcheck disable=SC2207  # words hold no spaces
  COMPREPLY=($(compgen -W "$words" -- "$word"))
}}
complete -o default -F _mosbench mosbench
)";

constexpr const char* kZsh = R"(#compdef mosbench
# Completes commands, flags and their values. Made by `mosbench help --completion zsh`.
_mosbench() {{
  local -a commands=(
{}  )
  if (( CURRENT == 2 )); then
    _describe command commands
    return
  fi
  shift words
  (( CURRENT-- ))
  case $words[1] in
{}  esac
}}
_mosbench "$@"
)";

template <typename List, typename Name>
std::vector<std::string> names_of(const List& list, Name name) {
  std::vector<std::string> names;
  for (const auto& row : list) names.emplace_back(std::invoke(name, row));
  return names;
}

/// Returns the words that the value of an option can be; none where it is free.
std::vector<std::string> words_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  if (type == "METHOD") return names_of(methods(), &MethodKind::name);
  if (type == "PRESET") return names_of(presets(), &Preset::name);
  if (type == "PROTOCOL") return names_of(protocols(), &Protocol::name);
  if (type == "FORMAT") return names_of(prediction_formats(), &DescribedFormat::name);
  if (type == "SCENE") return names_of(built_in_scenes(), &SceneSummary::name);
  if (type == "DATASET") {
    return names_of(layouts(), [](const Layout* row) { return row->name; });
  }
  std::vector<std::string> words;
  const std::size_t brace = type.find('{');
  if (brace == std::string::npos) return words;
  std::istringstream list(type.substr(brace + 1, type.find('}') - brace - 1));
  for (std::string word; std::getline(list, word, ',');) words.push_back(word);
  return words;
}

bool is_flag(const CLI::Option& option) { return option.get_items_expected_max() == 0; }

/// Returns the flags of a command as typed: {"-o", "--out"}; none of a positional argument.
std::vector<std::string> flags_of(const CLI::Option& option) {
  std::vector<std::string> flags;
  for (const std::string& name : option.get_snames()) flags.push_back('-' + name);
  for (const std::string& name : option.get_lnames()) flags.push_back("--" + name);
  return flags;
}

std::string bash_completion(const CLI::App& program) {
  std::string values, flags;
  std::vector<std::string_view> names;
  for (const Command& row : commands()) {
    std::vector<std::string> words;
    for (const CLI::Option* option : program.get_subcommand(std::string(row.name))->get_options()) {
      const std::vector<std::string> possible = words_of(*option);
      for (const std::string& flag : flags_of(*option)) {
        words.push_back(flag);
        if (is_flag(*option)) continue;
        values +=
            fmt::format("      '{} {}') words='{}' ;;\n", row.name, flag, fmt::join(possible, " "));
      }
      if (option->get_positional()) words.insert(words.begin(), possible.begin(), possible.end());
    }
    flags += fmt::format("        {}) words='{}' ;;\n", row.name, fmt::join(words, " "));
    names.push_back(row.name);
  }
  return fmt::format(kBash, fmt::join(names, " "), values, flags);
}

/// Leaves out what would end a description within quotes and brackets.
std::string plain(std::string text) {
  std::erase_if(text, [](char c) { return c == '\'' || c == '[' || c == ']' || c == ':'; });
  return text;
}

std::string zsh_argument(const CLI::Option& option) {
  const std::vector<std::string> words = words_of(option);
  const std::string action = words.empty() ? "_files" : fmt::format("({})", fmt::join(words, " "));
  if (option.get_positional()) {
    const bool many = option.get_expected_max() > 1;
    return fmt::format(" \\\n        '{}:{}:{}'", many ? "*" : "", option.get_name(), action);
  }
  std::string arguments;
  for (const std::string& flag : flags_of(option)) {
    const std::string value = is_flag(option) ? "" : fmt::format(":value:{}", action);
    arguments +=
        fmt::format(" \\\n        '{}[{}]{}'", flag, plain(option.get_description()), value);
  }
  return arguments;
}

std::string zsh_completion(const CLI::App& program) {
  std::string names, cases;
  for (const Command& row : commands()) {
    names += fmt::format("    '{}:{}'\n", row.name, plain(std::string(row.help)));
    cases += fmt::format("    {})\n      _arguments", row.name);
    for (const CLI::Option* option : program.get_subcommand(std::string(row.name))->get_options()) {
      if (!option->get_group().empty()) cases += zsh_argument(*option);
    }
    cases += " ;;\n";
  }
  return fmt::format(kZsh, names, cases);
}

std::string command_names() {
  std::string names;
  for (const Command& row : commands()) names += fmt::format("{}\t{}\n", row.name, row.help);
  return names;
}

}  // namespace

std::string completion_of(const CLI::App& program, const std::string& shell) {
  if (shell == "bash") return bash_completion(program);
  return shell == "zsh" ? zsh_completion(program) : command_names();
}

}  // namespace mosbench
