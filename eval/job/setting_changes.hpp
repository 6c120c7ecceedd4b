#pragma once

#include <filesystem>
#include <mosbench/method.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "eval/job/job.hpp"

namespace mosbench {

/// Settings while their words are read, one after the other. Throws UsageError.
class ChangeReader {
 public:
  explicit ChangeReader(const MethodKind& method) : method_(method), settings_(method.defaults) {}

  void read_file(const std::filesystem::path& file);
  /// KEY=VALUE; of methods with a delay also delay=SCANS, delay=all and delay=all:SECONDS.
  void read_assignment(const std::string& assignment);
  /// moving=now, ever or ever:SECONDS: a short word of the methods that have it.
  void read_word(std::string_view name, const std::string& text);

  std::vector<SettingChange> take() { return std::move(changes_); }

 private:
  void read_delay(std::string_view text);
  void set(std::string_view name, const SettingValue& value);
  void keep(std::string_view name);

  const MethodKind& method_;
  Settings settings_;
  std::vector<SettingChange> changes_;
};

}  // namespace mosbench
