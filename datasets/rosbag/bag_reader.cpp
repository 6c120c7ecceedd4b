#include "datasets/rosbag/bag_reader.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "datasets/disk/files.hpp"
#include "datasets/disk/folder_listing.hpp"
#include "datasets/disk/partial_file.hpp"
#include "datasets/rosbag/chunk_reader.hpp"
#include "datasets/rosbag/mcap_record.hpp"
#include "datasets/rosbag/ros2_bag.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kRos1Start = "#ROSBAG";
constexpr std::string_view kSqliteStart{"SQLite format 3\0", 16};
constexpr std::array<std::string_view, 5> kBagNames = {".bag", ".mcap", ".db3", ".mcap.zstd",
                                                       ".db3.zstd"};

/// The files of one recording as one bag.
class JoinedBag : public BagReader {
 public:
  JoinedBag(const fs::path& path, std::vector<std::unique_ptr<const BagReader>> parts,
            std::vector<std::string> remarks, std::vector<std::string> doubts = {})
      : BagReader(path), parts_(std::move(parts)) {
    files_.clear();
    remarks_ = std::move(remarks);
    doubts_ = std::move(doubts);
    for (const auto& part : parts_) {
      files_.insert(files_.end(), part->files().begin(), part->files().end());
      remarks_.insert(remarks_.end(), part->remarks().begin(), part->remarks().end());
      doubts_.insert(doubts_.end(), part->doubts().begin(), part->doubts().end());
      for (const BagConnection& connection : part->connections()) add(connection);
    }
  }

  std::vector<BagMessage> messages(std::string_view topic) const override {
    std::vector<BagMessage> joined;
    for (std::size_t part = 0; part < parts_.size(); ++part) {
      for (BagMessage message : parts_[part]->messages(topic)) {
        message.part = part;
        joined.push_back(message);
      }
    }
    std::ranges::stable_sort(joined, {}, &BagMessage::recorded_ns);
    return joined;
  }

  std::string read(const BagMessage& message, std::size_t most_bytes = SIZE_MAX) const override {
    return parts_.at(message.part)->read(message, most_bytes);
  }

  MessageFormat format_of(const BagMessage& message) const override {
    return parts_.at(message.part)->format_of(message);
  }

 private:
  std::vector<std::unique_ptr<const BagReader>> parts_;
};

/// Opens a file that no folder lists.
FileDescriptor nameless_file() {
  std::string name = fs::temp_directory_path() / "mosbench_bag_XXXXXX";
  FileDescriptor made(mkostemp(name.data(), O_CLOEXEC));
  if (!made.is_open() || unlink(name.c_str()) != 0) {
    throw DataError(name, "cannot be made", "a writable folder in TMPDIR");
  }
  return made;
}

/// Returns what `work` does with an unpacked bag; its errors name the file that the user knows.
template <typename Work>
auto naming(const fs::path& file, Work&& work) {
  try {
    return work();
  } catch (const DataError& error) {
    throw DataError(file, fmt::format("is unpacked to no bag ({})", error.what()),
                    "a packed .mcap or .db3");
  }
}

/// A bag that is packed as a whole by Zstandard. It is unpacked into the folder of temporary files
/// (TMPDIR). Its name there is removed before anything is written: no bag is left, however the
/// process ends.
class UnpackedBag : public BagReader {
 public:
  /// Throws DataError.
  explicit UnpackedBag(const fs::path& file) : BagReader(file), unpacked_(nameless_file()) {
    // The path by which this process opens it again.
    const fs::path unpacked = fmt::format("/proc/self/fd/{}", unpacked_.number());
    decompress_zstd_file(file, unpacked);
    bag_ = naming(path_, [&] { return opened(unpacked); });
    for (const BagConnection& connection : bag_->connections()) add(connection);
    doubts_ = bag_->doubts();
    const std::string number = unpacked.filename().string();
    for (std::string& doubt : doubts_) {
      if (doubt.starts_with(number)) doubt.replace(0, number.size(), file.filename().string());
    }
  }

  std::vector<BagMessage> messages(std::string_view topic) const override {
    return bag_->messages(topic);
  }

  std::optional<std::pair<std::int64_t, std::int64_t>> extent_ns() const override {
    return bag_->extent_ns();
  }

  std::string read(const BagMessage& message, std::size_t most_bytes = SIZE_MAX) const override {
    return naming(path_, [&] { return bag_->read(message, most_bytes); });
  }

 private:
  /// The content of a file, which must not become shorter; changes stay in this process.
  class Mapping {
   public:
    /// Throws std::system_error.
    explicit Mapping(const FileDescriptor& file) {
      const off_t bytes = lseek(file.number(), 0, SEEK_END);
      require_success(bytes >= 0);
      if (bytes == 0) return;
      const auto size = static_cast<std::size_t>(bytes);
      void* start = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE, file.number(), 0);
      require_success(start != MAP_FAILED);
      content_ = {static_cast<unsigned char*>(start), size};
    }

    ~Mapping() {
      if (!content_.empty()) munmap(content_.data(), content_.size());
    }

    Mapping(const Mapping&) = delete;
    Mapping& operator=(const Mapping&) = delete;
    std::span<unsigned char> content() const { return content_; }

   private:
    std::span<unsigned char> content_;
  };

  /// SQLite opens no file without a name, but takes its content.
  std::unique_ptr<const BagReader> opened(const fs::path& unpacked) {
    if (read_start(unpacked, kMcapMagic.size()) == kMcapMagic) {
      return open_mcap(unpacked);
    }
    mapping_ = std::make_unique<Mapping>(unpacked_);
    return open_sqlite_bag(path_, mapping_->content());
  }

  FileDescriptor unpacked_;
  std::unique_ptr<const Mapping> mapping_;  ///< of a database
  std::unique_ptr<const BagReader> bag_;
};

/// What a file is that is no bag, by its first bytes; empty where these tell nothing.
std::string_view kind_of(std::string_view start) {
  if (start.empty()) return "is empty";
  if (start.find_first_not_of('\0') == start.npos)
    return "begins with zeros: it was not copied whole";
  if (start.starts_with("PK\3\4")) return "is a zip archive";
  if (start.starts_with("\x1f\x8b")) return "is packed by gzip";
  if (start.starts_with("<")) return "seems to be a web page";
  return "";
}

std::unique_ptr<const BagReader> open_bag_file(const fs::path& file) {
  const std::string start = read_start(file, kSqliteStart.size());
  if (const std::string_view kind = kind_of(start); !kind.empty()) {
    throw DataError(file, std::string(kind), "a bag: .bag, .mcap or .db3, unpacked");
  }
  if (start.starts_with(kMcapMagic)) return open_mcap(file);
  if (start.starts_with(kSqliteStart)) return open_sqlite_bag(file);
  if (is_zstd(start)) return std::make_unique<UnpackedBag>(file);
  if (file.extension() == ".bag" || start.starts_with(kRos1Start)) return open_ros1_bag(file);
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

/// Says which bags a killed recorder left without naming them; a bag may also lie there unpacked.
std::vector<std::string> doubts_about_unnamed(const fs::path& folder,
                                              const std::set<fs::path>& named) {
  const auto without_zstd = [](const fs::path& file) {
    return file.extension() == ".zstd" ? file.stem() : file.filename();
  };
  std::set<fs::path> known;
  for (const fs::path& file : named) known.insert(without_zstd(file));
  std::vector<std::string> doubts;
  for (const StemFile& found : list_by_stem(folder, {".mcap", ".db3", ".zstd"})) {
    if (known.contains(without_zstd(found.file)) || !is_bag_file(found.file)) continue;
    doubts.push_back(fmt::format("{} is not named in {} and is left out (ros2 bag reindex)",
                                 found.file.filename().string(), kBagMetadataFile));
  }
  return doubts;
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
  return std::make_unique<JoinedBag>(folder, std::move(parts), std::vector<std::string>{},
                                     doubts_about_unnamed(folder, known));
}

}  // namespace

std::vector<BagConnection> BagReader::connections_of_type(std::string_view type) const {
  std::vector<BagConnection> found;
  for (const BagConnection& connection : connections_) {
    if (connection.type == type) found.push_back(connection);
  }
  return found;
}

const BagConnection* BagReader::find_connection(std::uint32_t id) const {
  const auto found = position_.find(id);
  return found == position_.end() ? nullptr : &connections_[found->second];
}

bool BagReader::add(BagConnection connection) {
  const bool is_new = position_.emplace(connection.id, connections_.size()).second;
  connections_.push_back(std::move(connection));
  return is_new;
}

MessageFormat BagReader::format_of(const BagMessage& message) const {
  const BagConnection* connection = find_connection(message.connection);
  return {connection->type, connection->encoding};
}

std::optional<std::pair<std::int64_t, std::int64_t>> BagReader::extent_ns() const {
  if (messages_.empty()) return std::nullopt;
  const auto [first, last] = std::ranges::minmax_element(messages_, {}, &BagMessage::recorded_ns);
  return std::pair(first->recorded_ns, last->recorded_ns);
}

std::vector<BagMessage> BagReader::messages(std::string_view topic) const {
  std::set<std::uint32_t> ids;
  for (const BagConnection& connection : connections_) {
    if (connection.topic == topic) ids.insert(connection.id);
  }
  std::vector<BagMessage> found;
  for (const BagMessage& message : messages_) {
    if (ids.contains(message.connection)) found.push_back(message);
  }
  std::ranges::stable_sort(found, {}, &BagMessage::recorded_ns);
  return found;
}

bool is_bag_file(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) return false;
  const std::string name = path.filename().string();
  if (std::ranges::any_of(kBagNames, [&](auto end) { return name.ends_with(end); })) return true;
  const std::string start = read_start(path, kSqliteStart.size());
  return start.starts_with(kRos1Start) || start.starts_with(kMcapMagic) ||
         start.starts_with(kSqliteStart);
}

bool is_bag_folder(const fs::path& path) {
  std::error_code ignored;
  const fs::path file = path / kBagMetadataFile;
  if (!fs::is_regular_file(file, ignored)) return false;
  return read_start(file, kBagMetadataStart.size()) == kBagMetadataStart;
}

std::unique_ptr<const BagReader> join_bags(const fs::path& path,
                                           std::vector<std::unique_ptr<const BagReader>> parts,
                                           std::vector<std::string> remarks) {
  return std::make_unique<JoinedBag>(path, std::move(parts), std::move(remarks));
}

std::unique_ptr<const BagReader> open_bag(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored) ? open_bag_folder(path) : open_bag_file(path);
}

}  // namespace mosbench
