#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

/// A flag of an earlier release. It becomes a part of the value of a flag of today.
struct OldFlag {
  std::string_view commands;  ///< that had it, with blanks between
  std::string_view flag;
  bool has_value = true;
  std::string_view now;          ///< the flag of today; empty: none is needed
  std::string_view part = "{}";  ///< "{}" is the old value
  std::string_view joint = ",";  ///< between the value of `now` and the part
  std::string_view head = {};    ///< value of `now` where the line has none
  bool in_front = false;         ///< of the value of `now`, not behind it
};

/// A command of an earlier release.
struct OldCommand {
  std::string_view name;  ///< one or two words
  /// The words of today: "{0}" is the first argument without a dash, "{}" are all others, "{,}"
  /// with commas between.
  std::string_view now;
  std::size_t arguments = 0;  ///< how many make it an old line; 0: any number
};

/// They do their work for one release; help, completion and manual leave them out.
std::span<const OldFlag> old_flags();
std::span<const OldCommand> old_commands();

/// Tells whether a flag of a command of today takes a value; nothing for what is no flag of it.
using TakesValue =
    std::function<std::optional<bool>(const std::string& command, const std::string& flag)>;

/// Returns the line of today for a line with old words; any other line as it is.
std::vector<std::string> in_new_words(std::vector<std::string> words,
                                      const TakesValue& takes_value);

}  // namespace mosbench
