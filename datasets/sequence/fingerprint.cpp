#include "datasets/sequence/fingerprint.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <cstdint>
#include <new>
#include <system_error>
#include <type_traits>

#include "datasets/files/errors.hpp"

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

}  // namespace

void ContentFingerprint::FreeState::operator()(XXH3_state_s* state) const { XXH3_freeState(state); }

ContentFingerprint::ContentFingerprint() : state_(XXH3_createState()) {
  if (!state_) throw std::bad_alloc();
  XXH3_128bits_reset(state_.get());
}

void ContentFingerprint::add(const Frame& frame) {
  add_range(*state_, frame.stem);
  add_range(*state_, frame.points);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      add_value(*state_, frame.map_from_sensor.matrix()(row, column));
    }
  }
  add_value(*state_, static_cast<std::uint64_t>(frame.stamp_ns.has_value()));
  if (frame.stamp_ns) add_value(*state_, *frame.stamp_ns);
  add_value(*state_, static_cast<std::uint64_t>(frame.truth.has_value()));
  if (frame.truth) add_range(*state_, *frame.truth);
}

std::string ContentFingerprint::hex() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(state_.get());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

TruthHash truth_hash(std::span<const std::uint32_t> labels) {
  TruthHash hash;
  fmt::format_to_n(hash.data(), hash.size(), "{:016x}",
                   XXH3_64bits(labels.data(), labels.size_bytes()));
  return hash;
}

std::string file_stamp(const Sequence& sequence) {
  std::string listing;
  for (const std::filesystem::path& file : sequence.files()) {
    std::error_code error;
    const auto size_bytes = std::filesystem::file_size(file, error);
    if (error) throw DataError(file, "is gone (" + error.message() + ")", "a readable file");
    const auto changed = std::filesystem::last_write_time(file, error);
    if (error) throw DataError(file, "is gone (" + error.message() + ")", "a readable file");
    listing +=
        fmt::format("{}\n{} {}\n", std::filesystem::absolute(file).lexically_normal().string(),
                    size_bytes, static_cast<std::int64_t>(changed.time_since_epoch().count()));
  }
  const XXH128_hash_t hash = XXH3_128bits(listing.data(), listing.size());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

}  // namespace mosbench
