#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/disk/file_descriptor.hpp"
#include "datasets/rosbag/bag_reader.hpp"

namespace mosbench {

/// A bag that is packed as a whole by Zstandard. It is unpacked into the folder of temporary files
/// (TMPDIR). Its name there is removed before anything is written: no bag is left, however the
/// process ends.
class UnpackedBag : public BagReader {
 public:
  /// Throws DataError.
  explicit UnpackedBag(const std::filesystem::path& file);
  ~UnpackedBag() override;

  std::vector<BagMessage> messages(std::string_view topic) const override;
  std::string read(const BagMessage& message, std::size_t most_bytes = SIZE_MAX) const override;

 private:
  /// Returns what `work` does with the unpacked bag; its errors name the file that the user knows.
  template <typename Work>
  auto naming_file(Work&& work) const;

  /// The content of a file, which must not become shorter; changes stay in this process.
  class Mapping {
   public:
    /// Throws std::system_error.
    explicit Mapping(const FileDescriptor& file);
    ~Mapping();
    Mapping(const Mapping&) = delete;
    Mapping& operator=(const Mapping&) = delete;
    std::span<unsigned char> content() const { return content_; }

   private:
    std::span<unsigned char> content_;
  };

  std::unique_ptr<const BagReader> opened(const std::filesystem::path& unpacked);

  FileDescriptor unpacked_;
  std::unique_ptr<const Mapping> mapping_;  ///< of a database
  std::unique_ptr<const BagReader> bag_;
};

}  // namespace mosbench
