#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "eval/cli/commands.hpp"

namespace mosbench {

/// Writes a file that the user named; "-" is stdout. Returns when the bytes are on the disk. Throws
/// DataError.
void write_output(const std::filesystem::path& file, std::string_view bytes);

/// Throws DataError where `file` can be no file to write, so that hours of work are not lost on it:
/// it is a folder, or lies below what is none.
void check_output(const std::filesystem::path& file);

/// Returns the answer of a command that wrote `file`. Where that is stdout, which then holds
/// nothing else, the text goes to stderr.
Answer answer_beside(const std::filesystem::path& file, const std::string& text, int exit_code = 0);

}  // namespace mosbench
