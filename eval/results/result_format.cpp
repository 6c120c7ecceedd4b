#include "eval/results/result_format.hpp"

#include <fmt/format.h>

#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

/// Format 1 knew one method.
void upgrade_method(ordered_json& content) {
  if (!content.contains("config") || content.contains("method")) return;
  ordered_json config = {{"variant", content.at("variant")}};
  config.update(content.at("config"));
  // In the order of the settings, by which configs are compared.
  const int distance_field_scans = config.value("distance_field_scans", 2);
  config.erase("distance_field_scans");
  if (!config.contains("dynamic_window_scans")) config["dynamic_window_scans"] = 100;
  config["distance_field_scans"] = distance_field_scans;
  content["method"] = {{"name", "HMM-MOS"}, {"kind", "hmm-mos"}};
  content["config"] = std::move(config);
  content.erase("variant");
}

}  // namespace

ordered_json in_present_format(ordered_json content, const std::filesystem::path& file) {
  const ordered_json stated =
      content.is_object() ? content.value("format", ordered_json(1U)) : ordered_json(1U);
  const auto format = stated.is_number_unsigned() ? stated.get<std::uint64_t>() : 0;
  if (format < 1 || format > kResultFormat) {
    throw DataError(file, fmt::format("has format {}", stated.dump()),
                    fmt::format("a whole number from 1 to {}{}", kResultFormat,
                                format > 0 ? "; a newer mosbench wrote it" : ""));
  }
  if (format < 2) upgrade_method(content);
  return content;
}

}  // namespace mosbench
