#include <cstdio>
#include <mosbench/method.hpp>
#include <vector>

int main() {
  const mosbench::MethodKind& kind = *mosbench::find_method("hmm-mos");
  const auto method = kind.make(kind.defaults, {});
  const std::vector<mosbench::Point> points = {{2, 0, 0, 0}, {2, 1, 0, 0}, {0, 3, 1, 0}};
  for (const auto& scan : method->push(points, mosbench::Pose::Identity())) {
    for (const auto label : scan.labels) std::printf("%u\n", label);
  }
}
