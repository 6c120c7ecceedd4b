#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <istream>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

/// One row of a table of nuScenes: an object of JSON whose values are texts, numbers, truth values
/// or lists of texts or numbers.
class NuscenesRow {
 public:
  bool has(std::string_view key) const;
  /// Return the value of a key. Throw DataError naming the file and the row, from 0, where the key
  /// is missing or holds something else, numbers that are not finite or another count of them.
  const std::string& text(std::string_view key) const;
  bool flag(std::string_view key) const;
  std::int64_t integer(std::string_view key) const;
  const std::vector<double>& numbers(std::string_view key, std::size_t count) const;
  const std::vector<std::string>& texts(std::string_view key) const;

  [[noreturn]] void refuse(const std::string& wrong, const std::string& expected) const;

 private:
  friend class NuscenesRowReader;

  enum class Kind : std::uint8_t { kOther, kText, kFlag, kInteger, kNumber, kList };
  struct Value {
    std::string key;
    Kind kind = Kind::kOther;
    std::string text;
    std::int64_t integer = 0;  ///< 0 or 1 of a flag
    std::vector<double> numbers;
    std::vector<std::string> texts;
    bool all_numbers = true, all_texts = true;  ///< of a list
  };

  const Value& value(std::string_view key, Kind kind, const char* expected) const;

  const std::filesystem::path* file_ = nullptr;
  std::size_t index_ = 0;
  std::size_t size_ = 0;  ///< of `values_` in use: its memory is that of the rows before
  std::vector<Value> values_;
};

/// Calls `take` with every row of a table, one after the other, and keeps none: tables of the full
/// data set are gigabytes. Throws DataError for what is no JSON or no list of such rows, and for a
/// key that is there twice in a row.
void parse_nuscenes_table(std::istream& bytes, const std::filesystem::path& file,
                          const std::function<void(const NuscenesRow&)>& take);
void read_nuscenes_table(const std::filesystem::path& file,
                         const std::function<void(const NuscenesRow&)>& take);

}  // namespace mosbench
