#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <sstream>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/flags.hpp"
#include "eval/result/reading_json.hpp"

namespace mosbench {
namespace {

constexpr std::size_t kColumns = 100;

// A longer list of words stands in the description, which is wrapped.
constexpr std::size_t kLongestWords = 60;

/// Returns "{kitti,tum}", or nothing where any value may follow a flag, or several words may.
std::string listed_words(const CLI::Option& option) {
  if (option.get_delimiter() != '\0') return "";
  const std::string type = option.get_type_name();
  const std::size_t brace = type.find(":{");
  return brace == std::string::npos ? "" : type.substr(brace + 1);
}

/// Returns "FILE", "N" or "{kitti,tum}": what follows a flag.
std::string value_name(const CLI::Option& option) {
  const std::string words = listed_words(option);
  if (words.size() > kLongestWords) return "NAME";
  if (!words.empty()) return words;
  const std::string type = option.get_type_name();
  const std::string name = type.substr(0, type.find(':'));
  return name == "UINT" || name == "INT" || name == "FLOAT" ? "N" : name;
}

/// Breaks a text between words so that it ends before the last column; all but its first line are
/// indented.
std::string wrapped(const std::string& text, std::size_t indent) {
  std::istringstream words(text);
  std::string lines, word;
  for (std::size_t column = indent; words >> word; column += word.size() + 1) {
    if (column > indent && column + word.size() > kColumns) {
      lines += '\n' + std::string(indent, ' ');
      column = indent;
    } else if (column > indent) {
      lines += ' ';
    }
    lines += word;
  }
  return lines;
}

/// Puts a blank after each comma.
std::string spaced(const std::string& list) {
  std::string text;
  for (const char c : list) text += c == ',' ? ", " : std::string(1, c);
  return text;
}

std::string description_of(const CLI::Option& option, bool is_positional) {
  std::string text = option.get_description();
  if (const std::string words = listed_words(option); words.size() > kLongestWords) {
    text += ": " + spaced(words.substr(1, words.size() - 2));
  }
  if (!option.get_default_str().empty()) text += " (default: " + option.get_default_str() + ")";
  if (option.get_required() && !is_positional) text += " (required)";
  return text;
}

std::string help_row(const std::string& name, const std::string& meaning) {
  constexpr std::size_t kIndent = 30;
  std::string left = "  " + name;
  left += left.size() + 2 <= kIndent ? std::string(kIndent - left.size(), ' ')
                                     : '\n' + std::string(kIndent, ' ');
  return left + wrapped(meaning, kIndent) + '\n';
}

/// The keys of --read with their values and meanings.
std::string read_keys_text() {
  std::string text = "Keys of --read:\n";
  for (const ReadingField& field : reading_fields()) {
    if (!field.is_rare) continue;
    std::string meaning = field.meaning;
    meaning[0] = static_cast<char>(std::tolower(meaning[0]));
    if (!field.usual.empty()) meaning += fmt::format(" (default: {})", field.usual);
    text += help_row(field.name, fmt::format("{}; {}", field.legal, meaning));
  }
  return text;
}

/// Lays out --help-all where `all`, else --help, which fits a screen.
class HelpText : public CLI::Formatter {
 public:
  explicit HelpText(bool all) : all_(all) { label("Positionals", "Arguments"); }

  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override {
    return make_description(app) + make_usage(app, std::move(name)) + make_positionals(app) +
           groups_of(*app) + make_subcommands(app, mode) + '\n' + page_of(*app);
  }

  std::string make_usage(const CLI::App* app, std::string name) const override {
    std::string usage = "\nUsage: " + name + (app->get_parent() == nullptr ? " COMMAND" : "");
    for (const CLI::Option* option : app->get_options()) {
      if (option->get_positional() && !option->get_group().empty()) {
        usage += ' ' + make_option_usage(option);
      }
    }
    return usage + " [OPTIONS]\n";
  }

  std::string make_option(const CLI::Option* option, bool is_positional) const override {
    std::string name = spaced(make_option_name(option, is_positional));
    if (!is_positional && option->get_items_expected_max() > 0) name += ' ' + value_name(*option);
    return help_row(name, description_of(*option, is_positional));
  }

 private:
  std::string groups_of(const CLI::App& command) const {
    std::string text;
    for (const std::string& group : command.get_groups()) {
      if (group.empty() || (!all_ && (group == kRareGroup || group == kReadingGroup))) continue;
      const auto options = command.get_options([&](const CLI::Option* option) {
        return option->get_group() == group && option->nonpositional();
      });
      if (!options.empty()) text += make_group(group, false, options);
    }
    const bool reads = command.get_option_no_throw("--deskew") != nullptr;
    return all_ && reads ? text + '\n' + read_keys_text() : text;
  }

  std::string page_of(const CLI::App& command) const {
    const std::string_view page = help_page(command.get_name());
    constexpr std::string_view kRest = "---\n";
    const std::size_t rest = std::min(page.find(kRest), page.size());
    std::string text(page.substr(0, rest));
    if (all_ && rest < page.size()) text += '\n' + std::string(page.substr(rest + kRest.size()));
    return text;
  }

  bool all_;
};

}  // namespace

std::string full_name(const CLI::App& command) {
  const CLI::App* parent = command.get_parent();
  return parent == nullptr ? command.get_name() : parent->get_name() + ' ' + command.get_name();
}

std::string help_of(const CLI::App& command, bool all) {
  // App::help would show the help of the chosen command instead.
  return HelpText(all).make_help(&command, full_name(command), CLI::AppFormatMode::Normal);
}

void check_command_name(const std::string& name) {
  std::vector<std::string_view> names;
  for (const Command& command : commands()) {
    if (name == command.name) return;
    names.push_back(command.name);
  }
  throw UsageError(fmt::format("'{}' is not a command (nearest: {}); see mosbench --help", name,
                               nearest_name(name, names)));
}

}  // namespace mosbench
