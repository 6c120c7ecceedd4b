#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

/// The numbers of a NumPy array in the order in which they are stored.
struct NumpyArray {
  std::vector<double> numbers;
  bool is_boolean = false;
};

/// Parses a .npy file of booleans, integers or floats of any size, shape and byte order. Throws
/// DataError, also when the numbers are not as many as the shape says.
NumpyArray parse_npy(std::string_view bytes, const std::filesystem::path& file);

/// A file in an archive.
struct ArchiveMember {
  std::string name;
  std::string bytes;
};

/// Unpacks a .npz file, which is a zip archive of .npy files, stored or deflated. Throws DataError.
std::vector<ArchiveMember> unpack_npz(std::string_view bytes, const std::filesystem::path& file);

}  // namespace mosbench
