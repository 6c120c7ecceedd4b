#include "datasets/formats/npy_file.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kNpyMagic = "\x93NUMPY";
constexpr const char* kExpectedNpy = "a .npy array of booleans, integers or floats";

[[noreturn]] void refuse_npy(const fs::path& file, const std::string& wrong) {
  throw DataError(file, wrong, kExpectedNpy);
}

/// Returns the unsigned number of `bytes`, the lowest byte first; they reach at least that far.
std::uint64_t bytes_number(std::string_view bytes, std::size_t at, std::size_t size_bytes) {
  std::uint64_t number = 0;
  for (std::size_t i = size_bytes; i-- > 0;) {
    number = number << 8U | static_cast<unsigned char>(bytes[at + i]);
  }
  return number;
}

/// A .npy file: its header, a Python dictionary as text, and what follows it.
struct NpyParts {
  std::string_view header, numbers;
};

NpyParts split_npy(std::string_view bytes, const fs::path& file) {
  if (!bytes.starts_with(kNpyMagic) || bytes.size() < 12) refuse_npy(file, "is no .npy file");
  // The length of the header has two bytes in version 1 and four since.
  const std::size_t length_bytes = bytes[6] == 1 ? 2 : 4;
  const std::size_t length = bytes_number(bytes, 8, length_bytes);
  const std::size_t start = 8 + length_bytes;
  if (length > bytes.size() - start) refuse_npy(file, "ends within its header");
  return {bytes.substr(start, length), bytes.substr(start + length)};
}

/// Returns what stands between `key` and `end` in the header.
std::string_view value_of(std::string_view header, std::string_view key, char end,
                          const fs::path& file) {
  const std::size_t at = header.find(key);
  if (at == std::string_view::npos) refuse_npy(file, "has no " + quoted(key) + " in its header");
  const std::string_view rest = header.substr(at + key.size());
  return rest.substr(0, rest.find(end));
}

/// Returns the product of a shape, such as "100," or "100, 1".
std::uint64_t count_in(std::string_view shape, const fs::path& file) {
  constexpr std::uint64_t kMost = 1ULL << 40U;
  std::uint64_t count = 1;
  for (const std::string_view length : split_at_commas(shape)) {
    if (trim(length).empty()) continue;
    const auto number = parse_unsigned(trim(length));
    if (!number || *number > kMost / std::max<std::uint64_t>(count, 1)) {
      refuse_npy(file, "has the shape (" + std::string(shape) + ")");
    }
    count *= *number;
  }
  return count;
}

template <typename Stored>
double load_number(const char* at, bool is_big_endian) {
  std::array<char, sizeof(Stored)> raw;
  std::memcpy(raw.data(), at, raw.size());
  if (is_big_endian) std::ranges::reverse(raw);
  return static_cast<double>(std::bit_cast<Stored>(raw));
}
template <>
double load_number<Eigen::half>(const char* at, bool is_big_endian) {
  std::array<char, 2> raw = {at[0], at[1]};
  if (is_big_endian) std::ranges::reverse(raw);
  return static_cast<double>(
      Eigen::half(Eigen::half_impl::raw_uint16_to_half(std::bit_cast<std::uint16_t>(raw))));
}

struct NumpyType {
  std::string_view name;
  std::size_t size_bytes;
  double (*load)(const char* at, bool is_big_endian);
};
template <typename Stored>
constexpr NumpyType numpy_type(std::string_view name) {
  return {name, sizeof(Stored), load_number<Stored>};
}
constexpr std::array kNumpyTypes = {numpy_type<std::uint8_t>("b1"),  numpy_type<std::int8_t>("i1"),
                                    numpy_type<std::uint8_t>("u1"),  numpy_type<std::int16_t>("i2"),
                                    numpy_type<std::uint16_t>("u2"), numpy_type<std::int32_t>("i4"),
                                    numpy_type<std::uint32_t>("u4"), numpy_type<std::int64_t>("i8"),
                                    numpy_type<std::uint64_t>("u8"), numpy_type<Eigen::half>("f2"),
                                    numpy_type<float>("f4"),         numpy_type<double>("f8")};

/// What a header says of the numbers.
struct NumpyNumbers {
  const NumpyType* type;
  bool is_big_endian;

  NumpyKind kind() const {
    const char letter = type->name.front();
    return letter == 'b'   ? NumpyKind::kBooleans
           : letter == 'f' ? NumpyKind::kReals
                           : NumpyKind::kIntegers;
  }
};

NumpyNumbers numbers_in(std::string_view header, const fs::path& file) {
  const std::string_view descr = value_of(header, "'descr': '", '\'', file);
  const std::string_view name = descr.substr(std::min<std::size_t>(1, descr.size()));
  const auto type = std::ranges::find(kNumpyTypes, name, &NumpyType::name);
  if (type == kNumpyTypes.end()) refuse_npy(file, fmt::format("holds numbers of type {}", descr));
  return {&*type, descr.front() == '>'};
}

/// What the end of a zip archive's central directory says of a member.
struct ZipEntry {
  std::string name;
  std::uint64_t method, packed_bytes, bytes, header_at;
};

constexpr std::string_view kZipEnd = "PK\x05\x06", kZipEntry = "PK\x01\x02",
                           kZipFile = "PK\x03\x04";
constexpr std::size_t kZipEndBytes = 22, kZipEntryBytes = 46, kZipFileBytes = 30;

[[noreturn]] void refuse_npz(const fs::path& file, const std::string& wrong) {
  throw DataError(file, wrong, "a .npz archive as numpy.savez writes it");
}

/// Returns the sizes of a member beyond 4 GiB, which NumPy leaves open always, from its extra
/// field.
void read_zip64(std::string_view extra, ZipEntry& entry) {
  constexpr std::uint64_t kInExtra = 0xFFFFFFFF;
  while (extra.size() >= 4) {
    const std::size_t length = bytes_number(extra, 2, 2);
    if (length > extra.size() - 4) return;
    std::string_view field = extra.substr(4, length);
    if (bytes_number(extra, 0, 2) == 1) {
      for (std::uint64_t* value : {&entry.bytes, &entry.packed_bytes, &entry.header_at}) {
        if (*value != kInExtra || field.size() < 8) continue;
        *value = bytes_number(field, 0, 8);
        field.remove_prefix(8);
      }
    }
    extra.remove_prefix(4 + length);
  }
}

std::vector<ZipEntry> zip_entries(std::string_view bytes, const fs::path& file) {
  const std::size_t end = bytes.rfind(kZipEnd);
  if (end == std::string_view::npos || bytes.size() - end < kZipEndBytes) {
    refuse_npz(file, "has no end of a zip archive");
  }
  std::vector<ZipEntry> entries;
  std::size_t at = bytes_number(bytes, end + 16, 4);
  for (std::uint64_t count = bytes_number(bytes, end + 10, 2); count > 0; --count) {
    if (at > end || end - at < kZipEntryBytes || !bytes.substr(at).starts_with(kZipEntry)) {
      refuse_npz(file, "has a damaged directory");
    }
    const std::size_t name = bytes_number(bytes, at + 28, 2),
                      extra = bytes_number(bytes, at + 30, 2),
                      comment = bytes_number(bytes, at + 32, 2);
    if (name + extra + comment > end - at - kZipEntryBytes) {
      refuse_npz(file, "has a damaged directory");
    }
    ZipEntry entry{std::string(bytes.substr(at + kZipEntryBytes, name)),
                   bytes_number(bytes, at + 10, 2), bytes_number(bytes, at + 20, 4),
                   bytes_number(bytes, at + 24, 4), bytes_number(bytes, at + 42, 4)};
    read_zip64(bytes.substr(at + kZipEntryBytes + name, extra), entry);
    entries.push_back(std::move(entry));
    at += kZipEntryBytes + name + extra + comment;
  }
  return entries;
}

/// Returns nothing for bytes that do not inflate to exactly that size.
std::optional<std::string> inflated(std::string_view packed, std::uint64_t size_bytes) {
  constexpr std::uint64_t kMostRatio = 1100;  // of deflate; no size that cannot be is allocated
  if (size_bytes / kMostRatio > packed.size() || packed.size() > std::numeric_limits<uInt>::max() ||
      size_bytes > std::numeric_limits<uInt>::max()) {
    return std::nullopt;
  }
  std::string bytes(size_bytes, '\0');
  z_stream stream{};
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = static_cast<uInt>(size_bytes);
  if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) return std::nullopt;
  const int state = inflate(&stream, Z_FINISH);
  const bool is_whole = state == Z_STREAM_END && stream.avail_out == 0;
  inflateEnd(&stream);
  if (!is_whole) return std::nullopt;
  return bytes;
}

std::string unpacked(std::string_view bytes, const ZipEntry& entry, const fs::path& file) {
  constexpr std::uint64_t kStored = 0, kDeflated = 8;
  const auto fail = [&] {
    refuse_npz(file, "its member " + mosbench::quoted(entry.name) + " is damaged");
  };
  if (bytes.size() < kZipFileBytes || entry.header_at > bytes.size() - kZipFileBytes ||
      !bytes.substr(entry.header_at).starts_with(kZipFile)) {
    fail();
  }
  // The name and the extra field stand here once more, and may have other lengths.
  const std::size_t start = entry.header_at + kZipFileBytes +
                            bytes_number(bytes, entry.header_at + 26, 2) +
                            bytes_number(bytes, entry.header_at + 28, 2);
  if (start > bytes.size() || entry.packed_bytes > bytes.size() - start) fail();
  const std::string_view packed = bytes.substr(start, entry.packed_bytes);
  std::optional<std::string> whole;
  if (entry.method == kStored && entry.packed_bytes == entry.bytes) whole = std::string(packed);
  if (entry.method == kDeflated) whole = inflated(packed, entry.bytes);
  if (whole) return *std::move(whole);
  if (entry.method != kStored && entry.method != kDeflated) {
    refuse_npz(file, fmt::format("packs its member {} by the method {}",
                                 mosbench::quoted(entry.name), entry.method));
  }
  refuse_npz(file, fmt::format("its member {} has {} bytes, which do not unpack to the {} that the "
                               "archive states",
                               mosbench::quoted(entry.name), entry.packed_bytes, entry.bytes));
}

}  // namespace

NumpyArray parse_npy(std::string_view bytes, const fs::path& file) {
  const NpyParts parts = split_npy(bytes, file);
  const NumpyNumbers numbers = numbers_in(parts.header, file);
  const NumpyType* type = numbers.type;
  const std::uint64_t count = count_in(value_of(parts.header, "'shape': (", ')', file), file);
  if (parts.numbers.size() % type->size_bytes != 0 ||
      parts.numbers.size() / type->size_bytes != count) {
    throw DataError(file, fmt::format("has {} bytes behind its header", parts.numbers.size()),
                    fmt::format("{} of {} numbers", count * type->size_bytes, count));
  }
  NumpyArray array{{}, numbers.kind()};
  array.numbers.reserve(count);
  for (std::size_t at = 0; at < parts.numbers.size(); at += type->size_bytes) {
    array.numbers.push_back(type->load(parts.numbers.data() + at, numbers.is_big_endian));
  }
  return array;
}

NumpyKind kind_of_npy(std::string_view start, const fs::path& file) {
  return numbers_in(split_npy(start, file).header, file).kind();
}

std::vector<ArchiveMember> unpack_npz(std::string_view bytes, const fs::path& file) {
  std::vector<ArchiveMember> members;
  for (const ZipEntry& entry : zip_entries(bytes, file)) {
    members.push_back({entry.name, unpacked(bytes, entry, file)});
  }
  return members;
}

}  // namespace mosbench
