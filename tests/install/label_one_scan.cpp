#include <cstdio>
#include <vector>

#include "core/hmm_mos/pipeline.hpp"

int main() {
  mosbench::Pipeline pipeline(mosbench::Config{}, mosbench::Variant::kPaper2024);
  const std::vector<mosbench::Point> points = {{2, 0, 0, 0}, {2, 1, 0, 0}, {0, 3, 1, 0}};
  for (const auto& scan : pipeline.push(points, mosbench::Pose::Identity())) {
    for (const auto label : scan.labels) std::printf("%u\n", label);
  }
}
