#include "eval/results/result_format.hpp"

#include <fmt/format.h>

#include "datasets/files/errors.hpp"

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
  const int format = content.is_object() ? content.value("format", 1) : 1;
  if (format > kResultFormat || format < 1) {
    throw DataError(file, fmt::format("has format {}", format),
                    fmt::format("format 1 to {}; a newer mosbench wrote it", kResultFormat));
  }
  if (format < 2) upgrade_method(content);
  return content;
}

}  // namespace mosbench
