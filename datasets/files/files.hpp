#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace mosbench {

/// Whether there is a file or folder; false when that cannot be told.
bool is_there(const std::filesystem::path& path);

/// All bytes of a file; throws DataError when it cannot be read to its end.
std::string read_file(const std::filesystem::path& file);
/// Reads the start of a file to the end of the first line that begins with `last_line`, or some
/// bytes further; the whole file when there is no such line. Throws as `read_file`.
std::string read_head(const std::filesystem::path& file, std::string_view last_line);
/// Fills `bytes` with a file that is exactly that long; throws DataError when it cannot be read, or
/// is longer or shorter (as one that changed since `size_of` told).
void read_file(const std::filesystem::path& file, std::span<std::byte> bytes);

/// Size of a file in bytes; throws DataError.
std::uintmax_t size_of(const std::filesystem::path& file);

/// Replaces `file` as a whole: readers see the old bytes or the new ones, also after a killed run.
/// Missing folders are made. The bytes go first to `<file>.partial`, which the next write replaces
/// should this one be killed. One writer per file at a time. Throws DataError naming `file`.
void write_file_atomic(const std::filesystem::path& file, std::string_view bytes);

}  // namespace mosbench
