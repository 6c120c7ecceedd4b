#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/rosbag/bag_reader.hpp"

namespace mosbench {

/// A bag whose whole file is packed by Zstandard. It is unpacked into the folder of temporary files
/// (TMPDIR), where it has no name once it is opened.
class UnpackedBag : public BagReader {
 public:
  /// Throws DataError.
  explicit UnpackedBag(const std::filesystem::path& file);
  ~UnpackedBag() override;

  std::vector<BagMessage> messages(std::string_view topic) const override;
  std::string read(const BagMessage& message, std::size_t most_bytes = SIZE_MAX) const override;

 private:
  /// A file without content that nobody else has, removed at the end or before.
  class TemporaryFile {
   public:
    TemporaryFile();
    ~TemporaryFile() { remove(); }
    void remove();
    const std::filesystem::path& path() const { return path_; }

   private:
    std::filesystem::path path_;
  };

  TemporaryFile unpacked_;
  std::unique_ptr<const BagReader> bag_;
};

}  // namespace mosbench
