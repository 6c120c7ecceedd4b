#include "datasets/rosbag/unpacked_bag.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#include <string>

#include "datasets/disk/file_descriptor.hpp"
#include "datasets/disk/files.hpp"
#include "datasets/rosbag/chunk_reader.hpp"
#include "datasets/rosbag/mcap_file.hpp"
#include "datasets/rosbag/sqlite_bag.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {

namespace {

/// Opens a file that no folder lists.
FileDescriptor nameless_file() {
  std::string name = std::filesystem::temp_directory_path() / "mosbench_bag_XXXXXX";
  FileDescriptor made(mkostemp(name.data(), O_CLOEXEC));
  if (!made.is_open() || unlink(name.c_str()) != 0) {
    throw DataError(name, "cannot be made", "a writable folder in TMPDIR");
  }
  return made;
}

/// The path by which this process opens it again.
std::filesystem::path path_of(const FileDescriptor& file) {
  return fmt::format("/proc/self/fd/{}", file.number());
}

}  // namespace

UnpackedBag::Mapping::Mapping(const FileDescriptor& file) {
  const off_t bytes = lseek(file.number(), 0, SEEK_END);
  require_success(bytes >= 0);
  if (bytes == 0) return;
  const auto size = static_cast<std::size_t>(bytes);
  void* start = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE, file.number(), 0);
  require_success(start != MAP_FAILED);
  content_ = {static_cast<unsigned char*>(start), size};
}

UnpackedBag::Mapping::~Mapping() {
  if (!content_.empty()) munmap(content_.data(), content_.size());
}

template <typename Work>
auto UnpackedBag::naming_file(Work&& work) const {
  try {
    return work();
  } catch (const DataError& error) {
    throw DataError(path_, fmt::format("is unpacked to no bag ({})", error.what()),
                    "a packed .mcap or .db3");
  }
}

UnpackedBag::UnpackedBag(const std::filesystem::path& file)
    : BagReader(file), unpacked_(nameless_file()) {
  const std::filesystem::path unpacked = path_of(unpacked_);
  decompress_zstd_file(file, unpacked);
  bag_ = naming_file([&] { return opened(unpacked); });
  connections_ = bag_->connections();
  remarks_ = bag_->remarks();
  const std::string number = unpacked.filename().string();
  for (std::string& remark : remarks_) {
    if (remark.starts_with(number)) remark.replace(0, number.size(), file.filename().string());
  }
}

UnpackedBag::~UnpackedBag() = default;

/// SQLite opens no file without a name, but takes its content.
std::unique_ptr<const BagReader> UnpackedBag::opened(const std::filesystem::path& unpacked) {
  if (read_start(unpacked, kMcapMagic.size()) == kMcapMagic) {
    return std::make_unique<McapFile>(unpacked);
  }
  mapping_ = std::make_unique<Mapping>(unpacked_);
  return std::make_unique<SqliteBag>(path_, mapping_->content());
}

std::vector<BagMessage> UnpackedBag::messages(std::string_view topic) const {
  return bag_->messages(topic);
}

std::string UnpackedBag::read(const BagMessage& message, std::size_t most_bytes) const {
  return naming_file([&] { return bag_->read(message, most_bytes); });
}

}  // namespace mosbench
