#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/sequence/reading.hpp"

namespace mosbench {

/// A field of Reading, as those see it who give its value as text.
struct ReadingField {
  std::string name;  ///< "pose_frame"
  std::string type;  ///< "FILE"; empty for choices and switches
  std::string meaning;
  std::vector<std::string> choices;  ///< the legal texts, where they are few
  std::string legal;                 ///< the same in words: "lidar or camera", "0 or more"
  std::string usual;                 ///< what holds where nothing is said; mostly empty
  bool is_number = false;
  bool is_rare = false;  ///< a key of --read, without a flag of its own

  /// Whether it is on or off, so that its flag takes no value.
  bool is_switch() const { return type.empty() && choices.empty() && !is_number; }
};
const std::vector<ReadingField>& reading_fields();

/// Sets the field of this name to what the text says. Throws UsageError that begins with the name.
void set_field(Reading& reading, std::string_view name, std::string_view text);

/// The reading options that were given, named like the fields. A
/// pose file's path is absolute; poses that odometry finds are the member "odometry".
nlohmann::ordered_json told_json(const Reading& reading);
/// Reads what `told_json` wrote, passing over other members. Throws UsageError for values that are
/// not legal.
Reading told_from_json(const nlohmann::ordered_json& json);

/// The same as flags for a shell, each with a blank in front; a pose file's path is as given.
std::string told_flags(const Reading& reading);

/// How a sequence was read, a member per statement.
nlohmann::ordered_json to_json(const ReadingMembers& reading);

}  // namespace mosbench
