#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "eval/answer/answer.hpp"

namespace mosbench {

/// Writes a file that the user named; "-" is stdout. Returns when the bytes are on the disk. Throws
/// DataError.
void write_output(const std::filesystem::path& file, std::string_view bytes);

/// The same behind what the file holds.
void append_output(const std::filesystem::path& file, std::string_view bytes);

/// Throws DataError where `file` can be no file to write, so that hours of work are not lost on it:
/// it is a folder, or lies below what is none. Throws UsageError for a name of another kind of file
/// than what is written or of a record that mosbench keeps, and where a file is there of another
/// kind; for JSON, HTML and JUnit also where others wrote it, which text and pictures do not tell.
void check_output(const std::filesystem::path& file, std::optional<Format> written = std::nullopt);

/// Throws UsageError where `file` is a file that holds something: a writer asks this before its
/// work, unless --overwrite is given.
void refuse_to_replace(const std::filesystem::path& file);

/// Returns whether a file that the user named is stdout.
bool names_stdout(const std::filesystem::path& file);

/// Returns the answer of a command that wrote `file`. Where that is stdout, which then holds
/// nothing else, the answer goes to stderr.
Answer answer_beside(const std::filesystem::path& file, Answer answer);

}  // namespace mosbench
