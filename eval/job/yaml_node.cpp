#include "eval/job/yaml_node.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "datasets/text/text.hpp"

namespace mosbench {

std::string YamlNode::place() const {
  const int line = node_.Mark().line;
  return line < 0 ? file_.string() : fmt::format("{}:{}", file_.string(), line + 1);
}

void YamlNode::refuse(const std::string& wrong, const std::string& expected) const {
  throw UsageError(fmt::format("{}: {}, expected {}", place(), wrong, expected));
}

void YamlNode::check_keys(const std::vector<std::string_view>& known) const {
  for (const auto& [key, value] : members()) {
    if (std::ranges::find(known, key) == known.end()) {
      const std::string_view nearest = nearest_name(key, std::span(known.begin(), known.size()));
      value.refuse(fmt::format("key {} is not known", mosbench::quoted(key)),
                   fmt::format("one of {} (nearest: {})", fmt::join(known, ", "), nearest));
    }
  }
}

std::optional<YamlNode> YamlNode::find(const char* key) const {
  const YAML::Node value = node_[key];
  if (!value.IsDefined()) return std::nullopt;
  return YamlNode(value, file_);
}

YamlNode YamlNode::at(const char* key) const {
  if (auto value = find(key)) return *value;
  refuse(fmt::format("key {} is missing", mosbench::quoted(key)), "it here");
}

std::vector<YamlNode> YamlNode::list() const {
  if (!node_.IsSequence()) return {*this};
  std::vector<YamlNode> nodes;
  for (const YAML::Node& node : node_) nodes.emplace_back(node, file_);
  if (nodes.empty()) refuse("is an empty list", "at least one value");
  return nodes;
}

std::vector<YamlNode> YamlNode::list(const char* key) const {
  const std::optional<YamlNode> node = find(key);
  return node ? node->list() : std::vector<YamlNode>();
}

std::vector<std::pair<std::string, YamlNode>> YamlNode::members() const {
  if (!node_.IsMap()) refuse("is no map", "KEY: VALUE, ...");
  std::vector<std::pair<std::string, YamlNode>> members;
  std::set<std::string> seen;
  for (const auto& member : node_) {
    if (!member.first.IsScalar()) refuse("has a key that is no word", "KEY: VALUE, ...");
    members.emplace_back(member.first.Scalar(), YamlNode(member.second, file_));
    const auto& [key, value] = members.back();
    if (seen.insert(key).second) continue;
    value.refuse(fmt::format("key {} is given twice", mosbench::quoted(key)), "it once");
  }
  return members;
}

std::string YamlNode::text() const {
  if (!node_.IsScalar() || node_.Scalar().empty())
    refuse("is no single value", "one word or number");
  return node_.Scalar();
}

std::uint64_t YamlNode::whole(std::uint64_t lowest, std::uint64_t highest) const {
  const auto number = parse_unsigned(text());
  if (number && *number >= lowest && *number <= highest) return *number;
  refuse(fmt::format("{} is no number for it", mosbench::quoted(text())),
         fmt::format("a whole number from {} to {}", lowest, highest));
}

YamlNode parse_yaml(const std::string& text, const std::filesystem::path& file) {
  try {
    const std::vector<YAML::Node> documents = YAML::LoadAll(text);
    if (documents.size() > 1) {
      throw UsageError(fmt::format("{}: has {} YAML documents, expected one study", file.string(),
                                   documents.size()));
    }
    return {documents.empty() ? YAML::Node() : documents.front(), file};
  } catch (const YAML::Exception& error) {
    throw UsageError(fmt::format("{}:{}: is no YAML ({}), expected a study", file.string(),
                                 error.mark.line + 1, error.msg));
  }
}

}  // namespace mosbench
