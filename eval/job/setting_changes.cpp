#include "eval/job/setting_changes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/result/settings_json.hpp"

namespace mosbench {
namespace {

constexpr std::string_view kDelay = "delay=", kAll = "all", kAllWithin = "all:";
constexpr double kUsualWindow_s = 60;

}  // namespace

void ChangeReader::read_file(const std::filesystem::path& file) {
  for (const std::string& name : apply_settings_file(file, settings_)) keep(name);
}

void ChangeReader::read_assignment(const std::string& assignment) {
  const bool is_word = settings_.find("delay") == nullptr &&
                       settings_.find(common_settings::kDelay_scans) != nullptr;
  if (is_word && assignment.starts_with(kDelay)) {
    return read_delay(std::string_view(assignment).substr(kDelay.size()));
  }
  apply_setting_assignment(assignment, settings_);
  keep(assignment.substr(0, assignment.find('=')));
}

void ChangeReader::read_delay(std::string_view text) {
  const bool has_tracks = settings_.find(common_settings::kTrackWindow_s) != nullptr;
  const auto scans = parse_double(text);
  if (scans && *scans == std::trunc(*scans)) {
    if (has_tracks) set(common_settings::kTrackWindow_s, 0.0);
    apply_setting_assignment(fmt::format("{}={}", common_settings::kDelay_scans, text), settings_);
    return keep(common_settings::kDelay_scans);
  }
  const auto window_s = text.starts_with(kAllWithin) ? parse_double(text.substr(kAllWithin.size()))
                                                     : std::optional(kUsualWindow_s);
  if (!text.starts_with(kAll) || (text.size() > kAll.size() && !text.starts_with(kAllWithin)) ||
      !window_s || !(*window_s >= 1)) {
    throw UsageError(fmt::format(
        "--set delay={}: is no delay, expected a number of scans, all, or all:SECONDS with 1 to "
        "3600 s",
        text));
  }
  if (!has_tracks) {
    throw UsageError(fmt::format(
        "--set delay={}: method {} does not judge whole tracks, expected a number of scans, or "
        "hmm-mos or hmm-mos-plus",
        text, method_.name));
  }
  set(common_settings::kDelay_scans, 0);
  set(common_settings::kTrackWindow_s, *window_s);
}

void ChangeReader::read_word(std::string_view name, const std::string& text) {
  const auto word_of = [&](const MethodKind& kind) {
    const auto found = std::ranges::find(kind.words, name, &SettingWord::name);
    return found == kind.words.end() ? nullptr : &*found;
  };
  const MethodKind& owner =
      word_of(method_) != nullptr ? method_ : *std::ranges::find_if(methods(), word_of);
  const SettingWord& word = *word_of(owner);
  if (text == word.usual) return;
  const std::string with_number = fmt::format("{}:", word.value);
  const bool has_number =
      text.starts_with(with_number) && parse_double(text.substr(with_number.size())).has_value();
  if (text != word.value && !has_number) {
    throw UsageError(fmt::format("{}: '{}' is not known, expected {}, {} or {}{}", name, text,
                                 word.usual, word.value, with_number, word.number));
  }
  if (&owner != &method_) {
    throw UsageError(fmt::format("{}={}: method {} {}, expected {}", name, text, method_.name,
                                 word.lacking, owner.name));
  }
  for (const std::string_view taking : word.takes) {
    const std::string number =
        has_number ? text.substr(with_number.size()) : to_string(settings_.find(taking)->highest);
    read_assignment(fmt::format("{}={}", taking, number));
  }
  for (const PresetValue& given : word.sets) {
    set(given.setting, given.value);
  }
}

void ChangeReader::set(std::string_view name, const SettingValue& value) {
  try {
    settings_.set(name, value);
  } catch (const std::invalid_argument& error) {
    throw UsageError(fmt::format("--set: {}", error.what()));
  }
  keep(name);
}

void ChangeReader::keep(std::string_view name) {
  changes_.push_back({std::string(name), settings_.find(name)->value});
}

}  // namespace mosbench
