#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

enum class NumpyKind : std::uint8_t { kBooleans, kIntegers, kReals };

/// The numbers of a NumPy array in the order in which they are stored.
struct NumpyArray {
  std::vector<double> numbers;
  NumpyKind kind = NumpyKind::kReals;
};

/// Parses a .npy file of booleans, integers or floats of any size, shape and byte order. Throws
/// DataError, also when the numbers are not as many as the shape says.
NumpyArray parse_npy(std::string_view bytes, const std::filesystem::path& file);

/// Returns what a .npy file holds by its start, which has its whole header. Throws DataError.
NumpyKind kind_of_npy(std::string_view start, const std::filesystem::path& file);

/// A file in an archive.
struct ArchiveMember {
  std::string name;
  std::string bytes;
};

/// Unpacks a .npz file, which is a zip archive of .npy files, stored or deflated. Throws DataError.
std::vector<ArchiveMember> unpack_npz(std::string_view bytes, const std::filesystem::path& file);

}  // namespace mosbench
