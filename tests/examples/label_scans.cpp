// label_scans SEQUENCE OUT: segments SEQUENCE/velodyne/*.bin with the poses of SEQUENCE/poses.txt
// (map from LiDAR, 12 numbers a row) and writes OUT/<scan>.label, a uint32 per point. Needs
// mosbench::core only.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <mosbench/method.hpp>
#include <string>
#include <vector>

namespace fs = std::filesystem;

std::vector<mosbench::Point> read_scan(const fs::path& file) {
  std::vector<mosbench::Point> points(fs::file_size(file) / sizeof(mosbench::Point));
  std::ifstream stream(file, std::ios::binary);
  stream.read(reinterpret_cast<char*>(points.data()),
              static_cast<std::streamsize>(points.size() * sizeof(mosbench::Point)));
  return points;
}

mosbench::Pose read_pose(std::istream& rows) {
  mosbench::Pose pose = mosbench::Pose::Identity();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) rows >> pose.matrix()(row, column);
  }
  return pose;
}

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: label_scans SEQUENCE OUT\n", stderr);
    return 2;
  }
  const fs::path sequence = argv[1], out = argv[2];
  std::vector<fs::path> scans;
  for (const auto& entry : fs::directory_iterator(sequence / "velodyne")) {
    scans.push_back(entry.path());
  }
  std::sort(scans.begin(), scans.end());
  fs::create_directories(out);

  const mosbench::MethodKind* kind = mosbench::find_method("hmm-mos");
  mosbench::Settings settings = kind->defaults;
  settings.set("max_range_m", 50.0);
  const auto method = kind->make(settings, {.threads = 2, .scan_count = scans.size()});

  const auto write = [&](const std::vector<mosbench::LabelledScan>& labelled) {
    for (const mosbench::LabelledScan& scan : labelled) {
      const fs::path name = scans[scan.scan_index].stem().string() + ".label";
      std::ofstream(out / name, std::ios::binary)
          .write(reinterpret_cast<const char*>(scan.labels.data()),
                 static_cast<std::streamsize>(scan.labels.size() * sizeof(scan.labels[0])));
    }
  };
  std::ifstream poses(sequence / "poses.txt");
  for (const fs::path& scan : scans) {
    const mosbench::Pose map_from_sensor = read_pose(poses);
    if (!poses) {
      std::fprintf(stderr, "%s/poses.txt: has fewer rows than scans\n", sequence.c_str());
      return 3;
    }
    write(method->push(read_scan(scan), map_from_sensor));
  }
  write(method->finish());  // with delay_scans set, the last labels come here
}
