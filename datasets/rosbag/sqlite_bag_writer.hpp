#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "datasets/rosbag/ros2_bag_writer.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace mosbench {

/// Writes a database of SQLite with the tables of rosbag2, version 3.
class SqliteBagWriter : public Ros2BagWriter {
 public:
  /// `compression` is "" or "zstd".
  SqliteBagWriter(const std::filesystem::path& folder, const std::string& compression);
  ~SqliteBagWriter() override;

 private:
  struct Close {
    void operator()(sqlite3* database) const;
    void operator()(sqlite3_stmt* statement) const;
  };

  void append(std::size_t topic, bool is_new, std::int64_t stamp_ns,
              std::string_view message) override;
  void end() override;
  void put_in_place() override;

  void check(int result) const;
  void run(const char* statements) const;
  std::unique_ptr<sqlite3_stmt, Close> prepared(const char* statement) const;
  void add_topic(std::size_t topic) const;

  std::filesystem::path partial_;
  std::unique_ptr<sqlite3, Close> database_;
  std::unique_ptr<sqlite3_stmt, Close> insertion_;
};

}  // namespace mosbench
