#include "eval/truth/decisions.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "datasets/text/errors.hpp"
#include "datasets/text/json_text.hpp"
#include "eval/answer/answer_text.hpp"

namespace mosbench {

std::vector<Decision> parse_decisions(std::string_view text, const std::filesystem::path& file) {
  using nlohmann::ordered_json;
  const ordered_json json = parse_json(text, file);
  const char* expected =
      "{\"format\": 1, \"decisions\": [{\"track\": \"08/12\", \"decided\": \"moving\"}, ...]}, or "
      "static, unsure or taken-back";
  std::vector<Decision> decisions;
  try {
    if (json.at("format") != 1) throw DataError(file, "has another \"format\"", expected);
    for (const ordered_json& member : json.at("decisions")) {
      const auto decided =
          std::ranges::find(kDecidedNames, member.at("decided").get<std::string>());
      if (decided == kDecidedNames.end()) {
        throw DataError(file, "has a decision that is not known", expected);
      }
      decisions.push_back({member.at("track").get<std::string>(),
                           static_cast<Decided>(decided - kDecidedNames.begin())});
    }
  } catch (const ordered_json::exception& error) {
    throw DataError(file, sentence_of(error), expected);
  }
  return decisions;
}

std::string format_decisions(std::span<const Decision> decisions) {
  nlohmann::ordered_json json = {{"format", 1}, {"decisions", nlohmann::ordered_json::array()}};
  for (const auto& [track, decided] : decisions) {
    json["decisions"].push_back(
        {{"track", track}, {"decided", kDecidedNames[static_cast<std::size_t>(decided)]}});
  }
  return json_text(json);
}

std::map<std::string, Decided> last_of_each(std::span<const Decision> decisions) {
  std::map<std::string, Decided> last;
  for (const auto& [track, decided] : decisions) {
    if (decided == Decided::kTakenBack) {
      last.erase(track);
    } else {
      last[track] = decided;
    }
  }
  return last;
}

}  // namespace mosbench
