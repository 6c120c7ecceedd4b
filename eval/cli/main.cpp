#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"
#include "eval/answer/render.hpp"
#include "eval/cli/command_line.hpp"
#include "eval/cli/commands.hpp"
#include "eval/cli/flags.hpp"
#include "eval/result/tell.hpp"

namespace {

/// A file opened later must not become stdout or stderr by taking a number that was left free.
void occupy_standard_streams() {
  if (fcntl(STDOUT_FILENO, F_GETFD) == -1) {
    throw mosbench::DataError("stdout", "is closed", "somewhere to write the answer");
  }
  for (const int stream : {STDIN_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) == -1) open("/dev/null", O_RDWR);
  }
}

}  // namespace

int main(int argc, char** argv) {
  // A full disk, a file size limit or a reader that went away then show as failed writes.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  // Who started mosbench may have ignored the ends of children, which are then lost.
  std::signal(SIGCHLD, SIG_DFL);
  mosbench::word_options_by(mosbench::flag_words);
  try {
    occupy_standard_streams();
    const mosbench::Printed printed =
        mosbench::answer_to({argv + 1, argv + argc}, mosbench::terminal_columns());
    const bool coloured = printed.is_text && mosbench::shows_colours(STDOUT_FILENO);
    if (!printed.failure.empty()) mosbench::tell("mosbench: " + printed.failure);
    mosbench::write_stdout(coloured ? mosbench::in_colours(printed.bytes) : printed.bytes);
    return printed.exit_code;
  } catch (...) {
    const mosbench::Failure failure = mosbench::current_failure();
    mosbench::tell(fmt::format("mosbench: {}", failure.message));
    return failure.exit_code;
  }
}
