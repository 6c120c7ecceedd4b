#include "datasets/hdf5/process_copy.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <utility>

#include "datasets/disk/file_descriptor.hpp"

namespace mosbench {
namespace {

/// The first byte of a message, whose last one follows the bytes.
enum Mark : char { kAnswer = 'a', kFailure = 'f', kEnd = 'e' };

void send(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = write(descriptor, bytes.data(), bytes.size());
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return;
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
}

std::string receive(int descriptor) {
  std::string bytes;
  std::array<char, 65536> part;
  while (true) {
    const ssize_t count = read(descriptor, part.data(), part.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return bytes;
    bytes.append(part.data(), static_cast<std::size_t>(count));
  }
}

void limit(__rlimit_resource resource, rlim_t most) {
  const rlimit limits{most, most};
  setrlimit(resource, &limits);
}

/// Sees to it that the copy leaves no core, says nothing and ends.
void restrict_copy(unsigned most_cpu_s) {
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, most_cpu_s);
  const int nowhere = open("/dev/null", O_RDWR);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(nowhere, stream);
  for (const int number : {SIGALRM, SIGINT, SIGTERM, SIGPIPE, SIGXCPU}) signal(number, SIG_DFL);
  alarm(3 * most_cpu_s);
}

[[noreturn]] void answer(const std::function<std::string()>& work, int descriptor) {
  std::string message;
  try {
    message = static_cast<char>(kAnswer) + work();
  } catch (const std::exception& error) {
    message = static_cast<char>(kFailure) + std::string(error.what());
  }
  send(descriptor, message + static_cast<char>(kEnd));
  // Not exit, which would do again what this process does at its end.
  _exit(0);
}

std::string ending_of(pid_t copy) {
  int status = 0;
  while (waitpid(copy, &status, 0) < 0) {
    if (errno != EINTR) return "ended without an answer";
  }
  if (!WIFSIGNALED(status)) return "ended without an answer";
  return std::string("ended by signal ") + strsignal(WTERMSIG(status));
}

CopyAnswer parsed(std::string message, std::string ending) {
  if (message.size() < 2 || message.back() != kEnd) return {"", std::move(ending)};
  const bool is_answer = message.front() == kAnswer;
  message.pop_back();
  message.erase(0, 1);
  return is_answer ? CopyAnswer{std::move(message), ""} : CopyAnswer{"", std::move(message)};
}

}  // namespace

CopyAnswer in_process_copy(const std::function<std::string()>& work, unsigned most_cpu_s) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return {"", std::strerror(errno)};
  FileDescriptor from(ends[0]), to(ends[1]);
  const pid_t copy = fork();
  if (copy < 0) return {"", std::strerror(errno)};
  if (copy == 0) {
    restrict_copy(most_cpu_s);
    answer(work, to.number());
  }
  to = FileDescriptor();
  std::string message = receive(from.number());
  return parsed(std::move(message), ending_of(copy));
}

}  // namespace mosbench
