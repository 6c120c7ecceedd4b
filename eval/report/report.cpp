#include "eval/report/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <mosbench/method.hpp>
#include <set>
#include <stdexcept>

#include "datasets/text/errors.hpp"
#include "eval/report/label_products.hpp"
#include "eval/report/point_planes.hpp"
#include "eval/result/result_file.hpp"
#include "eval/result/result_json.hpp"
#include "eval/result/version.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

constexpr std::string_view kContentMarker = "<!-- content of the report -->";

using nlohmann::ordered_json;

constexpr std::size_t kBytesAroundBlock = 64;

/// Of scans that were not scored the page gets the stem alone.
ordered_json shown_result(const Result& result) {
  ordered_json json = to_json(result);
  for (std::size_t k = 0; result.predictions && k < result.scans.size(); ++k) {
    if (!result.scans[k].counts) json["scans"][k] = {{"stem", result.scans[k].stem}};
  }
  return json;
}

ordered_json result_json(const Result& result) {
  ordered_json json = {{"run", run_name(result)},
                       {"folder", result.folder().string()},
                       {"protocol_summary", result.protocol->summary}};
  if (const MethodKind* method = find_method(result.kind)) {
    json["score_name"] = method->score_name;
    json["threshold_name"] = method->threshold_name;
  }
  json["estimates"] = estimates_of(result);
  json["result"] = shown_result(result);
  json["doubts"] = notices_of(result);
  return json;
}

/// Results of which an input and its folder are given are taken once.
std::vector<Result> find_all(const std::vector<std::filesystem::path>& inputs) {
  std::vector<Result> results;
  std::set<std::filesystem::path> known;
  for (const std::filesystem::path& input : inputs) {
    for (Result& result : read_results(input)) {
      if (known.insert(std::filesystem::canonical(result.folder())).second) {
        results.push_back(std::move(result));
      }
    }
  }
  return results;
}

ordered_json content_without_points(const std::vector<std::filesystem::path>& inputs,
                                    const std::vector<Result>& results,
                                    const std::vector<ReportRun>& runs,
                                    const ReportOptions& options) {
  ordered_json json = {{"format", 1},
                       {"version", std::string(kMosbenchVersion)},
                       {"position_step_m", kPositionStep_m},
                       {"velocity_step_m_s", kVelocityStep_m_s},
                       {"max_mb", options.max_mb},
                       {"tables", covered_tables(inputs)},
                       {"leaderboards", leaderboards_of(runs)},
                       {"curves", ordered_json::array()},
                       {"clouds", ordered_json::array()},
                       {"results", ordered_json::array()}};
  for (const Result& result : results) json["results"].push_back(result_json(result));
  return json;
}

std::size_t room_for_points(const ordered_json& content, const std::vector<Result>& results,
                            const ReportOptions& options) {
  std::size_t scans = 0;
  for (const Result& result : results) scans += result.scans.size();
  const std::size_t taken =
      report_asset().size() + script_json(content).size() + scans * 6 * kBytesAroundBlock;
  const double room = options.max_mb * 1e6 - static_cast<double>(taken);
  if (room > 0.0) return static_cast<std::size_t>(room);
  throw UsageError(
      fmt::format("--max-mb: {:g} MB have no room for the numbers alone, expected {:.1f}",
                  options.max_mb, static_cast<double>(taken) / 1e6));
}

/// Opens the scans of every result that has labels, and says which has none; where none has, it
/// throws DataError as ResultScans does.
std::vector<std::optional<ResultScans>> open_sources(
    const std::vector<Result>& results, const std::optional<std::filesystem::path>& root,
    std::vector<std::string>& remarks) {
  std::vector<std::optional<ResultScans>> sources(results.size());
  const bool any = std::ranges::any_of(results, has_labels);
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (!any || has_labels(results[i])) {
      sources[i].emplace(results[i], root);
    } else {
      remarks.push_back(fmt::format("{}: without points, because its labels are not known",
                                    results[i].folder().string()));
    }
  }
  return sources;
}

}  // namespace

std::pair<std::string_view, std::string_view> parts_of_page(std::string_view asset) {
  const std::size_t marker = asset.find(kContentMarker);
  if (marker == std::string_view::npos) throw std::logic_error("the page has no content marker");
  return {asset.substr(0, marker), asset.substr(marker + kContentMarker.size())};
}

std::string script_json(const ordered_json& json) {
  const std::string text = json.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
  std::string escaped;
  escaped.reserve(text.size());
  for (const char c : text) c == '<' ? escaped += "\\u003c" : escaped += c;
  return escaped;
}

std::string filled_page(std::string_view asset, const ordered_json& content,
                        const std::vector<std::string>& blocks) {
  const auto [before, behind] = parts_of_page(asset);
  std::string html(before);
  html += "<script type=\"application/json\" id=\"report\">" + script_json(content) + "</script>\n";
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    html += fmt::format("<script type=\"text/plain\" id=\"block-{}\">{}</script>\n", i, blocks[i]);
  }
  html += behind;
  return html;
}

Report build_report(const std::vector<std::filesystem::path>& inputs,
                    const ReportOptions& options) {
  const std::vector<Result> results = find_all(inputs);
  const std::vector<ReportRun> runs = runs_of(results);
  ordered_json content = content_without_points(inputs, results, runs, options);
  if (options.scans.none()) {
    return {filled_page(report_asset(), content),
            results.size(),
            {"the file holds no points (--scans none)"}};
  }
  check_choice(results, options.scans);
  std::vector<std::string> remarks;
  const std::vector<std::optional<ResultScans>> sources =
      open_sources(results, options.dataset_root, remarks);
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (!sources[i]) continue;
    content["results"][i]["result"] = shown_result(sources[i]->result());
    content["results"][i]["breakdown"] = breakdown_of(*sources[i]);
    content["results"][i]["protocols"] = protocols_of(*sources[i]);
    content["results"][i]["path"] = path_of(results[i], *sources[i]);
  }
  content["curves"] = curves_of(runs, results, sources);
  const ReportScans scans = choose_report_scans(results, sources, options.scans,
                                                room_for_points(content, results, options));
  content["clouds"] = scans.clouds;
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (!sources[i]) continue;
    content["results"][i]["cloud"] = scans.results[i].cloud;
    content["results"][i]["outcomes"] = scans.results[i].outcome_blocks;
    content["results"][i]["scores"] = scans.results[i].score_blocks;
    content["results"][i]["boxes"] = boxes_json(*sources[i], scans.results[i].scans);
    content["results"][i]["reasons"] = scans.results[i].reason_blocks;
  }
  remarks.insert(remarks.end(), scans.remarks.begin(), scans.remarks.end());
  return {filled_page(report_asset(), content, scans.blocks), results.size(), remarks};
}

}  // namespace mosbench
