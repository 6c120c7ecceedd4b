#include "datasets/sequence/fingerprint.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <xxhash.h>

#include <cerrno>
#include <cstring>
#include <new>
#include <type_traits>

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

template <typename Value>
void add_value(XXH3_state_t& state, const Value& value) {
  static_assert(std::has_unique_object_representations_v<Value> || std::is_floating_point_v<Value>);
  XXH3_128bits_update(&state, &value, sizeof(value));
}

/// Adds the count first, so that no two sequences of fields give the same bytes.
template <typename Range>
void add_range(XXH3_state_t& state, const Range& range) {
  add_value(state, static_cast<std::uint64_t>(range.size()));
  if (range.size() == 0) return;
  XXH3_128bits_update(&state, range.data(), range.size() * sizeof(*range.data()));
}

/// Copies may keep size and time of modification; no program can set the time of the last change of
/// the inode.
std::string state_of(const std::filesystem::path& file) {
  struct stat state = {};
  if (stat(file.c_str(), &state) != 0) {
    throw DataError(file, fmt::format("is gone ({})", std::strerror(errno)), "a readable file");
  }
  return fmt::format("{} {} {}.{:09} {}.{:09}", state.st_size, state.st_ino, state.st_mtim.tv_sec,
                     state.st_mtim.tv_nsec, state.st_ctim.tv_sec, state.st_ctim.tv_nsec);
}

std::string hex_of(const XXH128_hash_t& hash) {
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

}  // namespace

void ContentFingerprint::FreeState::operator()(XXH3_state_s* state) const { XXH3_freeState(state); }

ContentFingerprint::ContentFingerprint(Of of) : of_(of), state_(XXH3_createState()) {
  if (!state_) throw std::bad_alloc();
  XXH3_128bits_reset(state_.get());
}

void ContentFingerprint::add_pose(const Pose& pose) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) add_value(*state_, pose.matrix()(row, column));
  }
}

void ContentFingerprint::add(const Frame& frame) {
  add_range(*state_, frame.stem);
  add_range(*state_, frame.points);
  if (of_ == Of::kAll) add_pose(frame.map_from_sensor);
  add_value(*state_, static_cast<std::uint64_t>(frame.stamp_ns.has_value()));
  if (frame.stamp_ns) add_value(*state_, *frame.stamp_ns);
  add_value(*state_, static_cast<std::uint64_t>(frame.truth.has_value()));
  if (frame.truth) add_range(*state_, *frame.truth);
}

std::string ContentFingerprint::hex() const { return hex_of(XXH3_128bits_digest(state_.get())); }

std::string hash_of_text(std::string_view text) {
  return hex_of(XXH3_128bits(text.data(), text.size()));
}

std::string hash_of_file(const std::filesystem::path& file) {
  constexpr std::uintmax_t kEndBytes = 16U << 20U;
  const std::uintmax_t size_bytes = size_of(file);
  std::string bytes = std::to_string(size_bytes) + "\n";
  if (size_bytes <= 2 * kEndBytes) {
    bytes += read_file(file);
  } else {
    bytes += read_part(file, 0, kEndBytes) + read_part(file, size_bytes - kEndBytes, kEndBytes);
  }
  return hash_of_text(bytes);
}

LabelHash hash_of_labels(std::span<const std::uint32_t> labels) {
  LabelHash hash;
  fmt::format_to_n(hash.data(), hash.size(), "{:016x}",
                   XXH3_64bits(labels.data(), labels.size_bytes()));
  return hash;
}

std::string file_stamp(const Sequence& sequence) {
  std::string listing;
  for (const std::filesystem::path& file : sequence.files()) {
    listing += fmt::format("{}\n{}\n", std::filesystem::absolute(file).lexically_normal().string(),
                           state_of(file));
  }
  return hash_of_text(listing);
}

}  // namespace mosbench
