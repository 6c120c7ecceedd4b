#include "eval/result/reading_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include "datasets/perturb/perturbation.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

template <typename Field>
struct Held {
  using Value = Field;
};
template <typename Optional>
struct Held<std::optional<Optional>> {
  using Value = Optional;
};

/// The value of this type that a text stands for. Throws UsageError without the field's name.
template <typename Value, typename Legal>
Value parsed(std::string_view text, const Legal& legal) {
  if constexpr (std::is_enum_v<Value>) {
    const auto found = std::ranges::find(legal, text);
    if (found != legal.end()) return static_cast<Value>(found - legal.begin());
    throw UsageError(
        fmt::format("'{}' is not known, expected one of {}", text, fmt::join(legal, ", ")));
  } else if constexpr (std::is_same_v<Value, double>) {
    const auto number = parse_double(text);
    if (number && *number <= legal.highest &&
        (*number > legal.lowest || (*number == legal.lowest && legal.lowest_is_legal))) {
      return *number;
    }
    throw UsageError(fmt::format("{} is no {}, expected {}", text, legal.noun, legal.expected));
  } else if constexpr (std::is_same_v<Value, std::size_t>) {
    const auto number = parse_unsigned(text);
    if (number && *number >= legal.lowest && *number <= legal.highest) return *number;
    throw UsageError(fmt::format("{}, expected {} to {}", text, legal.lowest, legal.highest));
  } else if constexpr (std::is_same_v<Value, bool>) {
    if (text == "on" || text == "true") return true;
    if (text == "off" || text == "false") return false;
    throw UsageError(fmt::format("'{}' is not understood, expected on or off", text));
  } else if constexpr (std::is_same_v<Value, ScanRange>) {
    return parse_scan_range(text);
  } else if constexpr (std::is_same_v<Value, PosesFrom>) {
    if (text == kStaticPoses) return StaticPoses{};
    return PoseFile{text};
  } else {
    if (text.empty()) throw UsageError("is empty, expected a name");
    return Value(text);
  }
}

template <typename Value, typename Legal>
ordered_json member_of(const Value& value, const Legal& legal) {
  if constexpr (std::is_enum_v<Value>) {
    return std::string(legal[static_cast<std::size_t>(value)]);
  } else if constexpr (std::is_same_v<Value, Perturbation> || std::is_same_v<Value, ScanRange>) {
    return to_string(value);
  } else if constexpr (std::is_same_v<Value, PosesFrom>) {
    if (std::holds_alternative<StaticPoses>(value)) return std::string(kStaticPoses);
    const auto* file = std::get_if<PoseFile>(&value);
    return file == nullptr ? ordered_json() : ordered_json(file->path.string());
  } else {
    return value;
  }
}

/// A member per field that has a value, also one that nobody told.
ordered_json members_of(const Reading& reading) {
  ordered_json json = ordered_json::object();
  visit_fields(reading, [&](const char* name, const auto& field, const auto& legal, const char*) {
    if constexpr (requires { field.has_value(); }) {
      if (field) json[name] = member_of(*field, legal);
    } else {
      json[name] = member_of(field, legal);
    }
  });
  return json;
}

ordered_json told_members(const Reading& reading) {
  ordered_json json = members_of(reading);
  const ordered_json unset = members_of({});  // outlives the loop over its items
  for (const auto& [name, usual] : unset.items()) {
    if (json[name] == usual) json.erase(name);
  }
  return json;
}

/// Says in words which texts are legal: "lidar or camera", "3 to 7".
template <typename Legal>
void describe(const Legal& legal, ReadingField& field) {
  if constexpr (requires { legal.type; }) field.type = legal.type;
  if constexpr (requires { legal.begin(); }) {
    field.choices.assign(legal.begin(), legal.end());
    field.legal =
        fmt::format("{} or {}", fmt::join(legal.begin(), legal.end() - 1, ", "), legal.back());
  } else if constexpr (std::is_same_v<Legal, FieldCount>) {
    field.legal = fmt::format("{} to {}", legal.lowest, legal.highest);
  } else if constexpr (std::is_same_v<Legal, FieldQuantity>) {
    field.legal = std::isfinite(legal.highest)
                      ? fmt::format("{} to {}", legal.lowest, legal.highest)
                  : legal.lowest_is_legal ? fmt::format("{} or more", legal.lowest)
                                          : fmt::format("above {}", legal.lowest);
  } else {
    field.legal = field.type.empty() ? "on or off" : fmt::format("a {}", lower_case(field.type));
  }
}

}  // namespace

const std::vector<ReadingField>& reading_fields() {
  static const std::vector<ReadingField> fields = [] {
    std::vector<ReadingField> list;
    constexpr std::array<std::string_view, 7> kFlags = {
        "scans", "poses", "refine_poses", "topic", "deskew", "point_times", "perturb"};
    const auto add = [&](const char* name, const auto& value, const auto& legal,
                         const char* meaning) {
      using Field = std::decay_t<decltype(value)>;
      ReadingField& field = list.emplace_back();
      field.name = name;
      field.meaning = meaning;
      field.is_rare = std::ranges::find(kFlags, field.name) == kFlags.end();
      field.is_number =
          std::is_arithmetic_v<typename Held<Field>::Value> && !std::is_same_v<Field, bool>;
      if constexpr (std::is_same_v<Field, double>) field.usual = fmt::format("{}", value);
      describe(legal, field);
    };
    const Reading usual;
    visit_fields(usual, add);
    return list;
  }();
  return fields;
}

void set_field(Reading& reading, std::string_view name, std::string_view text) {
  visit_fields(reading, [&](std::string_view known, auto& field, const auto& legal, const char*) {
    using Value = typename Held<std::decay_t<decltype(field)>>::Value;
    if (known != name) return;
    if constexpr (std::is_same_v<Value, Perturbation>) {
      field = parse_perturbation(text);
    } else {
      try {
        field = parsed<Value>(text, legal);
      } catch (const UsageError& error) {
        throw UsageError(fmt::format("{}: {}", option(name), error.what()));
      }
    }
  });
}

ordered_json told_json(const Reading& reading) {
  ordered_json json = told_members(reading);
  if (const auto* file = reading.pose_file()) {
    json["poses"] = std::filesystem::absolute(*file).string();
  }
  if (reading.is_by_odometry()) json["odometry"] = true;
  return json;
}

Reading told_from_json(const ordered_json& json) {
  Reading reading;
  if (json.value("raw_scans", false)) reading.deskew = Deskew::kNone;  // of earlier results
  for (const ReadingField& field : reading_fields()) {
    if (!json.contains(field.name)) continue;
    const ordered_json& value = json.at(field.name);
    if (field.is_number != value.is_number()) {
      throw UsageError(fmt::format("{}: {}, expected {}", option(field.name), value.dump(),
                                   field.is_number ? "a number" : "a text"));
    }
    set_field(reading, field.name, value.is_string() ? value.get<std::string>() : value.dump());
  }
  if (json.value("odometry", false)) reading.poses = ByOdometry{};
  return reading;
}

std::string told_flags(const Reading& reading) {
  const ordered_json told = told_members(reading);
  std::string flags, rare;
  for (const ReadingField& field : reading_fields()) {
    if (!told.contains(field.name)) continue;
    const ordered_json& value = told[field.name];
    const std::string word = value.is_string() ? value.get<std::string>() : value.dump();
    if (field.is_rare) {
      rare +=
          fmt::format("{}{}={}", rare.empty() ? "" : ",", field.name, word == "true" ? "on" : word);
      continue;
    }
    std::string flag = field.name;
    std::ranges::replace(flag, '_', '-');
    flags += fmt::format(" --{}", flag);
    if (!field.is_switch()) flags += ' ' + shell_word(word);
  }
  return rare.empty() ? flags : fmt::format("{} --read {}", flags, shell_word(rare));
}

ordered_json to_json(const ReadingMembers& reading) {
  ordered_json json = ordered_json::object();
  for (const auto& [what, how] : reading) json[what] = how;
  return json;
}

}  // namespace mosbench
