#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

/// The numbers that an array in an HDF5 file consists of. Truth values, of which h5py makes an
/// enumeration of bytes, are integers.
struct Hdf5Number {
  enum class Kind : std::uint8_t { kInteger, kUnsigned, kReal, kTruth };
  Kind kind = Kind::kInteger;
  std::uint8_t bytes = 0;  ///< 1, 2, 4 or 8
  bool operator==(const Hdf5Number&) const = default;
};

/// An array of numbers in a group of an HDF5 file.
struct Hdf5Array {
  std::string name;
  Hdf5Number number;
  std::vector<std::uint64_t> shape;
  /// Whether the numbers stand one after the other, little-endian, from `at_bytes` of the file on.
  bool is_plain = false;
  std::uint64_t at_bytes = 0;
};

struct Hdf5Group {
  std::string name;
  std::vector<Hdf5Array> arrays;
};

/// A file that is being written. Every function returns an empty text, or why it failed.
class Hdf5Output {
 public:
  virtual ~Hdf5Output() = default;
  /// Adds an array; makes the group where it is missing.
  virtual std::string add(const std::string& group, const Hdf5Array& array,
                          std::string_view bytes) = 0;
  /// Adds a text about the whole file.
  virtual std::string add_mark(const std::string& text) = 0;
  virtual std::string close() = 0;
};

/// What the module mosbench_hdf5 can do, which is the only one linked with libhdf5. Every function
/// returns an empty text, or why it failed.
struct Hdf5Functions {
  /// Lists the groups of a file with those of their arrays that have one of the names, and its
  /// mark.
  std::string (*list)(const std::string& file, std::span<const std::string_view> names,
                      std::vector<Hdf5Group>& groups, std::string& mark);
  /// Reads an array as `list` found it, in little-endian numbers.
  std::string (*read)(const std::string& file, const std::string& group, const Hdf5Array& array,
                      std::string& bytes);
  std::string (*create)(const std::string& file, std::unique_ptr<Hdf5Output>& output);
};

inline constexpr const char* kHdf5Module = "mosbench_hdf5.so";
/// Of a function that returns `const Hdf5Functions*`. Its number counts up with each change of the
/// types above: a module of another build would be called with other ones.
inline constexpr const char* kHdf5ModuleFunction = "mosbench_hdf5_functions_2";

/// Returns the module's functions, loading it first. Throws DataError naming `file` when this build
/// has none.
const Hdf5Functions& hdf5_functions(const std::string& file);

/// Returns whether this build reads and writes HDF5 (MOSBENCH_WITH_HDF5).
bool has_hdf5();

}  // namespace mosbench
