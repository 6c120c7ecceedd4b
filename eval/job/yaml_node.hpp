#pragma once

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/text/errors.hpp"

namespace mosbench {

/// A value of a YAML file that knows where it stands. All functions throw UsageError with file and
/// line for what is not of the asked kind.
class YamlNode {
 public:
  YamlNode(YAML::Node node, std::filesystem::path file)
      : node_(std::move(node)), file_(std::move(file)) {}

  /// Throws "<file>:<line>: <wrong>, expected <expected>".
  [[noreturn]] void refuse(const std::string& wrong, const std::string& expected) const;

  /// Checks that this is a map with no other keys.
  void check_keys(const std::vector<std::string_view>& known) const;
  std::optional<YamlNode> find(const char* key) const;
  YamlNode at(const char* key) const;
  /// Returns the members of a list; of anything else that one value.
  std::vector<YamlNode> list() const;
  /// Does the same for the value of a key; none where it is not given.
  std::vector<YamlNode> list(const char* key) const;
  /// Returns the members of a map in order. Refuses keys that are given twice.
  std::vector<std::pair<std::string, YamlNode>> members() const;
  bool is_map() const { return node_.IsMap(); }

  /// Returns one value as it is written.
  std::string text() const;
  std::uint64_t whole(std::uint64_t lowest, std::uint64_t highest) const;

  /// Calls and says where, if the call throws UsageError or std::invalid_argument.
  template <typename Call>
  auto located(Call&& call) const {
    try {
      return call();
    } catch (const std::exception& error) {
      throw UsageError(place() + ": " + error.what());
    }
  }

 private:
  std::string place() const;

  YAML::Node node_;
  std::filesystem::path file_;
};

/// Parses a file of one YAML document. Throws UsageError.
YamlNode parse_yaml(const std::string& text, const std::filesystem::path& file);

}  // namespace mosbench
