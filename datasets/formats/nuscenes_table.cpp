#include "datasets/formats/nuscenes_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/json_text.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {

void NuscenesRow::refuse(const std::string& wrong, const std::string& expected) const {
  throw DataError(*file_, index_, wrong, expected);
}

const NuscenesRow::Value& NuscenesRow::value(std::string_view key, Kind kind,
                                             const char* expected) const {
  const auto end = values_.begin() + static_cast<std::ptrdiff_t>(size_);
  const auto found =
      std::find_if(values_.begin(), end, [key](const Value& value) { return value.key == key; });
  if (found == end) refuse(fmt::format("has no \"{}\"", key), expected);
  if (found->kind != kind) refuse(fmt::format("\"{}\" is of another kind", key), expected);
  return *found;
}

bool NuscenesRow::has(std::string_view key) const {
  const auto end = values_.begin() + static_cast<std::ptrdiff_t>(size_);
  return std::any_of(values_.begin(), end, [key](const Value& value) { return value.key == key; });
}

const std::string& NuscenesRow::text(std::string_view key) const {
  return value(key, Kind::kText, "a text").text;
}

bool NuscenesRow::flag(std::string_view key) const {
  return value(key, Kind::kFlag, "true or false").integer != 0;
}

std::int64_t NuscenesRow::integer(std::string_view key) const {
  return value(key, Kind::kInteger, "a whole number").integer;
}

const std::vector<double>& NuscenesRow::numbers(std::string_view key, std::size_t count) const {
  const std::string expected = fmt::format("a list of {} finite numbers", count);
  const Value& list = value(key, Kind::kList, expected.c_str());
  if (!list.all_numbers || list.numbers.size() != count) {
    refuse(fmt::format("\"{}\" is another list", key), expected);
  }
  return list.numbers;
}

const std::vector<std::string>& NuscenesRow::texts(std::string_view key) const {
  const Value& list = value(key, Kind::kList, "a list of texts");
  if (!list.all_texts) refuse(fmt::format("\"{}\" is another list", key), "a list of texts");
  return list.texts;
}

/// Fills one row after the other with what the parser finds. Levels: 0 outside, 1 in the table, 2
/// in a row, 3 in a list of it; deeper nothing is taken.
class NuscenesRowReader final : public nlohmann::json_sax<nlohmann::json> {
 public:
  NuscenesRowReader(const std::filesystem::path& file,
                    const std::function<void(const NuscenesRow&)>& take)
      : file_(file), take_(take) {
    row_.file_ = &file_;
  }

  bool null() override { return scalar(Kind::kOther); }
  bool boolean(bool value) override {
    if (level_ == kInRow) current().integer = value ? 1 : 0;
    return scalar(Kind::kFlag);
  }
  bool number_integer(number_integer_t value) override {
    if (level_ == kInRow) current().integer = value;
    if (level_ == kInList) current().numbers.push_back(static_cast<double>(value));
    return scalar(Kind::kInteger);
  }
  bool number_unsigned(number_unsigned_t value) override {
    constexpr auto kMost = static_cast<number_unsigned_t>(std::numeric_limits<std::int64_t>::max());
    if (value > kMost) return number_float(static_cast<double>(value), "");
    return number_integer(static_cast<std::int64_t>(value));
  }
  bool number_float(number_float_t value, const string_t&) override {
    if (level_ == kInList) current().numbers.push_back(value);
    return scalar(Kind::kNumber);
  }
  bool string(string_t& value) override {
    if (level_ == kInRow) current().text = value;
    if (level_ == kInList) current().texts.push_back(value);
    return scalar(Kind::kText);
  }
  bool binary(binary_t&) override { return false; }

  bool start_object(std::size_t) override {
    if (level_ == kInTable) {
      row_.size_ = 0;
    } else {
      nest();
    }
    ++level_;
    return true;
  }
  bool key(string_t& name) override {
    if (level_ != kInRow) return true;
    auto& values = row_.values_;
    for (std::size_t i = 0; i < row_.size_; ++i) {
      if (values[i].key == name)
        row_.refuse("key " + mosbench::quoted(name) + " is there twice", "one");
    }
    if (row_.size_ == kMostKeys)
      row_.refuse("has more than " + std::to_string(kMostKeys) + " keys", "fewer");
    if (row_.size_ == values.size()) values.emplace_back();
    NuscenesRow::Value& value = values[row_.size_++];
    value.key = name;
    value.numbers.clear();
    value.texts.clear();
    value.all_numbers = value.all_texts = true;
    return true;
  }
  bool end_object() override {
    if (--level_ == kInTable) {
      take_(row_);
      ++row_.index_;
    }
    return true;
  }
  bool start_array(std::size_t) override {
    if (level_ == kInRow) current().kind = Kind::kList;
    if (level_ != kOutside && level_ != kInRow) nest();
    ++level_;
    return true;
  }
  bool end_array() override {
    --level_;
    return true;
  }

  bool parse_error(std::size_t, const std::string&,
                   const nlohmann::json::exception& error) override {
    // It names the line itself, which is no index of a row.
    throw DataError(file_, "is no JSON (" + mosbench::sentence_of(error) + ")", "JSON");
  }

 private:
  using Kind = NuscenesRow::Kind;
  static constexpr std::size_t kMostKeys = 1000;
  static constexpr int kOutside = 0, kInTable = 1, kInRow = 2, kInList = 3;

  NuscenesRow::Value& current() { return row_.values_[row_.size_ - 1]; }

  /// Notes the kind of a value of a row, or that of an element of a list.
  bool scalar(Kind kind) {
    if (level_ <= kInTable) refuse_table();
    if (level_ == kInRow) current().kind = kind;
    if (level_ != kInList) return true;
    NuscenesRow::Value& list = current();
    list.all_numbers = list.all_numbers && (kind == Kind::kInteger || kind == Kind::kNumber);
    list.all_texts = list.all_texts && kind == Kind::kText;
    return true;
  }
  /// What lies deeper is not taken, and makes a list neither one of texts nor one of numbers.
  void nest() {
    if (level_ <= kInTable) refuse_table();
    if (level_ == kInRow) current().kind = Kind::kOther;
    if (level_ == kInList) current().all_numbers = current().all_texts = false;
  }
  [[noreturn]] void refuse_table() const {
    throw DataError(file_, row_.index_, "is no row of a table", "a list of JSON objects");
  }

  const std::filesystem::path& file_;
  const std::function<void(const NuscenesRow&)>& take_;
  NuscenesRow row_;
  int level_ = kOutside;
};

void parse_nuscenes_table(std::istream& bytes, const std::filesystem::path& file,
                          const std::function<void(const NuscenesRow&)>& take) {
  NuscenesRowReader reader(file, take);
  nlohmann::json::sax_parse(bytes, &reader);
  // The library takes a NUL for the end.
  if (!bytes.eof()) throw DataError(file, "is no JSON (it holds a NUL)", "JSON");
}

void read_nuscenes_table(const std::filesystem::path& file,
                         const std::function<void(const NuscenesRow&)>& take) {
  if (!is_there(file)) throw DataError(file, "is not there", "a table of nuScenes");
  // Opening a FIFO would wait for somebody who writes.
  if (!std::filesystem::is_regular_file(file)) {
    throw DataError(file, "is no regular file", "a table of nuScenes");
  }
  std::vector<char> buffer(1U << 20U);
  std::ifstream bytes;
  bytes.rdbuf()->pubsetbuf(buffer.data(), static_cast<std::streamsize>(buffer.size()));
  bytes.open(file, std::ios::binary);
  if (!bytes) throw DataError(file, "cannot be read", "a table of nuScenes");
  try {
    parse_nuscenes_table(bytes, file, take);
  } catch (const std::ios_base::failure& error) {
    throw DataError(file, fmt::format("cannot be read ({})", error.code().message()),
                    "a table of nuScenes");
  }
}

}  // namespace mosbench
