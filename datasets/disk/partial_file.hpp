#pragma once

#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "datasets/text/errors.hpp"

namespace mosbench {

/// Throws std::system_error with the errno of a call that failed.
inline void require_success(bool succeeded) {
  if (!succeeded) throw std::system_error(errno, std::generic_category());
}

/// Owns an open file by its number, and closes it.
class FileDescriptor {
 public:
  FileDescriptor() = default;
  explicit FileDescriptor(int number) : number_(number) {}
  FileDescriptor(FileDescriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~FileDescriptor() {
    if (is_open()) ::close(number_);
  }

  bool is_open() const { return number_ >= 0; }
  int number() const { return number_; }
  int release() { return std::exchange(number_, -1); }

 private:
  int number_ = -1;
};

/// Waits until the names in a folder are on the disk, so that a file that was renamed there
/// survives a power cut. Throws DataError.
void sync_names_of(const std::filesystem::path& folder);

/// Waits until the file system of `folder` has brought to the disk all that was written so far. For
/// a folder of thousands of files this takes a small part of waiting for each. Throws DataError.
void sync_file_system_of(const std::filesystem::path& folder);

/// Returns the name of the file or folder that is written and will replace `path`. Nothing reads
/// files or folders that end in ".partial".
std::filesystem::path partial_of(const std::filesystem::path& path);

/// Returns whether `name` is that of a file that is being written and will replace `file`.
bool is_partial_of(const std::string& name, const std::string& file);

/// A file that is written beside the one that it will replace. No two writers share one. Its name
/// is partial_of(file), locked while its writer lives and taken over after a killed one. While
/// another process writes that, it has a name with process id and random digits. All functions
/// throw std::system_error.
class PartialFile {
 public:
  explicit PartialFile(const std::filesystem::path& file);
  /// Removes what was not put in place.
  ~PartialFile();
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;

  /// Where a library may write that takes names.
  const std::filesystem::path& path() const { return path_; }
  void write(std::string_view bytes) const;
  /// Waits until the bytes are on the disk.
  void sync() const;
  void put_in_place_of(const std::filesystem::path& file);

 private:
  std::filesystem::path path_;
  FileDescriptor descriptor_;
};

/// Writes all bytes to an open file, pipe or device; throws std::system_error.
void write_bytes(int descriptor, std::string_view bytes);

/// Returns the error of a file that cannot be written, and why.
DataError not_written(const std::filesystem::path& file, const std::string& why);

/// Writes a file by `call`, whose std::system_error becomes `not_written`.
template <typename Call>
void write_by(const std::filesystem::path& file, Call&& call) {
  try {
    call();
  } catch (const std::system_error& error) {
    throw not_written(file, error.code().message());
  }
}

}  // namespace mosbench
