#include "eval/cli/output_file.hpp"

#include <cstdio>

#include "datasets/files/files.hpp"

namespace mosbench {
namespace {

bool names_stdout(const std::filesystem::path& file) {
  return file == "-" || file == "/dev/stdout" || file == "/dev/fd/1";
}

}  // namespace

void write_output(const std::filesystem::path& file, std::string_view bytes) {
  if (names_stdout(file)) {
    write_stdout(bytes);
  } else {
    commit_file(file, bytes);
  }
}

Answer answer_beside(const std::filesystem::path& file, const std::string& text, int exit_code) {
  if (!names_stdout(file)) return {text, exit_code};
  std::fputs(text.c_str(), stderr);
  return {"", exit_code};
}

}  // namespace mosbench
