#pragma once

#include <fcntl.h>
#include <spawn.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <mosbench/scan.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>
#include <set>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "core/methods/hmm_mos/config.hpp"
#include "tests/shared_folder.hpp"

/// The labels of the authors' own program on four sequences, which lie beside the project where its
/// owner keeps them. Their files are read here without the project's readers, so that a test that
/// compares with them does not depend on what it may be testing.
namespace mosbench::parity {
using namespace hmm_mos;

struct Counts {
  std::uint64_t tp, fp, fn;
  bool operator==(const Counts&) const = default;
};

inline void PrintTo(const Counts& counts, std::ostream* out) {
  *out << "tp " << counts.tp << " fp " << counts.fp << " fn " << counts.fn;
}

struct ParityCase {
  std::string name, sequence;
  Config config;
  std::size_t scans, points, predicted_moving_points;
  Counts truth_unlabelled_ignored, truth_unlabelled_static;
  std::vector<Counts> per_scan_unlabelled_ignored;
};

inline void PrintTo(const ParityCase& parity, std::ostream* out) { *out << parity.name; }

/// Nothing where the owner's folder is not there: such tests are skipped.
inline std::optional<std::filesystem::path> shared_parity_folder() {
  const std::filesystem::path folder = shared_folder() / "parity";
  if (!std::filesystem::exists(folder / "unpack.sh")) return std::nullopt;
  return std::filesystem::canonical(folder);
}

inline constexpr const char* kSkipMessage =
    "the parity cases are not there: set MOSBENCH_SHARED to the folder that holds parity/";

/// Holds a lock file until it goes out of scope; other processes wait.
class FileLock {
 public:
  explicit FileLock(const std::filesystem::path& file)
      : descriptor_(open(file.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644)) {
    if (descriptor_ < 0 || flock(descriptor_, LOCK_EX) != 0) {
      throw std::runtime_error(file.string() + ": cannot be locked");
    }
  }
  ~FileLock() { close(descriptor_); }
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  int descriptor_;
};

inline void run(std::string program, std::vector<std::string> words) {
  std::vector<char*> arguments = {program.data()};
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t child = 0;
  int status = -1;
  const int failed =
      posix_spawn(&child, program.c_str(), nullptr, nullptr, arguments.data(), environ);
  if (failed != 0 || waitpid(child, &status, 0) != child || status != 0) {
    throw std::runtime_error(program + " " + words.front() + ": failed");
  }
}

/// The folder with sequences/<name> and cases/<name>/expected, unpacked below the build folder by
/// whichever test comes first (10 s, 0.5 GB).
inline std::optional<std::filesystem::path> parity_root() {
  static const std::optional<std::filesystem::path> root =
      []() -> std::optional<std::filesystem::path> {
    const std::optional<std::filesystem::path> shared = shared_parity_folder();
    if (!shared) return std::nullopt;
    const std::filesystem::path binary = MOSBENCH_BINARY_DIR;
    const FileLock lock(binary / "parity.lock");
    run((*shared / "unpack.sh").string(), {(binary / "parity").string()});
    return binary / "parity";
  }();
  return root;
}

inline Counts parse_counts(const nlohmann::json& json) {
  return {json.at("tp").get<std::uint64_t>(), json.at("fp").get<std::uint64_t>(),
          json.at("fn").get<std::uint64_t>()};
}

/// Every key has to be a field; a field without key keeps its default (release-2025 has no dynamic
/// window).
inline Config parse_config(const nlohmann::json& json, const std::string& variant) {
  Settings settings = settings_of(Config{});
  settings.set("variant", variant);
  for (const auto& [key, value] : json.items()) {
    const bool whole = std::holds_alternative<int>(settings.find(key)->value);
    settings.set(key, whole ? SettingValue(value.get<int>()) : SettingValue(value.get<double>()));
  }
  return config_of<Config>(settings);
}

inline ParityCase parse_case(const std::filesystem::path& file) {
  std::ifstream stream(file);
  const nlohmann::json json = nlohmann::json::parse(stream);
  ParityCase parity{
      .name = json.at("case").get<std::string>(),
      .sequence = json.at("sequence").get<std::string>(),
      .config = parse_config(json.at("config"), json.at("variant").get<std::string>()),
      .scans = json.at("scans").get<std::size_t>(),
      .points = json.at("points").get<std::size_t>(),
      .predicted_moving_points = json.at("predicted_moving_points").get<std::size_t>(),
      .truth_unlabelled_ignored = parse_counts(json.at("truth_unlabelled_ignored")),
      .truth_unlabelled_static = parse_counts(json.at("truth_unlabelled_static")),
      .per_scan_unlabelled_ignored = {}};
  for (const nlohmann::json& scan : json.at("per_scan_counts_unlabelled_ignored")) {
    const auto [tp, fp, fn] = scan.get<std::array<std::uint64_t, 3>>();
    parity.per_scan_unlabelled_ignored.push_back({tp, fp, fn});
  }
  return parity;
}

/// All cases by name; none where the owner's folder is not there. Unpacks nothing.
inline std::vector<ParityCase> parity_cases() {
  std::vector<ParityCase> cases;
  const std::optional<std::filesystem::path> shared = shared_parity_folder();
  if (!shared) return cases;
  for (const auto& entry : std::filesystem::directory_iterator(*shared / "cases")) {
    cases.push_back(parse_case(entry.path() / "case.json"));
  }
  std::ranges::sort(cases, {}, &ParityCase::name);
  return cases;
}

/// The file as an array of records; throws when it is no whole number of them.
template <typename Record>
std::vector<Record> read_records(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::size_t bytes = std::filesystem::file_size(file);
  std::vector<Record> records(bytes / sizeof(Record));
  stream.read(reinterpret_cast<char*>(records.data()), static_cast<std::streamsize>(bytes));
  if (!stream || bytes % sizeof(Record) != 0) throw std::runtime_error(file.string() + ": size");
  return records;
}

/// "000012" of 12.
inline std::string stem(std::size_t scan_index) {
  const std::string digits = std::to_string(scan_index);
  return std::string(6 - digits.size(), '0') + digits;
}

inline std::filesystem::path sequence_folder(const ParityCase& parity) {
  return parity_root().value() / "sequences" / parity.sequence;
}

inline std::vector<Point> points_of(const ParityCase& parity, std::size_t scan_index) {
  return read_records<Point>(sequence_folder(parity) / "velodyne" / (stem(scan_index) + ".bin"));
}

inline std::vector<std::uint32_t> truth_of(const ParityCase& parity, std::size_t scan_index) {
  return read_records<std::uint32_t>(sequence_folder(parity) / "labels" /
                                     (stem(scan_index) + ".label"));
}

/// What the authors' program labelled: 9 or 251 per point.
inline std::vector<std::uint32_t> expected_of(const ParityCase& parity, std::size_t scan_index) {
  return read_records<std::uint32_t>(parity_root().value() / "cases" / parity.name / "expected" /
                                     (stem(scan_index) + ".label"));
}

/// map_from_sensor of every scan.
inline std::vector<Pose> poses_of(const ParityCase& parity) {
  std::ifstream stream(sequence_folder(parity) / "poses.txt");
  std::vector<Pose> poses(parity.scans, Pose::Identity());
  for (Pose& pose : poses) {
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column) stream >> pose.matrix()(row, column);
    }
  }
  if (!stream) throw std::runtime_error(parity.name + ": poses.txt has too few numbers");
  return poses;
}

}  // namespace mosbench::parity
