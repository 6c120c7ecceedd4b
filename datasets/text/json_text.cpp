#include "datasets/text/json_text.hpp"

#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

/// Looks at a text while it is parsed.
class JsonCheck {
 public:
  explicit JsonCheck(const std::filesystem::path& origin) : origin_(origin) {}

  bool operator()(int level, ordered_json::parse_event_t event, ordered_json& parsed) {
    using Event = ordered_json::parse_event_t;
    if (event == Event::object_start || event == Event::array_start) refuse_depth(level);
    if (event == Event::object_start) keys_.emplace_back();
    if (event == Event::object_end) keys_.pop_back();
    if (event == Event::key && keys_.back().size() >= kMostKeys) {
      throw DataError(origin_, "has more than " + std::to_string(kMostKeys) + " keys in one object",
                      "fewer");
    }
    // The library keeps one of two equal keys; an object that says two things says nothing.
    if (event == Event::key && !keys_.back().insert(parsed.get<std::string>()).second) {
      throw DataError(origin_, "key " + shown(parsed) + " is there twice in one object",
                      "each key once");
    }
    return true;
  }

 private:
  static constexpr std::size_t kMostKeys = 20'000;

  void refuse_depth(int level) const {
    constexpr int kMostLevels = 64;
    if (level < kMostLevels) return;
    throw DataError(origin_, "nests deeper than " + std::to_string(kMostLevels) + " levels",
                    "JSON of fewer");
  }

  static std::string shown(const ordered_json& key) {
    return key.dump(-1, ' ', true, ordered_json::error_handler_t::replace);
  }

  const std::filesystem::path& origin_;
  std::vector<std::set<std::string>> keys_;  // of the objects that are open
};

}  // namespace

ordered_json parse_json(std::string_view text, const std::filesystem::path& origin) {
  // The library takes it for the end.
  if (const std::size_t at = text.find('\0'); at != std::string_view::npos) {
    throw DataError(origin, "is no JSON (byte " + std::to_string(at) + " is NUL)", "a JSON object");
  }
  try {
    return ordered_json::parse(text, JsonCheck(origin));
  } catch (const ordered_json::exception& error) {
    throw DataError(origin, "is no JSON (" + sentence_of(error) + ")", "a JSON object");
  }
}

std::string sentence_of(const std::exception& error) {
  std::string text = error.what();
  const bool lacks_key = text.starts_with("[json.exception.out_of_range.403]");
  if (const std::size_t end = text.find("] "); text.starts_with('[') && end != text.npos) {
    text.erase(0, end + 2);
  }
  const std::size_t first = text.find('\''), last = text.rfind('\'');
  if (!lacks_key || first >= last) return text;
  return "lacks \"" + text.substr(first + 1, last - first - 1) + '"';
}

}  // namespace mosbench
