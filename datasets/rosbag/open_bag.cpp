#include "datasets/rosbag/open_bag.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "datasets/disk/files.hpp"
#include "datasets/rosbag/bag_file.hpp"
#include "datasets/rosbag/bag_metadata.hpp"
#include "datasets/rosbag/chunk_reader.hpp"
#include "datasets/rosbag/joined_bag.hpp"
#include "datasets/rosbag/mcap_file.hpp"
#include "datasets/rosbag/sqlite_bag.hpp"
#include "datasets/rosbag/unpacked_bag.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kRos1Start = "#ROSBAG";
constexpr std::string_view kSqliteStart{"SQLite format 3\0", 16};
constexpr std::array<std::string_view, 5> kBagNames = {".bag", ".mcap", ".db3", ".mcap.zstd",
                                                       ".db3.zstd"};

std::string start_of(const fs::path& file) { return read_start(file, kSqliteStart.size()); }

std::unique_ptr<const BagReader> open_bag_file(const fs::path& file) {
  const std::string start = start_of(file);
  if (start.starts_with(kMcapMagic)) return std::make_unique<McapFile>(file);
  if (start.starts_with(kSqliteStart)) return std::make_unique<SqliteBag>(file);
  if (is_zstd(start)) return std::make_unique<UnpackedBag>(file);
  if (file.extension() == ".bag" || start.starts_with(kRos1Start)) {
    return std::make_unique<BagFile>(file);
  }
  throw DataError(file, "does not start like a bag",
                  "\"#ROSBAG V2.0\", MCAP's or SQLite's first bytes");
}

/// Finds a file that metadata.yaml names: the first recorders wrote the folder's name before it,
/// and some leave out that it is packed.
fs::path part_of(const fs::path& folder, const std::string& name) {
  const fs::path inside = folder / fs::path(name).filename();
  for (const fs::path& file : {folder / name, inside, fs::path(inside.native() + ".zstd")}) {
    if (is_there(file)) return file;
  }
  throw DataError(folder / kBagMetadataFile, "names " + name + ", which is not there",
                  "all files of the bag");
}

std::unique_ptr<const BagReader> open_bag_folder(const fs::path& folder) {
  const fs::path file = folder / kBagMetadataFile;
  const BagMetadata metadata = parse_bag_metadata(read_file(file), file);
  if (!metadata.compression.empty() && metadata.compression != "zstd") {
    throw DataError(file, "is of a ROS 2 bag with compression " + metadata.compression, "zstd");
  }
  std::vector<std::unique_ptr<const BagReader>> parts;
  std::set<fs::path> known;
  for (const std::string& name : metadata.files) {
    const fs::path part = part_of(folder, name);
    if (!known.insert(part.lexically_normal()).second) {
      throw DataError(file, "names " + name + " twice", "each file of the bag once");
    }
    parts.push_back(open_bag_file(part));
  }
  return std::make_unique<JoinedBag>(folder, std::move(parts));
}

}  // namespace

bool is_bag_file(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) return false;
  const std::string name = path.filename().string();
  if (std::ranges::any_of(kBagNames, [&](auto end) { return name.ends_with(end); })) return true;
  const std::string start = start_of(path);
  return start.starts_with(kRos1Start) || start.starts_with(kMcapMagic) ||
         start.starts_with(kSqliteStart);
}

bool is_bag_folder(const fs::path& path) {
  std::error_code ignored;
  const fs::path file = path / kBagMetadataFile;
  if (!fs::is_regular_file(file, ignored)) return false;
  return read_start(file, kBagMetadataStart.size()) == kBagMetadataStart;
}

std::unique_ptr<const BagReader> open_bag(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored) ? open_bag_folder(path) : open_bag_file(path);
}

}  // namespace mosbench
