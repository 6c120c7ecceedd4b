#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>

#include "datasets/disk/files.hpp"
#include "datasets/rosbag/bag_reader.hpp"
#include "datasets/rosbag/chunk_reader.hpp"
#include "datasets/rosbag/message_format.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

/// How the journal of a transaction that is not finished begins.
constexpr std::string_view kJournalStart{"\xD9\xD5\x05\xF9\x20\xA1\x63\xD7", 8};
constexpr const char* kDatabase = "a ROS 2 bag with the tables topics and messages";

/// A query whose rows are taken one after the other.
class Rows {
 public:
  Rows(sqlite3* database, const char* query) {
    prepared_ = sqlite3_prepare_v2(database, query, -1, &statement_, nullptr);
  }
  ~Rows() { sqlite3_finalize(statement_); }
  Rows(const Rows&) = delete;
  Rows& operator=(const Rows&) = delete;

  /// Returns SQLITE_ROW, SQLITE_DONE or an error.
  int next() { return prepared_ == SQLITE_OK ? sqlite3_step(statement_) : prepared_; }
  std::int64_t integer(int column) { return sqlite3_column_int64(statement_, column); }
  std::string text(int column) {
    const auto* bytes = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
    const auto count = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column));
    return bytes == nullptr ? std::string() : std::string(bytes, count);
  }

 private:
  sqlite3_stmt* statement_ = nullptr;
  int prepared_;
};

/// The path as SQLite's URI wants it.
std::string uri_of(const std::filesystem::path& file, bool is_immutable) {
  const std::filesystem::path whole = std::filesystem::absolute(file);
  std::string uri = "file:";
  for (const char byte : whole.native()) {
    const bool is_special = byte == '%' || byte == '?' || byte == '#';
    uri += is_special ? fmt::format("%{:02X}", static_cast<unsigned char>(byte))
                      : std::string(1, byte);
  }
  return uri + (is_immutable ? "?immutable=1" : "");
}

/// Files of strangers must neither run code nor write.
void distrust(sqlite3* database) {
  sqlite3_db_config(database, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(database, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_exec(database, "PRAGMA cell_size_check=ON", nullptr, nullptr, nullptr);
}

/// A ROS 2 bag in one database of SQLite (.db3), whose messages may each be packed by Zstandard.
class SqliteBag : public BagReader {
 public:
  /// Throws DataError for a file that is no such database.
  explicit SqliteBag(const std::filesystem::path& file)
      : BagReader(file), file_bytes_(size_of(file)) {
    refuse_unfinished();
    open_database();
    read_tables();
  }

  /// The same of the content of such a file, which outlives it. May change what its head says of a
  /// log.
  SqliteBag(const std::filesystem::path& file, std::span<unsigned char> content)
      : BagReader(file), file_bytes_(content.size()) {
    sqlite3* opened = nullptr;
    const int result =
        sqlite3_open_v2(":memory:", &opened, SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX, nullptr);
    database_.reset(opened);
    check(result);
    // A database that was written with a log says so after it was closed, and would not be taken.
    constexpr std::size_t kWriteVersion = 18, kReadVersion = 19;
    constexpr unsigned char kLog = 2, kNoLog = 1;
    if (content.size() > kReadVersion && content[kWriteVersion] == kLog &&
        content[kReadVersion] == kLog) {
      content[kWriteVersion] = content[kReadVersion] = kNoLog;
    }
    const auto bytes = static_cast<sqlite3_int64>(content.size());
    check(sqlite3_deserialize(opened, "main", content.data(), bytes, bytes,
                              SQLITE_DESERIALIZE_READONLY));
    distrust(opened);
    read_tables();
  }

  std::string read(const BagMessage& message, std::size_t most_bytes = SIZE_MAX) const override {
    const auto row = static_cast<std::int64_t>(message.offset_bytes);
    return unpacked_message([&](std::size_t most) { return stored(row, most); }, most_bytes, path_);
  }

 private:
  struct Close {
    void operator()(sqlite3* database) const { sqlite3_close(database); }
    void operator()(sqlite3_blob* blob) const { sqlite3_blob_close(blob); }
  };

  /// Such a journal has to be written back into the file before the file is right.
  void refuse_unfinished() const {
    const std::filesystem::path journal = path_.native() + "-journal";
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(journal, ignored)) return;
    if (read_start(journal, kJournalStart.size()) != kJournalStart) return;
    throw DataError(
        path_,
        "was left in the middle of a change, which " + journal.filename().string() + " takes back",
        "a copy of both that sqlite3 has opened once: sqlite3 COPY .tables");
  }

  void open_database() {
    // A killed recorder leaves a log beside the file, with what it did not move into it.
    const std::filesystem::path log = path_.native() + "-wal";
    std::error_code none;
    const auto log_bytes = std::filesystem::file_size(log, none);
    const bool has_log = !none && log_bytes > 0;
    sqlite3* opened = nullptr;
    const int result =
        sqlite3_open_v2(uri_of(path_, !has_log).c_str(), &opened,
                        SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX, nullptr);
    database_.reset(opened);
    check(result);
    distrust(opened);
    if (has_log) {
      remarks_.push_back(path_.filename().string() +
                         " was not closed by its recorder: its log is read, too");
      files_.push_back(log);
    }
  }

  void read_tables() {
    check_table("topics");
    check_table("messages");
    add_topics();
    add_messages();
  }

  void check_table(const char* name) const {
    const std::string query =
        fmt::format("SELECT rootpage FROM sqlite_schema WHERE type='table' AND name='{}'", name);
    Rows rows(database_.get(), query.c_str());
    const int result = rows.next();
    // Views and virtual tables, which would run code, have no page of their own.
    if (result == SQLITE_ROW && rows.integer(0) > 0) return;
    if (result != SQLITE_ROW && result != SQLITE_DONE) refuse();
    throw DataError(path_, fmt::format("has no table {}", name), kDatabase);
  }

  void add_topics() {
    Rows rows(database_.get(), "SELECT id, name, type, serialization_format FROM topics");
    int result = 0;
    while ((result = rows.next()) == SQLITE_ROW) {
      BagConnection connection;
      connection.id = static_cast<std::uint32_t>(rows.integer(0));
      connection.topic = rows.text(1);
      connection.type = ros1_type(rows.text(2));
      connection.encoding = MessageEncoding::kCdr;
      // Another name, so that nothing parses it and errors tell it.
      if (rows.text(3) != "cdr") connection.type += " as " + rows.text(3);
      const std::uint32_t id = connection.id;
      if (!add(std::move(connection))) {
        throw DataError(path_, fmt::format("has two topics {}", id), kDatabase);
      }
    }
    if (result != SQLITE_DONE) refuse();
  }

  void add_messages() {
    struct Column {
      const char* name;
      const char* type;
      const char* expected;
    };
    constexpr std::array kColumns = {Column{"topic_id", "integer", "the number of a topic"},
                                     Column{"timestamp", "integer", "nanoseconds"},
                                     Column{"data", "blob", "the bytes of a message"}};
    Rows rows(
        database_.get(),
        "SELECT rowid, topic_id, timestamp, typeof(topic_id), typeof(timestamp), typeof(data) "
        "FROM messages");
    int result = 0;
    while ((result = rows.next()) == SQLITE_ROW) {
      // SQLite would give 0 for what is no number.
      for (int i = 0; const Column& column : kColumns) {
        const std::string type = rows.text(3 + i++);
        if (type == column.type) continue;
        throw DataError(path_,
                        fmt::format("row {} of messages has {} in place of its {}", rows.integer(0),
                                    type, column.name),
                        column.expected);
      }
      const auto topic = static_cast<std::uint32_t>(rows.integer(1));
      messages_.push_back({topic, rows.integer(2), 0, static_cast<std::uint64_t>(rows.integer(0))});
      if (find_connection(topic) == nullptr) {
        throw DataError(path_, fmt::format("topic {} of a message is missing", topic), kDatabase);
      }
    }
    if (result != SQLITE_DONE) refuse();
  }

  void check(int result) const {
    if (result != SQLITE_OK) refuse();
  }

  [[noreturn]] void refuse() const {
    const bool has_log = files_.size() > 1;
    throw DataError(path_, fmt::format("cannot be read ({})", sqlite3_errmsg(database_.get())),
                    has_log ? std::string(kDatabase) + ", in a folder where its log may be indexed"
                            : kDatabase);
  }

  void seek(std::int64_t row) const {
    if (blob_) {
      check(sqlite3_blob_reopen(blob_.get(), row));
      return;
    }
    sqlite3_blob* opened = nullptr;
    const int result =
        sqlite3_blob_open(database_.get(), "main", "messages", "data", row, 0, &opened);
    blob_.reset(opened);
    check(result);
  }

  std::string stored(std::int64_t row, std::size_t most_bytes) const {
    const std::lock_guard lock(mutex_);
    seek(row);
    const auto count = static_cast<std::uint64_t>(sqlite3_blob_bytes(blob_.get()));
    // A damaged row may claim more than there is.
    if (count > file_bytes_ && files_.size() == 1) {
      throw DataError(path_, fmt::format("message {} claims {} bytes", row, count),
                      "no more than the file has");
    }
    std::string bytes(std::min<std::uint64_t>(count, most_bytes), '\0');
    check(sqlite3_blob_read(blob_.get(), bytes.data(), static_cast<int>(bytes.size()), 0));
    return bytes;
  }

  std::uint64_t file_bytes_;
  std::unique_ptr<sqlite3, Close> database_;
  mutable std::mutex mutex_;                           ///< of database_ and blob_
  mutable std::unique_ptr<sqlite3_blob, Close> blob_;  ///< column `data` of some row
};

}  // namespace

std::unique_ptr<const BagReader> open_sqlite_bag(const std::filesystem::path& file) {
  return std::make_unique<SqliteBag>(file);
}

std::unique_ptr<const BagReader> open_sqlite_bag(const std::filesystem::path& file,
                                                 std::span<unsigned char> content) {
  return std::make_unique<SqliteBag>(file, content);
}

}  // namespace mosbench
