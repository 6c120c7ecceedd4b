#include "eval/result/output.hpp"

#include <fstream>
#include <system_error>

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"
#include "eval/answer/render.hpp"

namespace mosbench {

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
  if (std::filesystem::is_directory(above, ignored)) return;
  throw DataError(above, "is no folder", "a folder for " + file.filename().string());
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
