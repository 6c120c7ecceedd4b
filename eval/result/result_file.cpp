#include "eval/result/result_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <system_error>

#include "datasets/disk/files.hpp"
#include "datasets/sequence/sequence.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/json_text.hpp"
#include "eval/result/reading_json.hpp"
#include "eval/result/result_json.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

std::string dump(const ordered_json& json) {
  return json.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

// Indented like dump(1), but with one line per scan.
void append_members(const ordered_json& object, const std::string& indent, std::string& text) {
  for (const auto& [key, value] : object.items()) {
    text += indent + ordered_json(key).dump() + ": ";
    if (key == "scans" && value.is_array()) {
      text += "[";
      for (std::size_t i = 0; i < value.size(); ++i) {
        text += (i == 0 ? "\n" : ",\n") + indent + " " + dump(value[i]);
      }
      text += "\n" + indent + "]";
    } else if (value.is_object() && !value.empty()) {
      text += "{\n";
      append_members(value, indent + " ", text);
      text += indent + "}";
    } else {
      text += dump(value);
    }
    text += ",\n";
  }
  text.erase(text.size() - 2, 1);
}

/// Returns whether the result in a folder is of a sequence of that name.
bool holds_own_result(const std::filesystem::path& folder) {
  try {
    // It may have a name that no result can have, which is to be told, not passed over.
    const std::filesystem::path file = folder / "result.json";
    const std::string name = parse_json(read_file(file), file).value("sequence", "");
    return std::filesystem::path(name).filename() == folder.filename();
  } catch (const std::exception&) {
    return false;
  }
}

/// Returns whether no result is to be looked for in a folder: a run keeps files per scan there, or
/// was killed, or is about to replace it. A sequence may be called like that, too.
bool is_passed_over(const std::filesystem::path& folder) {
  if (std::ranges::find(kScanFileFolders, folder.filename().string()) != kScanFileFolders.end()) {
    return is_there(folder.parent_path() / "result.json");
  }
  const bool leftover = folder.extension() == ".partial" || folder.extension() == ".replaced";
  return leftover && !holds_own_result(folder);
}

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
}

/// Moves a member from one object to another, where there is one.
void move_member(ordered_json& from, const char* key, ordered_json& to, const char* new_key) {
  if (!from.contains(key)) return;
  ordered_json value = std::move(from.at(key));
  from.erase(key);
  to[new_key] = std::move(value);
}

/// Splits "voxel_size_m=0.5 deskew=none", as format 2 states the settings of odometry.
ordered_json settings_in(const std::string& text) {
  ordered_json settings = ordered_json::object();
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const std::size_t equals = std::min(word.find('='), word.size() - 1);
    const std::string value = word.substr(equals + 1);
    const ordered_json number = ordered_json::parse(value, nullptr, false);
    settings[word.substr(0, equals)] = number.is_number() ? number : ordered_json(value);
  }
  return settings;
}

void upgrade_odometry(ordered_json& content) {
  const ordered_json reading = content.value("reading", ordered_json::object());
  if (!reading.contains("pose_odometry")) return;
  content["odometry"] = {{"name", reading.value("poses", "")},
                         {"settings", settings_in(reading.at("pose_odometry"))},
                         {"map", reading.value("pose_map", "")}};
}

/// What format 2 kept in "timing" or "source", beside the flags of reading.
void upgrade_places(ordered_json& content) {
  const bool is_scored = content.contains("source");
  if (!is_scored && !content.contains("timing")) return;
  ordered_json& old = content.at(is_scored ? "source" : "timing");
  ordered_json places = ordered_json::object();
  for (const char* key : {"dataset_root", "file_stamp", "sequences_of_run"}) {
    move_member(old, key, places, key);
  }
  ordered_json flags = old;
  flags.erase("scans");  // the measurements of scans: format 2 knew no range of them
  places["reading"] = told_json(told_from_json(flags));
  if (is_scored) {
    ordered_json& source = places["predictions"] = ordered_json::object();
    move_member(old, "predictions", source, "path");
    for (const char* key : {"format", "level", "mask_m", "id_map"}) {
      move_member(old, key, source, key);
    }
  }
  content["places"] = std::move(places);
}

void upgrade_to_provenance(ordered_json& content) {
  ordered_json from = content.value("code", ordered_json::object());
  for (const char* key : {"machine", "fingerprint", "fingerprint_without_poses", "simulated"}) {
    move_member(content, key, from, key);
  }
  content["provenance"] = std::move(from);
  move_member(content, "config", content, "settings");
  upgrade_odometry(content);
  upgrade_places(content);
}

/// Returns the content of a result.json of any format as one of kResultFormat. Throws DataError for
/// a format that is newer than this program, nlohmann's exceptions for what is no result.
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
  if (format < 3) upgrade_to_provenance(content);
  return content;
}

}  // namespace

std::string format_result(const Result& result) {
  std::string text = "{\n";
  append_members(to_json(result), " ", text);
  return text + "}\n";
}

std::vector<std::filesystem::path> find_result_files(const std::filesystem::path& path,
                                                     std::filesystem::directory_options how,
                                                     int deepest) {
  std::error_code error;
  if (std::filesystem::is_regular_file(path, error)) return {path};
  std::vector<std::filesystem::path> files;
  for (std::filesystem::recursive_directory_iterator it(path, how, error), end; !error && it != end;
       it.increment(error)) {
    if (is_passed_over(it->path())) {
      it.disable_recursion_pending();
    } else if (it->path().filename() == "result.json") {
      files.push_back(it->path());
    }
    if (it.depth() >= deepest) it.disable_recursion_pending();
  }
  if (error) throw DataError(path, "cannot be read (" + error.message() + ")", "results");
  std::ranges::sort(files);
  return files;
}

Result read_result(const std::filesystem::path& file) {
  ordered_json content = parse_json(read_file(file), file);
  try {
    const bool is_first = content.is_object() && !content.contains("format");
    Result result = result_from_json(in_present_format(std::move(content), file), file);
    result.has_whole_scores = is_first;
    return result;
  } catch (const ordered_json::exception& error) {
    throw DataError(file, sentence_of(error), "a result.json of mosbench");
  } catch (const MemberFault& fault) {
    throw DataError(file, fault.what(), "a result.json of mosbench");
  } catch (const UsageError& error) {
    throw DataError(file, error.what(), "a result.json of this mosbench");
  }
}

std::vector<Result> read_results(const std::filesystem::path& path) {
  std::vector<Result> results;
  for (const std::filesystem::path& file : find_result_files(path)) {
    results.push_back(read_result(file));
  }
  if (!results.empty()) return results;
  throw DataError(path, "holds no result.json", "results of mosbench run or mosbench score");
}

}  // namespace mosbench
