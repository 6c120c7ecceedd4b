#include <algorithm>
#include <iomanip>
#include <mosbench/settings.hpp>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace mosbench {
namespace {

std::string text_of(double number) {
  std::ostringstream text;
  text << std::setprecision(12) << number;
  return text.str();
}

bool is_free_text(const Setting& setting) {
  return setting.choices.empty() && std::holds_alternative<std::string>(setting.value);
}

[[noreturn]] void refuse(const Setting& setting, const SettingValue& value, const char* wrong) {
  std::string text = to_string(value);
  // 3.0 is not the whole number 3.
  const bool looks_whole = text.find_first_not_of("-0123456789") == std::string::npos;
  if (std::holds_alternative<double>(value) && looks_whole) text += ".0";
  if (std::holds_alternative<std::string>(value) && setting.choices.empty())
    text = '"' + text + '"';
  throw std::invalid_argument(std::string(setting.name) + ": " + text + wrong + ", expected " +
                              legal_values(setting));
}

double as_number(const Setting& setting, const SettingValue& value) {
  if (const int* whole = std::get_if<int>(&value)) return *whole;
  if (const double* number = std::get_if<double>(&value)) return *number;
  throw std::invalid_argument(std::string(setting.name) + ": is no number");
}

}  // namespace

std::string legal_values(const Setting& setting) {
  if (is_free_text(setting)) return "a text";
  if (setting.choices.empty()) return text_of(setting.lowest) + " to " + text_of(setting.highest);
  std::string text;
  for (std::size_t i = 0; i < setting.choices.size(); ++i) {
    if (i > 0) text += i + 1 < setting.choices.size() ? ", " : " or ";
    text += setting.choices[i];
  }
  return text;
}

std::string to_string(const SettingValue& value) {
  if (const std::string* text = std::get_if<std::string>(&value)) return *text;
  if (const int* whole = std::get_if<int>(&value)) return std::to_string(*whole);
  return text_of(std::get<double>(value));
}

Settings::Settings(std::vector<Setting> settings) : settings_(std::move(settings)) {}

const Setting* Settings::find(std::string_view name) const {
  const auto found = std::ranges::find(settings_, name, &Setting::name);
  return found == settings_.end() ? nullptr : &*found;
}

Setting& Settings::at(std::string_view name) {
  const auto found = std::ranges::find(settings_, name, &Setting::name);
  if (found != settings_.end()) return *found;
  throw std::invalid_argument(std::string(name) + ": is no setting of this method");
}

double Settings::number(std::string_view name) const {
  const Setting* setting = find(name);
  if (setting == nullptr) {
    throw std::invalid_argument(std::string(name) + ": is no setting of this method");
  }
  return setting->is_set ? as_number(*setting, setting->value) : number(setting->follows);
}

int Settings::whole(std::string_view name) const {
  const Setting* setting = find(name);
  if (setting != nullptr && std::holds_alternative<int>(setting->value)) {
    const bool follows = !setting->is_set && !setting->follows.empty();
    return follows ? whole(setting->follows) : std::get<int>(setting->value);
  }
  throw std::invalid_argument(std::string(name) + ": is no whole number of this method");
}

const std::string& Settings::choice(std::string_view name) const {
  const Setting* setting = find(name);
  if (setting != nullptr && std::holds_alternative<std::string>(setting->value)) {
    return std::get<std::string>(setting->value);
  }
  throw std::invalid_argument(std::string(name) + ": is no choice of this method");
}

void Settings::set(std::string_view name, const SettingValue& value) {
  Setting& setting = at(name);
  if (std::holds_alternative<std::string>(setting.value)) {
    const std::string* text = std::get_if<std::string>(&value);
    if (is_free_text(setting)) {
      if (text == nullptr) refuse(setting, value, " is not a text");
    } else if (text == nullptr ||
               std::ranges::find(setting.choices, *text) == setting.choices.end()) {
      refuse(setting, value, " is not known");
    }
    setting.value = value;
    setting.is_set = true;
    return;
  }
  const bool wants_whole = std::holds_alternative<int>(setting.value);
  if (std::holds_alternative<std::string>(value) ||
      (wants_whole && !std::holds_alternative<int>(value))) {
    refuse(setting, value, wants_whole ? " is not a whole number" : " is not a number");
  }
  const double number = as_number(setting, value);
  // NaN fails as well.
  if (!(number >= setting.lowest && number <= setting.highest)) {
    refuse(setting, value, " is out of range");
  }
  if (wants_whole) {
    setting.value = value;
  } else {
    setting.value = number;
  }
  setting.is_set = true;
}

}  // namespace mosbench
