// Shows a method of one's own, new_voxels.hpp, a wall of ten points and one point that moves by a
// metre per scan, and prints how many move.
#include <algorithm>
#include <cstdio>
#include <vector>

#include "tests/examples/new_voxels.hpp"

int main() {
  const mosbench::MethodKind kind = mosbench::new_voxels::method_kind();
  const auto method = kind.make(kind.defaults, {});
  for (int k = 0; k < 4; ++k) {
    std::vector<mosbench::Point> points;
    for (int i = 0; i < 10; ++i) points.push_back({5.0F, 0.5F * static_cast<float>(i), 0, 0});
    points.push_back({3.0F, static_cast<float>(k), 0, 0});
    for (const mosbench::LabelledScan& scan : method->push(points, mosbench::Pose::Identity())) {
      const auto moving =
          std::count(scan.labels.begin(), scan.labels.end(), mosbench::kMovingLabel);
      std::printf("scan %zu: %td of %zu points move\n", scan.scan_index, moving, points.size());
    }
  }
}
