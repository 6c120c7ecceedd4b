#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace mosbench {

/// Returns whether there is a file or folder; false when that cannot be determined.
bool is_there(const std::filesystem::path& path);

/// Returns all bytes of a file; throws DataError when it cannot be read to its end.
std::string read_file(const std::filesystem::path& file);
/// Reads the first `most_bytes` of a file, or all when it is shorter; throws as `read_file`.
std::string read_start(const std::filesystem::path& file, std::size_t most_bytes);
/// Reads `bytes` bytes of a file from `from_bytes` on; throws DataError when it has fewer.
std::string read_part(const std::filesystem::path& file, std::uint64_t from_bytes,
                      std::uint64_t bytes);
/// Reads the start of a file to the end of the first line that begins with `last_line`, or some
/// bytes further; the whole file when there is no such line. Throws as `read_file`.
std::string read_head(const std::filesystem::path& file, std::string_view last_line);
/// Fills `bytes` with a file that is exactly that long; throws DataError when it cannot be read, or
/// is longer or shorter, as one that changed after `size_of`.
void read_file(const std::filesystem::path& file, std::span<std::byte> bytes);

/// Returns the size of a file in bytes; throws DataError.
std::uintmax_t size_of(const std::filesystem::path& file);

/// Replaces `file` as a whole: readers see the old bytes or the new ones, also after a killed run
/// (PartialFile says how). Makes missing folders. Follows symbolic links: what they lead to is
/// replaced. A FIFO, a device and everything in /dev and /proc is never replaced but written.
/// Throws DataError naming `file`.
void write_file_atomic(const std::filesystem::path& file, std::string_view bytes);
/// The same, and returns only when bytes and name are on the disk, to survive a power cut.
void commit_file(const std::filesystem::path& file, std::string_view bytes);

/// Writes to stdout. Nothing is wrong when its reader went away, as `head` does. Throws DataError.
void write_stdout(std::string_view bytes);

}  // namespace mosbench
