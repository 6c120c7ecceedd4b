#include "eval/cli/flags.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <mosbench/odometry.hpp>
#include <sstream>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/answer/render.hpp"
#include "eval/result/output.hpp"
#include "eval/result/reading_json.hpp"

namespace mosbench {
namespace {

std::string flag_of(std::string_view name) {
  std::string flag = "--" + std::string(name);
  std::ranges::replace(flag, '_', '-');
  return flag;
}

const ReadingField& field_named(std::string_view name) {
  return *std::ranges::find(reading_fields(), name, &ReadingField::name);
}

/// Takes "pose_frame=camera,bin_columns=5". Throws UsageError naming the key.
void take_read_keys(Reading& reading, const std::string& text) {
  std::vector<std::string_view> names;
  for (const ReadingField& field : reading_fields()) {
    if (field.is_rare) names.push_back(field.name);
  }
  for (const auto& [key, value] : key_values("--read", text)) {
    if (std::ranges::find(names, key) == names.end()) {
      throw UsageError(fmt::format("--read {}: is not known, expected one of {} (nearest: {})", key,
                                   fmt::join(names, ", "), nearest_name(key, names)));
    }
    try {
      set_field(reading, key, value);
    } catch (const UsageError&) {
      throw UsageError(fmt::format("--read {}: '{}' is not legal, expected {}", key, value,
                                   field_named(key).legal));
    }
  }
}

/// Adds a field of Reading as a flag that fills it.
CLI::Option* add_field(CLI::App& command, const ReadingField& field, Reading& reading) {
  if (field.is_switch()) {
    return command.add_flag_callback(
        flag_of(field.name), [&reading, &field] { set_field(reading, field.name, "on"); },
        field.meaning);
  }
  const auto take = [&reading, &field](const std::string& text) {
    set_field(reading, field.name, text);
  };
  CLI::Option* flag = add(command, flag_of(field.name), take, field.meaning);
  if (!field.type.empty()) flag->type_name(field.type);
  if (!field.choices.empty()) flag->check(CLI::IsMember(field.choices));
  return flag;
}

void add_reading_flags(CLI::App& command, Reading& reading) {
  for (const ReadingField& field : reading_fields()) {
    if (field.is_rare || field.name == "poses") continue;
    add_field(command, field, reading)->group(kReadingGroup);
  }
  command
      .add_option_function<std::vector<std::string>>(
          "--read",
          [&reading](const std::vector<std::string>& texts) {
            for (const std::string& text : texts) take_read_keys(reading, text);
          },
          "What is rarely to be said about the files; the keys stand below")
      ->type_name("KEY=VALUE,...")
      ->allow_extra_args(false)
      ->group(kReadingGroup);
}

bool looks_like_assignment(const std::string& argument) {
  const std::size_t equals = argument.find('=');
  if (equals == std::string::npos || equals == 0) return false;
  return std::ranges::all_of(argument.substr(0, equals), [](char c) {
    return std::strchr("_.-", c) || (c >= 'a' && c <= 'z');
  });
}

/// "@FILE", "moving=ever" or an assignment to one of the method's settings.
void take_setting(const std::string& text, JobWords& words) {
  constexpr std::string_view kMoving = "moving=";
  if (text.starts_with('@')) {
    if (words.config_file) {
      throw UsageError(fmt::format("--set {}: is a second file, expected one", text));
    }
    words.config_file = text.substr(1);
  } else if (text.starts_with(kMoving)) {
    words.moving = text.substr(kMoving.size());
  } else {
    words.assignments.push_back(text);
  }
}

void take_settings(const std::string& text, JobWords& words) {
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    take_setting(text.substr(begin, end - begin), words);
    begin = end + 1;
  }
}

// --set takes one argument; what follows it as in `--set a=1 b=2 DATA` goes to a positional option
// of its own, defined before DATA, that accepts assignments only.
void add_set_flag(CLI::App& command, JobWords& words) {
  CLI::Option* set = command.add_option_function<std::vector<std::string>>(
      "--set", [](const auto&) {},
      "Settings, which win over all others; @FILE holds a JSON object of them");
  set->type_name("KEY=VALUE,...")->allow_extra_args(false)->check([](const std::string& text) {
    return text.starts_with('@') || text.find('=') != std::string::npos
               ? ""
               : text + " has no value, expected key=value or @FILE";
  });
  CLI::Option* further = command.add_option_function<std::vector<std::string>>(
      "SETTING", [](const auto&) {}, "Further settings of --set");
  further->group("")->check([set](const std::string& text) {
    return set->count() > 0 && looks_like_assignment(text) ? "" : "is no setting";
  });
  command.validate_positionals();
  // Where a setting is given twice, the later one counts.
  command.final_callback([&command, &words, set, further] {
    std::size_t of_flag = 0, positional = 0;
    for (const CLI::Option* option : command.parse_order()) {
      if (option == set) take_settings(set->results().at(of_flag++), words);
      if (option == further) take_settings(further->results().at(positional++), words);
    }
  });
}

/// Takes a part of KIND[:PRESET][,KEY=VALUE,...].
void take_odometry(const std::string& part, OdometryOptions& odometry) {
  constexpr std::string_view kDropMoving = "drop_moving=";
  if (part.starts_with('@')) {
    odometry.config_file = part.substr(1);
  } else if (part.starts_with(kDropMoving)) {
    const std::string word = part.substr(kDropMoving.size());
    if (word != "on" && word != "off") {
      throw UsageError(fmt::format("--odometry {}: expected on or off", part));
    }
    odometry.drop_moving = word == "on";
  } else if (part.find('=') != std::string::npos) {
    odometry.assignments.push_back(part);
  } else if (!odometry.kind && !odometry.preset) {
    const std::size_t colon = part.find(':');
    if (colon > 0) odometry.kind = part.substr(0, colon);
    if (colon != std::string::npos) odometry.preset = part.substr(colon + 1);
  } else {
    throw UsageError(fmt::format("--odometry {}: has no value, expected key=value", part));
  }
}

}  // namespace

CLI::Validator number_in(double lowest, double highest) {
  const auto check = [=](const std::string& text) {
    const auto number = parse_double(text);
    if (number && *number >= lowest && *number <= highest) return std::string();
    return fmt::format("'{}' is not legal, expected a number from {:g} to {:g}", text, lowest,
                       highest);
  };
  return {check, fmt::format("FLOAT in [{:g} - {:g}]", lowest, highest)};
}

CLI::Option* add_list(CLI::App& command, const std::string& shown, std::vector<std::string>& target,
                      const std::string& meaning) {
  return add(command, shown, target, meaning)->delimiter(',')->allow_extra_args(false);
}

void add_dataset_flags(CLI::App& command, DataWords& words, const char* name) {
  add_scan_dataset_flags(command, words, name);
  add_field(command, field_named("poses"), words.reading);
}

void add_scan_dataset_flags(CLI::App& command, DataWords& words, const char* name) {
  add(command, fmt::format("{} DIR", name), words.input,
      std::string_view(name) == "RUN"
          ? "Folder that `mosbench run` or `mosbench score` wrote, or a result.json"
          : "Root of a data set, one sequence folder, a bag, a scan, or a folder of them")
      ->required();
  add_dataset_kind_flag(command, words.dataset);
  add_list(command, "--sequences NAMES", words.sequences,
           "Only these sequences, a,b (default: all)");
  add_reading_flags(command, words.reading);
}

CLI::Option* add_dataset_kind_flag(CLI::App& command, std::string& dataset) {
  return add(command, "--dataset DATASET", dataset, "Layout of DATA, see `mosbench list datasets`")
      ->capture_default_str();
}

void add_method_flags(CLI::App& command, JobWords& words, unsigned& threads) {
  add_set_flag(command, words);
  add_dataset_flags(command, words);
  add(command, "--method METHOD", words.method,
      "Method that segments, see `mosbench list methods`; for run also A,B or all "
      "(default: hmm-mos)");
  add(command, "--preset PRESET", words.preset,
      "Published settings, or `best` (default: by data set)");
  add_threads_flag(command, threads);
}

void add_odometry_flag(CLI::App& command, OdometryOptions& odometry,
                       const std::string& description) {
  std::vector<std::string_view> kinds;
  for (const OdometryKind& kind : odometries()) kinds.push_back(kind.name);
  const auto take = [&odometry](const std::string& text) {
    std::istringstream parts(text);
    for (std::string part; std::getline(parts, part, ',');) take_odometry(part, odometry);
  };
  add(command, "--odometry " + type_of_names(kinds), take,
      description + ": KIND[:PRESET][,KEY=VALUE,...], see `mosbench list odometry`");
}

void add_stale_flag(CLI::App& command, bool& allow_stale) {
  command.add_flag(
      "--allow-stale", allow_stale,
      "Also show results whose program (--method exec:) has changed since; marks them");
}

void add_threads_flag(CLI::App& command, unsigned& threads) {
  add(command, "--threads", threads, "Threads; results do not depend on it (default: all)")
      ->check(CLI::Range(1U, 1024U));
}

std::string type_of_names(const std::vector<std::string_view>& names) {
  return fmt::format("NAME:{{{}}}", fmt::join(names, ","));
}

std::vector<std::pair<std::string, std::string>> key_values(std::string_view flag,
                                                            const std::string& text) {
  std::vector<std::pair<std::string, std::string>> pairs;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const std::size_t equals = part.find('=');
    if (equals == std::string::npos && !pairs.empty() && pairs.back().first == "lidars") {
      pairs.back().second += ',' + part;
      continue;
    }
    if (equals == std::string::npos || equals == 0) {
      throw UsageError(fmt::format("{}: '{}' has no value, expected key=value", flag, part));
    }
    pairs.emplace_back(part.substr(0, equals), part.substr(equals + 1));
  }
  return pairs;
}

std::string flag_words(std::string_view name, std::string_view value) {
  const auto field = std::ranges::find(reading_fields(), name, &ReadingField::name);
  if (field != reading_fields().end() && field->is_rare) {
    return fmt::format("--read {}{}{}", name, value.empty() ? "" : "=", value);
  }
  return flag_of(name) + (value.empty() ? "" : " ") + std::string(value);
}

std::string given_words(const CLI::App& command,
                        const std::function<bool(const CLI::Option&)>& wanted) {
  std::string words;
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() == 0 || !wanted(*option)) continue;
    if (option->nonpositional()) words += ' ' + option->get_name();
    if (option->get_items_expected_max() == 0) continue;
    words += ' ' + shell_word(fmt::format("{}", fmt::join(option->results(), ",")));
  }
  return words;
}

void check_answer_file(const CLI::App& command, const std::filesystem::path& file) {
  Format format = format_of_name(file).value_or(Format::kText);
  if (command.count("--as") > 0) format = format_named(command["--as"]->results().front());
  if (command.count("--json") > 0) format = Format::kJson;
  check_output(file, format);
}

Reading reading_of(std::vector<std::string> flags) {
  Reading reading;
  CLI::App command;
  add_reading_flags(command, reading);
  add_field(command, field_named("poses"), reading);
  std::ranges::reverse(flags);  // as CLI11 expects them
  try {
    command.parse(std::move(flags));
  } catch (const CLI::ParseError& error) {
    throw UsageError(error.what());
  }
  return reading;
}

}  // namespace mosbench
