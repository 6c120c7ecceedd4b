#include "datasets/sequence/pose_frame_mark.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <string>

#include "datasets/disk/files.hpp"

namespace mosbench {
namespace {

std::filesystem::path mark_of(std::filesystem::path file) { return file += ".frame"; }

/// With the hash, so that the mark of an overwritten file says nothing about the new one.
std::string lidars(std::string_view text) {
  return fmt::format("lidar {:016x}\n", XXH3_64bits(text.data(), text.size()));
}

}  // namespace

void mark_as_lidars(const std::filesystem::path& file, std::string_view text) {
  write_file_atomic(mark_of(file), lidars(text));
}

bool is_marked_as_lidars(const std::filesystem::path& file) {
  const std::filesystem::path mark = mark_of(file);
  return is_there(mark) && read_file(mark) == lidars(read_file(file));
}

}  // namespace mosbench
