#include <unistd.h>

#include <filesystem>

#include "bench/stage_benchmark.hpp"
#include "datasets/formats/bin_file.hpp"
#include "datasets/formats/label_file.hpp"

namespace mosbench {
namespace {

/// A file that is deleted with its benchmark.
class ScratchFile {
 public:
  explicit ScratchFile(const char* extension)
      : path_(std::filesystem::temp_directory_path() /
              ("mosbench_bench_" + std::to_string(getpid()) + extension)) {}
  ~ScratchFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

void read_stage(benchmark::State& state, StagedScans& staged, ThreadPool&) {
  const std::vector<Point>& written = staged.last().frame.points;
  const ScratchFile file(".bin");
  write_bin(file.path(), written);
  std::vector<Point> points;
  for (auto _ : state) points = read_bin(file.path());
  count_items(state, "points", points.size());
  expect(state, format_bin(points) == format_bin(written));
}

void write_stage(benchmark::State& state, StagedScans& staged, ThreadPool&) {
  const ScratchFile file(".label");
  for (auto _ : state) write_labels(file.path(), staged.last().labels);
  count_items(state, "points", staged.last().labels.size());
  expect(state, read_labels(file.path(), staged.last().labels.size()) == staged.last().labels);
}

const RegisterStage read_registered("read", read_stage, false);
const RegisterStage write_registered("write", write_stage, false);

}  // namespace
}  // namespace mosbench
