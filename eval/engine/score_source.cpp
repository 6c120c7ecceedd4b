#include "eval/engine/score_source.hpp"

#include "eval/results/reading_json.hpp"

namespace mosbench {
namespace fs = std::filesystem;
using nlohmann::ordered_json;

ordered_json source_json(const Dataset& dataset, const ReadingOptions& reading,
                         const ScoreTask& task, PredictionFormat format) {
  ordered_json json = {{"dataset_root", fs::absolute(dataset.root).string()}};
  json.update(told_json(reading));
  json["predictions"] = fs::absolute(task.predictions).string();
  json["format"] = describe(format).name;
  json["level"] = to_string(task.options.level);
  if (task.options.mask) json["mask_m"] = {task.options.mask->min_m, task.options.mask->max_m};
  if (task.options.id_map) json["id_map"] = id_map_text(*task.options.id_map);
  return json;
}

PredictionSource prediction_source(const ordered_json& source) {
  PredictionSource predictions;
  predictions.path = source.at("predictions").get<std::string>();
  PredictionOptions& options = predictions.options;
  options.format = prediction_format_named(source.at("format").get<std::string>());
  options.level = dynablox_level_named(source.at("level").get<std::string>());
  if (source.contains("mask_m")) {
    options.mask = {source.at("mask_m").at(0), source.at("mask_m").at(1)};
  }
  if (source.contains("id_map")) options.id_map = parse_id_map(source.at("id_map"));
  return predictions;
}

}  // namespace mosbench
