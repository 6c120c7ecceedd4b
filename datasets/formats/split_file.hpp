#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>

namespace mosbench {

/// Parses the frame numbers of a HeLiMOS split (train.txt, val.txt, test.txt), one per line. Throws
/// DataError with the line for anything but a number, and for a file without numbers.
std::set<std::uint64_t> parse_split(std::string_view text, const std::filesystem::path& file);
std::string format_split(const std::set<std::uint64_t>& numbers);

std::set<std::uint64_t> read_split(const std::filesystem::path& file);
void write_split(const std::filesystem::path& file, const std::set<std::uint64_t>& numbers);

}  // namespace mosbench
