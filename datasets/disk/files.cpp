#include "datasets/disk/files.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

#include "datasets/disk/partial_file.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using OpenFile = std::unique_ptr<std::FILE, FileCloser>;

/// Of a pointer of Git LFS.
constexpr std::uintmax_t kMostPointerBytes = 1024;

std::string reason(int error_number) { return std::strerror(error_number); }

void refuse_folder(const std::filesystem::path& file) {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) throw DataError(file, "is a folder", "a file");
}

/// Git leaves a small text in the place of a file that it keeps elsewhere.
void refuse_lfs_pointer(int file_number, off_t size_bytes, const std::filesystem::path& file) {
  constexpr std::string_view kStart = "version https://git-lfs.github.com/spec/";
  std::array<char, kStart.size()> start{};
  if (size_bytes > static_cast<off_t>(kMostPointerBytes) ||
      pread(file_number, start.data(), start.size(), 0) < 0)
    return;
  if (std::string_view(start.data(), start.size()) != kStart) return;
  throw DataError(file, "is a Git LFS pointer, not the file itself",
                  "the file that `git lfs pull` puts in its place");
}

/// Does not wait for what may never come, as from a FIFO.
OpenFile open_to_read(const std::filesystem::path& file) {
  FileDescriptor opened(open(file.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  struct stat found {};
  if (!opened.is_open() || fstat(opened.number(), &found) != 0) {
    throw DataError(file, "cannot be opened (" + reason(errno) + ")", "a readable file");
  }
  if (S_ISDIR(found.st_mode)) throw DataError(file, "is a folder", "a file");
  if (!S_ISREG(found.st_mode)) {
    throw DataError(file, "is a pipe or device", "a regular file; write its bytes to one first");
  }
  refuse_lfs_pointer(opened.number(), found.st_size, file);
  return OpenFile(fdopen(opened.release(), "rb"));
}

void check_reading(std::FILE* in, const std::filesystem::path& file) {
  if (std::ferror(in) == 0) return;
  throw DataError(file, "cannot be read to its end (" + reason(errno) + ")", "a readable file");
}

}  // namespace

bool is_there(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::exists(path, ignored);
}

std::string read_file(const std::filesystem::path& file) {
  const OpenFile in = open_to_read(file);
  std::string bytes;
  std::error_code error;
  const auto size_on_disk = std::filesystem::file_size(file, error);
  // One byte more than the file, so that its end is reached without growing the buffer.
  std::size_t room = error ? 65536 : static_cast<std::size_t>(size_on_disk) + 1;
  std::size_t used = 0;
  while (true) {
    bytes.resize(used + room);
    const std::size_t got = std::fread(bytes.data() + used, 1, room, in.get());
    used += got;
    if (got < room) break;
    room = bytes.size();
  }
  check_reading(in.get(), file);
  bytes.resize(used);
  return bytes;
}

std::string read_start(const std::filesystem::path& file, std::size_t most_bytes) {
  const OpenFile in = open_to_read(file);
  std::string bytes(most_bytes, '\0');
  bytes.resize(std::fread(bytes.data(), 1, bytes.size(), in.get()));
  check_reading(in.get(), file);
  return bytes;
}

std::string read_part(const std::filesystem::path& file, std::uint64_t from_bytes,
                      std::uint64_t bytes) {
  const OpenFile in = open_to_read(file);
  std::string part(bytes, '\0');
  if (fseeko(in.get(), static_cast<off_t>(from_bytes), SEEK_SET) == 0 &&
      std::fread(part.data(), 1, part.size(), in.get()) == bytes) {
    return part;
  }
  check_reading(in.get(), file);
  throw DataError(file, "is shorter than when it was opened",
                  std::to_string(from_bytes + bytes) + " bytes");
}

std::string read_head(const std::filesystem::path& file, std::string_view last_line) {
  constexpr std::size_t kStepBytes = 4096;
  const OpenFile in = open_to_read(file);
  std::string start_of_last(1, '\n');
  start_of_last += last_line;
  std::string bytes;
  std::size_t searched = 0;
  while (true) {
    const std::size_t used = bytes.size();
    bytes.resize(used + kStepBytes);
    bytes.resize(used + std::fread(bytes.data() + used, 1, kStepBytes, in.get()));
    const std::size_t last = bytes.find(start_of_last, searched);
    const bool has_last = last != bytes.npos && bytes.find('\n', last + 1) != bytes.npos;
    if (has_last || bytes.size() < used + kStepBytes) break;
    // The line may be split between two steps.
    searched = std::min(last, bytes.size() - std::min(bytes.size(), start_of_last.size()));
  }
  check_reading(in.get(), file);
  return bytes;
}

void read_file(const std::filesystem::path& file, std::span<std::byte> bytes) {
  const OpenFile in = open_to_read(file);
  const std::size_t got = bytes.empty() ? 0 : std::fread(bytes.data(), 1, bytes.size(), in.get());
  const bool ends = got == bytes.size() && std::fgetc(in.get()) == EOF;
  check_reading(in.get(), file);
  if (ends) return;
  throw DataError(file, "changed while it was read", std::to_string(bytes.size()) + " bytes");
}

std::uintmax_t size_of(const std::filesystem::path& file) {
  std::error_code error;
  const std::uintmax_t size_bytes = std::filesystem::file_size(file, error);
  if (!error && size_bytes <= kMostPointerBytes) open_to_read(file);  // refuses a pointer
  if (!error) return size_bytes;
  refuse_folder(file);
  throw DataError(file, "cannot be opened (" + error.message() + ")", "a readable file");
}

}  // namespace mosbench
