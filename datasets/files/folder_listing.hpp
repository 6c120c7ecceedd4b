#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

struct StemFile {
  std::filesystem::path file;
  std::string stem;  ///< file name without extension
};

/// The value of a stem of digits ("000017", a time stamp), or nothing.
std::optional<std::uint64_t> stem_number(std::string_view stem);

/// The files of `folder` with one of `extensions` (".bin"), hidden ones aside, by the value of the
/// stem when all stems are numbers, by text otherwise. Throws DataError when the folder cannot be
/// read and when two files have the same stem or number.
std::vector<StemFile> list_by_stem(const std::filesystem::path& folder,
                                   std::initializer_list<std::string_view> extensions);

/// The folders below `folder` in the order of `list_by_stem`, hidden ones aside; links are
/// followed. None when it cannot be read: a search passes over what is closed to it.
std::vector<std::filesystem::path> list_folders(const std::filesystem::path& folder);

}  // namespace mosbench
