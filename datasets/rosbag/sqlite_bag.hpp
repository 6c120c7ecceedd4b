#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/rosbag/bag_reader.hpp"

struct sqlite3;
struct sqlite3_blob;

namespace mosbench {

/// A ROS 2 bag in one database of SQLite (.db3), whose messages may each be packed by Zstandard.
class SqliteBag : public BagReader {
 public:
  /// Throws DataError for a file that is no such database.
  explicit SqliteBag(const std::filesystem::path& file);
  /// The same of the content of such a file, which outlives it. May change what its head says of a
  /// log.
  SqliteBag(const std::filesystem::path& file, std::span<unsigned char> content);
  ~SqliteBag() override;

  std::vector<BagMessage> messages(std::string_view topic) const override;
  std::string read(const BagMessage& message, std::size_t most_bytes = SIZE_MAX) const override;

 private:
  struct Close {
    void operator()(sqlite3* database) const;
    void operator()(sqlite3_blob* blob) const;
  };

  void refuse_unfinished() const;
  void open_database();
  void read_tables();
  void check_table(const char* name) const;
  void add_topics();
  void add_messages();
  void check(int result) const;
  [[noreturn]] void refuse() const;
  void seek(std::int64_t row) const;
  std::string stored(std::int64_t row, std::size_t most_bytes) const;

  std::uint64_t file_bytes_;
  std::unique_ptr<sqlite3, Close> database_;
  mutable std::mutex mutex_;                           ///< of database_ and blob_
  mutable std::unique_ptr<sqlite3_blob, Close> blob_;  ///< column `data` of some row
  std::vector<BagMessage> messages_;
};

}  // namespace mosbench
