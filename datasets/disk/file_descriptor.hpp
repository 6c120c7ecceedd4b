#pragma once

#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

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

}  // namespace mosbench
