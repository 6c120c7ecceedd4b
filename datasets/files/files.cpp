#include "datasets/files/files.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

#include "datasets/files/errors.hpp"

namespace mosbench {
namespace {

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using OpenFile = std::unique_ptr<std::FILE, FileCloser>;

std::string reason(int error_number) { return std::strerror(error_number); }

void make_parent_folder(const std::filesystem::path& file) {
  if (!file.has_parent_path()) return;
  std::error_code error;
  std::filesystem::create_directories(file.parent_path(), error);
  if (error) {
    throw DataError(file, "its folder cannot be created (" + error.message() + ")",
                    "a writable output folder");
  }
}

/// Returns 0, or the errno of the first step that failed. A full disk may be reported only when the
/// buffers are flushed, hence the check of fclose.
int write_whole(const std::filesystem::path& file, std::string_view bytes) {
  OpenFile out(std::fopen(file.c_str(), "wb"));
  if (!out) return errno;
  // An empty view may be null, which fwrite does not accept.
  if (!bytes.empty() && std::fwrite(bytes.data(), 1, bytes.size(), out.get()) != bytes.size()) {
    return errno;
  }
  return std::fclose(out.release()) == 0 ? 0 : errno;
}

void refuse_folder(const std::filesystem::path& file) {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) throw DataError(file, "is a folder", "a file");
}

OpenFile open_to_read(const std::filesystem::path& file) {
  refuse_folder(file);
  OpenFile in(std::fopen(file.c_str(), "rb"));
  if (!in) throw DataError(file, "cannot be opened (" + reason(errno) + ")", "a readable file");
  return in;
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
  if (!error) return size_bytes;
  refuse_folder(file);
  throw DataError(file, "cannot be opened (" + error.message() + ")", "a readable file");
}

void write_file_atomic(const std::filesystem::path& file, std::string_view bytes) {
  make_parent_folder(file);
  std::filesystem::path partial = file;
  partial += ".partial";
  int failure = write_whole(partial, bytes);
  if (failure == 0 && std::rename(partial.c_str(), file.c_str()) != 0) failure = errno;
  if (failure == 0) return;
  std::error_code ignored;
  std::filesystem::remove(partial, ignored);
  throw DataError(file, "cannot be written (" + reason(failure) + ")",
                  "a writable output folder with free space");
}

}  // namespace mosbench
