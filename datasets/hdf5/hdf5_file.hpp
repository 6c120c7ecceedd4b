#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/hdf5/hdf5_module.hpp"

namespace mosbench {

/// What became of work in a copy of this process.
struct CopyAnswer {
  std::string bytes;
  std::string failure;  ///< empty, or how the copy ended instead of answering
};

/// Does work in a copy of this process (fork) and returns its bytes. A damaged file may make a
/// library crash there, or never come back, without harm here: the copy ends after `most_cpu_s` of
/// computing or three times as long of waiting. A copy that only waited is made once more. An
/// exception of `work` comes back as failure.
/// `work` must not start threads or wait for locks that other threads of this process hold.
CopyAnswer in_process_copy(const std::function<std::string()>& work, unsigned most_cpu_s = 60);

/// Returns whether a file begins as those of HDF5 do; false when it cannot be read.
bool is_hdf5_file(const std::filesystem::path& file);

/// Arrays of numbers in the groups of an HDF5 file. libhdf5 works in a copy of this process, so
/// that damaged files can do no harm here. Numbers that stand in the file as they are, as h5py
/// writes them, are read without it. Safe to use from several threads.
class Hdf5File {
 public:
  /// Lists the groups and their arrays of the given names. Throws DataError for a file that is
  /// none, and for arrays that claim to be larger than the file can be.
  Hdf5File(std::filesystem::path path, std::span<const std::string_view> names);

  const std::filesystem::path& path() const { return path_; }
  /// In the order of the file.
  const std::vector<Hdf5Group>& groups() const { return groups_; }
  /// What mosbench wrote about the whole file; may be empty.
  const std::string& mark() const { return mark_; }

  /// Returns the numbers of an array, as doubles or whole. Throw DataError.
  std::vector<double> reals(const Hdf5Group& group, const Hdf5Array& array) const;
  std::vector<float> floats(const Hdf5Group& group, const Hdf5Array& array) const;
  std::vector<std::int64_t> integers(const Hdf5Group& group, const Hdf5Array& array) const;

 private:
  template <typename Value>
  std::vector<Value> numbers(const Hdf5Group& group, const Hdf5Array& array) const;
  std::string bytes_of(const Hdf5Group& group, const Hdf5Array& array) const;
  void check(const Hdf5Group& group, const Hdf5Array& array) const;

  std::filesystem::path path_;
  std::uint64_t file_bytes_;
  std::string mark_;
  std::vector<Hdf5Group> groups_;
};

/// Whether the mark of a file's folder is known to be of others in it, which hold it themselves,
/// too. What an earlier mosbench simulated does not.
bool others_have_marks(const std::filesystem::path& file);

/// Returns nullptr when the group has no array of this name.
const Hdf5Array* find_array(const Hdf5Group& group, std::string_view name);

/// Returns how many numbers an array holds.
std::uint64_t count_of(const Hdf5Array& array);

}  // namespace mosbench
