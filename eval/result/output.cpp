#include "eval/result/output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/json_text.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/answer/render.hpp"

namespace mosbench {
namespace {

/// Whether a file is JSON as commands answer it, to the last blank, and not what they read.
bool is_answer_json(const std::filesystem::path& file) {
  try {
    const std::string bytes = read_file(file);
    const nlohmann::ordered_json json = parse_json(bytes, file);
    return !json.contains("format") && json_text(json) == bytes;
  } catch (const DataError&) {
    return false;
  }
}

/// Whether a file may be one that mosbench wrote in this format. Of text and pictures it cannot
/// tell more than that they are.
bool may_be_written(const std::filesystem::path& file, Format format) {
  std::string head(4096, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(in.gcount()));
  const bool names_mosbench = head.find("mosbench") != head.npos;
  switch (format) {
    case Format::kPng:
      return head.starts_with("\x89PNG");
    case Format::kHtml:
      return head.starts_with("<!doctype html>") && names_mosbench;
    case Format::kJunit:
      return head.starts_with("<?xml") && names_mosbench;
    case Format::kJson:
      return is_answer_json(file);
    default:
      return head.find('\0') == head.npos && !head.starts_with('{');
  }
}

/// Throws UsageError for names under which mosbench keeps what it reads again.
void refuse_record(const std::filesystem::path& file) {
  constexpr std::array<std::string_view, 7> kRecords = {
      "result.json", "products.json", "simulated.json", "disturbed.txt",
      "poses.txt",   "boxes.txt",     "boxes.json"};
  const std::string name = file.filename();
  if (!name.ends_with(".preset.json") && std::ranges::find(kRecords, name) == kRecords.end()) {
    return;
  }
  throw UsageError(file.string() +
                   ": is a name under which mosbench keeps what it reads again, expected another");
}

void refuse_foreign(const std::filesystem::path& file, Format written) {
  std::error_code ignored;
  const bool is_file = std::filesystem::is_regular_file(file, ignored);
  if (!is_file || std::filesystem::file_size(file, ignored) == 0) return;
  constexpr std::array<std::string_view, 3> kOnlyRead = {".yaml", ".yml", ".tum"};
  const bool is_read = std::ranges::find(kOnlyRead, file.extension().string()) != kOnlyRead.end();
  if (!is_read && may_be_written(file, written)) return;
  const bool is_known =
      written == Format::kHtml || written == Format::kJunit || written == Format::kJson;
  throw UsageError(fmt::format("{}: is there and no {}{}, expected another name", file.string(),
                               format_names()[static_cast<std::size_t>(written)],
                               is_known || is_read ? " that mosbench wrote" : ""));
}

}  // namespace

bool names_stdout(const std::filesystem::path& file) {
  return file == "-" || file == "/dev/stdout" || file == "/dev/fd/1";
}

void write_output(const std::filesystem::path& file, std::string_view bytes) {
  if (names_stdout(file)) {
    write_stdout(bytes);
  } else {
    commit_file(file, bytes);
  }
}

void append_output(const std::filesystem::path& file, std::string_view bytes) {
  if (names_stdout(file)) return write_stdout(bytes);
  std::ofstream end(file, std::ios::binary | std::ios::app);
  end.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  end.close();
  if (!end) throw DataError(file, "cannot be written", "a file that can");
}

void check_output(const std::filesystem::path& file, std::optional<Format> written) {
  if (names_stdout(file)) return;
  if (written) check_name(file, *written);
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored) || !file.has_filename()) {
    throw DataError(file, "is a folder", "a file to write");
  }
  std::filesystem::path above = std::filesystem::absolute(file).parent_path();
  while (above.has_relative_path() && !std::filesystem::exists(above, ignored)) {
    above = above.parent_path();
  }
  if (!std::filesystem::is_directory(above, ignored)) {
    throw DataError(above, "is no folder", "a folder for " + file.filename().string());
  }
  if (!written) return;
  refuse_record(file);
  refuse_foreign(file, *written);
}

void refuse_to_replace(const std::filesystem::path& file) {
  std::error_code ignored;
  if (names_stdout(file) || !std::filesystem::is_regular_file(file, ignored)) return;
  if (std::filesystem::file_size(file, ignored) == 0) return;
  throw UsageError(file.string() + ": is there already, expected another name, or --overwrite");
}

Answer answer_beside(const std::filesystem::path& file, Answer answer) {
  answer.goes_beside_stdout = names_stdout(file);
  return answer;
}

}  // namespace mosbench
