#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "datasets/disk/files.hpp"
#include "tests/temp_folder.hpp"

/// Runs the built program as a user would.
namespace mosbench::cli {

struct Answer {
  int exit_code = -1;  ///< 128 + signal when a signal ended it
  std::string out;
  std::string err;
};

/// Starts `mosbench arguments...` with its streams in files of `folder`; `prepare` runs in the
/// child before the program. Returns the process id.
inline pid_t start(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                   const std::function<void()>& prepare = {}) {
  std::vector<std::string> words = {MOSBENCH_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const std::string out = folder / "stdout.txt";
  const std::string err = folder / "stderr.txt";
  const pid_t child = fork();
  if (child != 0) return child;
  dup2(open(out.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0644), STDOUT_FILENO);
  dup2(open(err.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0644), STDERR_FILENO);
  if (prepare) prepare();
  execv(argv[0], argv.data());
  _exit(127);
}

/// Waits for the program's end; 128 + signal when a signal ended it.
inline int wait_for(pid_t child) {
  int status = 0;
  if (waitpid(child, &status, 0) != child) throw std::runtime_error("waitpid failed");
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

inline Answer run(const std::vector<std::string>& arguments,
                  const std::function<void()>& prepare = {}) {
  const TempFolder streams;
  Answer answer;
  answer.exit_code = wait_for(start(arguments, streams.path(), prepare));
  answer.out = read_file(streams / "stdout.txt");
  answer.err = read_file(streams / "stderr.txt");
  return answer;
}

/// result.json without what depends on the clock and on this machine's folders.
inline nlohmann::ordered_json timeless_result(const std::filesystem::path& folder) {
  auto json = nlohmann::ordered_json::parse(read_file(folder / "result.json"));
  json.erase("timing");
  json.erase("places");
  return json;
}

/// Name and bytes of every file below `folder`, except that result.json is taken without timing.
inline std::vector<std::pair<std::string, std::string>> contents(
    const std::filesystem::path& folder) {
  std::vector<std::pair<std::string, std::string>> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::filesystem::path& path = entry.path();
    std::string bytes;
    if (entry.is_regular_file()) {
      bytes = path.filename() == "result.json" ? timeless_result(path.parent_path()).dump()
                                               : read_file(path);
    }
    files.emplace_back(std::filesystem::relative(path, folder).string(), std::move(bytes));
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace mosbench::cli
