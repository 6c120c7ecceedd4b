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
    // The library keeps one of two equal keys; an object that says two things says nothing.
    if (event == Event::key && !keys_.back().insert(parsed.get<std::string>()).second) {
      throw DataError(origin_, "key " + shown(parsed) + " is there twice in one object",
                      "each key once");
    }
    return true;
  }

 private:
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
  try {
    return ordered_json::parse(text, JsonCheck(origin));
  } catch (const ordered_json::exception& error) {
    throw DataError(origin, std::string("is no JSON (") + error.what() + ")", "a JSON object");
  }
}

}  // namespace mosbench
