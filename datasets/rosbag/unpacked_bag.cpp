#include "datasets/rosbag/unpacked_bag.hpp"

#include <fmt/format.h>
#include <stdlib.h>
#include <unistd.h>

#include <system_error>
#include <utility>

#include "datasets/files/errors.hpp"
#include "datasets/files/file_descriptor.hpp"
#include "datasets/files/files.hpp"
#include "datasets/rosbag/bag_compression.hpp"
#include "datasets/rosbag/mcap_file.hpp"
#include "datasets/rosbag/sqlite_bag.hpp"

namespace mosbench {

UnpackedBag::TemporaryFile::TemporaryFile() {
  std::string name = std::filesystem::temp_directory_path() / "mosbench_bag_XXXXXX";
  const FileDescriptor made(mkstemp(name.data()));
  if (!made.is_open()) throw DataError(name, "cannot be made", "a writable folder in TMPDIR");
  path_ = name;
}

void UnpackedBag::TemporaryFile::remove() {
  std::error_code ignored;
  std::filesystem::remove(std::exchange(path_, {}), ignored);
}

UnpackedBag::UnpackedBag(const std::filesystem::path& file) : BagReader(file) {
  decompress_zstd_file(file, unpacked_.path());
  const std::string start = read_start(unpacked_.path(), kMcapMagic.size());
  try {
    if (start == kMcapMagic) {
      bag_ = std::make_unique<McapFile>(unpacked_.path());
    } else {
      bag_ = std::make_unique<SqliteBag>(unpacked_.path());
    }
  } catch (const DataError& error) {
    throw DataError(file, fmt::format("is unpacked to no bag ({})", error.what()),
                    "a packed .mcap or .db3");
  }
  // The bag keeps the file open. Without a name it is gone with the process, however that ends.
  unpacked_.remove();
  connections_ = bag_->connections();
  remarks_ = bag_->remarks();
}

UnpackedBag::~UnpackedBag() = default;

std::vector<BagMessage> UnpackedBag::messages(std::string_view topic) const {
  return bag_->messages(topic);
}

std::string UnpackedBag::read(const BagMessage& message, std::size_t most_bytes) const {
  return bag_->read(message, most_bytes);
}

}  // namespace mosbench
