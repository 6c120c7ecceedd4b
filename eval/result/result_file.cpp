#include "eval/result/result_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <system_error>

#include "datasets/disk/files.hpp"
#include "datasets/sequence/recording.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/json_text.hpp"
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
    if (key == "scans") {
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
  return result_from_json(parse_json(read_file(file), file), file);
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
