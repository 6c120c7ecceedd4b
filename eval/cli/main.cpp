#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

#include "datasets/files/errors.hpp"
#include "eval/cli/command_line.hpp"

namespace {

enum ExitCode { kUsage = 2, kUnusableFiles = 3, kInternal = 70 };

/// A file opened later must not become stdout or stderr by taking a number that was left free.
void occupy_standard_streams() {
  if (fcntl(STDOUT_FILENO, F_GETFD) == -1) {
    throw mosbench::DataError("stdout", "is closed", "somewhere to write the answer");
  }
  for (const int stream : {STDIN_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) == -1) open("/dev/null", O_RDWR);
  }
}

void print(const std::string& text) {
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  if (written && std::fflush(stdout) == 0) return;
  throw mosbench::DataError("stdout", fmt::format("cannot be written ({})", std::strerror(errno)),
                            "somewhere to write the answer");
}

int fail(int exit_code, std::string_view message) {
  std::fputs(fmt::format("mosbench: {}\n", message).c_str(), stderr);
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  // A full disk, a file size limit or a reader that went away then show as failed writes.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  try {
    occupy_standard_streams();
    const mosbench::Answer answer = mosbench::answer_to({argv + 1, argv + argc});
    print(answer.text);
    return answer.exit_code;
  } catch (const mosbench::UsageError& error) {
    return fail(kUsage, error.what());
  } catch (const mosbench::DataError& error) {
    return fail(kUnusableFiles, error.what());
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(kUnusableFiles, error.what());
  } catch (const std::exception& error) {
    return fail(kInternal, fmt::format("internal fault: {}", error.what()));
  }
}
