#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

struct StemFile {
  std::filesystem::path file;
  std::string stem;  ///< file name without extension, as `shown_in_line`: what results call it
};

/// Returns the value of a stem of digits ("000017", a time stamp), or nothing.
std::optional<std::uint64_t> stem_number(std::string_view stem);

/// Lists the files of `folder` with one of `extensions` (".bin") that are not hidden, ordered by
/// their stems. Numbers go by value ("scan_2" before "scan_10"), digits behind a point that follows
/// a digit as a fraction ("1650.25" before "1650.5"), all else by bytes. Throws DataError if the
/// folder cannot be read, or if two stems differ only by zeros.
std::vector<StemFile> list_by_stem(const std::filesystem::path& folder,
                                   const std::vector<std::string_view>& extensions);

/// Lists the folders in `folder` that are not hidden, in the order of `list_by_stem`; links are
/// followed. Returns none when it cannot be read: a search skips what it may not read.
std::vector<std::filesystem::path> list_folders(const std::filesystem::path& folder);

/// Returns the path from the root with symbolic links resolved as far as they can be.
std::filesystem::path resolved(const std::filesystem::path& path);

/// Returns whether `path` is `folder` or below it; both as `resolved` returns them.
bool is_in(const std::filesystem::path& path, const std::filesystem::path& folder);

}  // namespace mosbench
