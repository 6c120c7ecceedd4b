#include <sqlite3.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>

#include "datasets/disk/partial_file.hpp"
#include "datasets/rosbag/chunk_reader.hpp"
#include "datasets/rosbag/ros2_bag.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

constexpr const char* kTables =
    "PRAGMA journal_mode=OFF; PRAGMA synchronous=OFF; BEGIN;"
    "CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);"
    "INSERT INTO schema VALUES(3, 'humble');"
    "CREATE TABLE metadata(id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL, "
    "metadata TEXT NOT NULL);"
    "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
    "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
    "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, "
    "timestamp INTEGER NOT NULL, data BLOB NOT NULL);"
    "CREATE INDEX timestamp_idx ON messages (timestamp ASC);";

/// Writes a database of SQLite with the tables of rosbag2, version 3.
class SqliteBagWriter : public Ros2BagWriter {
 public:
  /// `compression` is "" or "zstd".
  SqliteBagWriter(const std::filesystem::path& folder, const std::string& compression)
      : Ros2BagWriter(folder,
                      {"sqlite3", message_file_of(Ros2Storage::kSqlite), compression, 0, 0, {}}),
        partial_(partial_of(file())) {
    // What a killed run left.
    std::error_code ignored;
    std::filesystem::remove(partial_, ignored);
    sqlite3* opened = nullptr;
    const int result = sqlite3_open_v2(partial_.c_str(), &opened,
                                       SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
    database_.reset(opened);
    try {
      check(result);
      run(kTables);
      insertion_ = prepared("INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)");
    } catch (const DataError&) {
      database_.reset();
      std::filesystem::remove(partial_, ignored);
      throw;
    }
  }

  ~SqliteBagWriter() override {
    insertion_.reset();
    database_.reset();
    std::error_code ignored;
    std::filesystem::remove(partial_, ignored);
  }

 private:
  struct Close {
    void operator()(sqlite3* database) const { sqlite3_close(database); }
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };

  void append(std::size_t topic, bool is_new, std::int64_t stamp_ns,
              std::string_view message) override {
    if (is_new) add_topic(topic);
    const bool packs = !summary().compression.empty();
    const std::string stored = packs ? compress_zstd(message) : std::string(message);
    check(sqlite3_bind_int64(insertion_.get(), 1, static_cast<sqlite3_int64>(topic + 1)));
    check(sqlite3_bind_int64(insertion_.get(), 2, stamp_ns));
    check(sqlite3_bind_blob64(insertion_.get(), 3, stored.data(), stored.size(), nullptr));
    check(sqlite3_step(insertion_.get()));
    check(sqlite3_reset(insertion_.get()));
  }

  void end() override {
    insertion_.reset();
    run("COMMIT");
    check(sqlite3_close(database_.get()));
    database_.release();
  }

  void put_in_place() override {
    sync_file_system_of(partial_.parent_path());
    write_by(file(), [&] { std::filesystem::rename(partial_, file()); });
    sync_names_of(partial_.parent_path());
  }

  void check(int result) const {
    if (result == SQLITE_OK || result == SQLITE_DONE) return;
    throw not_written(file(), sqlite3_errmsg(database_.get()));
  }

  void run(const char* statements) const {
    check(sqlite3_exec(database_.get(), statements, nullptr, nullptr, nullptr));
  }

  std::unique_ptr<sqlite3_stmt, Close> prepared(const char* statement) const {
    sqlite3_stmt* made = nullptr;
    check(sqlite3_prepare_v2(database_.get(), statement, -1, &made, nullptr));
    return std::unique_ptr<sqlite3_stmt, Close>(made);
  }

  void add_topic(std::size_t topic) const {
    const TopicCount& of = summary().topics.at(topic);
    const auto insertion = prepared("INSERT INTO topics VALUES(?, ?, ?, 'cdr', '')");
    check(sqlite3_bind_int64(insertion.get(), 1, static_cast<sqlite3_int64>(topic + 1)));
    check(sqlite3_bind_text(insertion.get(), 2, of.name.c_str(), -1, nullptr));
    check(sqlite3_bind_text(insertion.get(), 3, of.type.c_str(), -1, nullptr));
    check(sqlite3_step(insertion.get()));
  }

  std::filesystem::path partial_;
  std::unique_ptr<sqlite3, Close> database_;
  std::unique_ptr<sqlite3_stmt, Close> insertion_;
};

}  // namespace

std::unique_ptr<Ros2BagWriter> open_sqlite_writer(const std::filesystem::path& folder,
                                                  const std::string& compression) {
  return std::make_unique<SqliteBagWriter>(folder, compression);
}

}  // namespace mosbench
