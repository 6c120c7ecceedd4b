// Labels scans for `mosbench run DATA --method exec:./client`: a point moves when its voxel was
// empty in all scans before. Needs nothing of mosbench; docs/formats/exec.md has the messages. For
// little-endian machines.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>
#include <unordered_set>
#include <vector>

namespace {

constexpr std::uint32_t kStatic = 9, kMoving = 251;
constexpr double kVoxelSizeM = 0.5;
constexpr std::int64_t kShift = std::int64_t{1} << 20;  // voxels per axis, half of them negative

struct Message {
  std::string tag;
  std::string payload;
};

/// Returns false when stdin was closed.
bool receive(Message& message) {
  char tag[8];
  std::uint64_t size = 0;
  if (std::fread(tag, 1, 8, stdin) != 8 || std::fread(&size, 8, 1, stdin) != 1) return false;
  message.tag.assign(tag, 8);
  message.payload.resize(size);
  return std::fread(message.payload.data(), 1, size, stdin) == size;
}

void send(const char* tag, const std::string& payload) {
  const std::uint64_t size = payload.size();
  std::fwrite(tag, 1, 8, stdout);
  std::fwrite(&size, 8, 1, stdout);
  std::fwrite(payload.data(), 1, size, stdout);
  std::fflush(stdout);
}

template <typename Number>
Number number_at(const std::string& bytes, std::size_t offset) {
  Number number;
  std::memcpy(&number, bytes.data() + offset, sizeof number);
  return number;
}

template <typename Number>
void append(std::string& bytes, Number number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

class NewVoxels {
 public:
  /// Answers a MOSscan with the payload of a MOSlabel.
  std::string label(const std::string& scan, bool with_scores) {
    const auto index = number_at<std::uint64_t>(scan, 0);
    const auto count = number_at<std::uint64_t>(scan, 112);
    std::vector<std::int64_t> keys;
    std::string answer, scores;
    append(answer, index);
    append(answer, count);
    for (std::uint64_t i = 0; i < count; ++i) {
      keys.push_back(key_of(scan, 120 + 16 * i));
      const bool moves = index > 0 && !seen_.contains(keys.back());
      append(answer, moves ? kMoving : kStatic);
      append(scores, moves ? 1.0F : 0.0F);
    }
    seen_.insert(keys.begin(), keys.end());
    return with_scores ? answer + scores : answer;
  }

 private:
  static std::int64_t key_of(const std::string& scan, std::size_t at) {
    const double x = number_at<float>(scan, at), y = number_at<float>(scan, at + 4),
                 z = number_at<float>(scan, at + 8);
    std::int64_t key = 0;
    for (std::size_t row = 0; row < 3; ++row) {
      const auto pose = [&](std::size_t column) {
        return number_at<double>(scan, 16 + 32 * row + 8 * column);
      };
      const double in_map = pose(0) * x + pose(1) * y + pose(2) * z + pose(3);
      const double voxels = std::isfinite(in_map) ? std::floor(in_map / kVoxelSizeM) : 0.0;
      const auto voxel = static_cast<std::int64_t>(voxels);
      key = key * kShift + voxel + kShift / 2;
    }
    return key;
  }

  std::unordered_set<std::int64_t> seen_;
};

}  // namespace

int main() {
  Message message;
  if (!receive(message) || message.tag != "MOShello" ||
      number_at<std::uint32_t>(message.payload, 0) != 1) {
    std::fputs("client: speaks version 1 only\n", stderr);
    return 1;
  }
  const auto wants_scores = number_at<std::uint32_t>(message.payload, 16);
  std::string ready;
  append(ready, std::uint32_t{1});
  append(ready, wants_scores);
  send("MOSready", ready);
  NewVoxels method;
  while (receive(message)) send("MOSlabel", method.label(message.payload, wants_scores != 0));
}
