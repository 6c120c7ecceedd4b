#include "datasets/hdf5/hdf5_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <limits>
#include <utility>

#include "datasets/disk/files.hpp"
#include "datasets/disk/partial_file.hpp"
#include "datasets/formats/byte_cursor.hpp"
#include "datasets/sequence/simulated_origin.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

/// The first byte of a message, whose last one follows the bytes.
enum Mark : char { kAnswer = 'a', kFailure = 'f', kEnd = 'e' };

constexpr int kMostAttempts = 2;

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

/// How a copy ended.
struct Ending {
  std::string text = "ended without an answer";
  bool only_waited = false;  ///< until its time was over, without computing
};

Ending ending_of(pid_t copy) {
  int status = 0;
  rusage used{};
  while (wait4(copy, &status, 0, &used) < 0) {
    if (errno != EINTR) return {};
  }
  if (!WIFSIGNALED(status)) return {};
  return {std::string("ended by signal ") + strsignal(WTERMSIG(status)),
          WTERMSIG(status) == SIGALRM && used.ru_utime.tv_sec + used.ru_stime.tv_sec == 0};
}

CopyAnswer parsed(std::string message, std::string ending) {
  if (message.size() < 2 || message.back() != kEnd) return {"", std::move(ending)};
  const bool is_answer = message.front() == kAnswer;
  message.pop_back();
  message.erase(0, 1);
  return is_answer ? CopyAnswer{std::move(message), ""} : CopyAnswer{"", std::move(message)};
}

using Kind = Hdf5Number::Kind;

constexpr std::string_view kSignature{"\x89HDF\r\n\x1a\n", 8};
constexpr const char* kExpected = "a whole HDF5 file of OpenSceneFlow, with groups of arrays";
/// No filter of libhdf5 packs numbers more than zlib, 1032 to 1.
constexpr std::uint64_t kMostPacked = 2048;

std::string packed(const std::vector<Hdf5Group>& groups, const std::string& mark) {
  ByteSink sink;
  sink.put_counted(mark);
  for (const Hdf5Group& group : groups) {
    sink.put_counted(group.name);
    sink.put(static_cast<std::uint32_t>(group.arrays.size()));
    for (const Hdf5Array& array : group.arrays) {
      sink.put_counted(array.name);
      sink.put(array.number.kind);
      sink.put(array.number.bytes);
      sink.put(static_cast<std::uint32_t>(array.shape.size()));
      for (const std::uint64_t size : array.shape) sink.put(size);
      sink.put(static_cast<std::uint8_t>(array.is_plain));
      sink.put(array.at_bytes);
    }
  }
  return std::move(sink).bytes();
}

Hdf5Array take_array(ByteCursor& cursor) {
  Hdf5Array array;
  array.name = cursor.take_counted();
  array.number.kind = cursor.take<Kind>();
  array.number.bytes = cursor.take<std::uint8_t>();
  for (auto sizes = cursor.take<std::uint32_t>(); sizes > 0; --sizes) {
    array.shape.push_back(cursor.take<std::uint64_t>());
  }
  array.is_plain = cursor.take<std::uint8_t>() != 0;
  array.at_bytes = cursor.take<std::uint64_t>();
  return array;
}

std::vector<Hdf5Group> unpacked(ByteCursor& cursor) {
  std::vector<Hdf5Group> groups;
  while (!cursor.rest().empty()) {
    Hdf5Group& group = groups.emplace_back();
    group.name = cursor.take_counted();
    for (auto arrays = cursor.take<std::uint32_t>(); arrays > 0; --arrays) {
      group.arrays.push_back(take_array(cursor));
    }
  }
  return groups;
}

/// Throws what libhdf5 said in the copy.
std::string answer_of(const CopyAnswer& answer, const std::filesystem::path& file) {
  if (answer.failure.empty()) return answer.bytes;
  throw DataError(file, "cannot be read (" + shown_in_line(answer.failure) + ")", kExpected);
}

void throw_if_failed(const std::string& error) {
  if (!error.empty()) throw std::runtime_error(error);
}

template <typename Stored, typename Value>
std::vector<Value> converted(std::string_view bytes) {
  std::vector<Value> values(bytes.size() / sizeof(Stored));
  for (std::size_t i = 0; i < values.size(); ++i) {
    Stored stored;
    std::memcpy(&stored, bytes.data() + i * sizeof(Stored), sizeof(Stored));
    values[i] = static_cast<Value>(stored);
  }
  return values;
}

template <typename Value>
std::vector<Value> converted(std::string_view bytes, const Hdf5Number& number) {
  const bool has_sign = number.kind == Kind::kInteger;
  switch (number.bytes) {
    case 1:
      return has_sign ? converted<std::int8_t, Value>(bytes)
                      : converted<std::uint8_t, Value>(bytes);
    case 2:
      return has_sign ? converted<std::int16_t, Value>(bytes)
                      : converted<std::uint16_t, Value>(bytes);
    case 4:
      return has_sign ? converted<std::int32_t, Value>(bytes)
                      : converted<std::uint32_t, Value>(bytes);
    default:
      return has_sign ? converted<std::int64_t, Value>(bytes)
                      : converted<std::uint64_t, Value>(bytes);
  }
}

}  // namespace

CopyAnswer in_process_copy(const std::function<std::string()>& work, unsigned most_cpu_s) {
  for (int attempt = 1;; ++attempt) {
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
    Ending ending = ending_of(copy);
    // Another thread may have held a lock of the memory allocator as the copy was made. That of the
    // C library is free in a copy, those of the sanitizers are not.
    if (ending.only_waited && attempt < kMostAttempts) continue;
    return parsed(std::move(message), std::move(ending.text));
  }
}

bool is_hdf5_file(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return false;
  try {
    return read_start(file, kSignature.size()) == kSignature;
  } catch (const DataError&) {
    return false;
  }
}

const Hdf5Array* find_array(const Hdf5Group& group, std::string_view name) {
  const auto found = std::ranges::find(group.arrays, name, &Hdf5Array::name);
  return found == group.arrays.end() ? nullptr : &*found;
}

std::uint64_t count_of(const Hdf5Array& array) {
  std::uint64_t count = 1;
  for (const std::uint64_t size : array.shape) count *= size;
  return count;
}

Hdf5File::Hdf5File(std::filesystem::path path, std::span<const std::string_view> names)
    : path_(std::move(path)), file_bytes_(size_of(path_)) {
  if (file_bytes_ == 0) throw DataError(path_, "is empty", kExpected);
  if (file_bytes_ < kSignature.size() || read_start(path_, kSignature.size()) != kSignature) {
    throw DataError(path_, "does not begin as a file of HDF5", kExpected);
  }
  const Hdf5Functions& functions = hdf5_functions(path_);
  const CopyAnswer listing = in_process_copy([&] {
    std::vector<Hdf5Group> groups;
    std::string mark;
    throw_if_failed(functions.list(path_, names, groups, mark));
    return packed(groups, mark);
  });
  const std::string bytes = answer_of(listing, path_);
  ByteCursor cursor(bytes, path_, "the list of its groups");
  mark_ = cursor.take_counted();
  groups_ = unpacked(cursor);
  for (const Hdf5Group& group : groups_) {
    for (const Hdf5Array& array : group.arrays) check(group, array);
  }
}

/// A damaged file may claim more than there is.
void Hdf5File::check(const Hdf5Group& group, const Hdf5Array& array) const {
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t bytes = array.number.bytes;
  for (const std::uint64_t size : array.shape) {
    bytes = size != 0 && bytes > kMost / size ? kMost : bytes * size;
  }
  const bool fits = array.is_plain ? bytes <= file_bytes_ && array.at_bytes <= file_bytes_ - bytes
                                   : bytes / kMostPacked <= file_bytes_;
  if (fits) return;
  throw DataError(
      path_, fmt::format("{}/{} claims {} bytes", shown_in_line(group.name), array.name, bytes),
      "no more than the file holds");
}

std::string Hdf5File::bytes_of(const Hdf5Group& group, const Hdf5Array& array) const {
  const std::uint64_t bytes = count_of(array) * array.number.bytes;
  if (array.is_plain) return read_part(path_, array.at_bytes, bytes);
  const Hdf5Functions& functions = hdf5_functions(path_);
  std::string read = answer_of(in_process_copy([&] {
                                 std::string numbers;
                                 throw_if_failed(functions.read(path_, group.name, array, numbers));
                                 return numbers;
                               }),
                               path_);
  if (read.size() == bytes) return read;
  throw DataError(path_, fmt::format("{}/{} has changed", group.name, array.name),
                  "as it was opened");
}

template <typename Value>
std::vector<Value> Hdf5File::numbers(const Hdf5Group& group, const Hdf5Array& array) const {
  const std::string bytes = bytes_of(group, array);
  if (array.number.kind != Kind::kReal) return converted<Value>(bytes, array.number);
  return array.number.bytes == sizeof(float) ? converted<float, Value>(bytes)
                                             : converted<double, Value>(bytes);
}

std::vector<double> Hdf5File::reals(const Hdf5Group& group, const Hdf5Array& array) const {
  return numbers<double>(group, array);
}

std::vector<float> Hdf5File::floats(const Hdf5Group& group, const Hdf5Array& array) const {
  return numbers<float>(group, array);
}

std::vector<std::int64_t> Hdf5File::integers(const Hdf5Group& group, const Hdf5Array& array) const {
  if (array.number.kind == Kind::kReal) {
    throw DataError(path_, fmt::format("{}/{} holds reals", shown_in_line(group.name), array.name),
                    "integers or truth values");
  }
  return converted<std::int64_t>(bytes_of(group, array), array.number);
}

bool others_have_marks(const std::filesystem::path& file) {
  if (!mark_in(file.parent_path()).is_set()) return false;
  std::error_code ignored;
  const std::filesystem::directory_iterator others(file.parent_path(), ignored);
  return std::any_of(begin(others), end(others), [&](const auto& other) {
    if (other.path() == file || other.path().extension() != file.extension()) return false;
    try {
      return !Hdf5File(other.path(), {}).mark().empty();
    } catch (const DataError&) {  // which fails where it is needed
      return false;
    }
  });
}

}  // namespace mosbench
