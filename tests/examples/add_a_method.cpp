// A method of one's own, against the public interface alone: a point moves when its voxel was empty
// in all scans before. To run it as `mosbench run --method new-voxels`, put the class and
// new_voxels() into a folder core/new_voxels and the row into core/methods.cpp; presets, --set,
// tables and reports follow.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <mosbench/method.hpp>
#include <optional>
#include <set>
#include <stdexcept>
#include <tuple>
#include <vector>

namespace {

using Voxel = std::tuple<long, long, long>;

/// A scan as voxels, one per point; none for a point that is not finite.
struct Voxels : mosbench::Observed {
  std::vector<std::optional<Voxel>> of_points;
};

class NewVoxels : public mosbench::Method {
 public:
  explicit NewVoxels(const mosbench::Settings& settings)
      : voxel_size_m_(settings.number("voxel_size_m")) {}

  using Method::push;

  std::unique_ptr<mosbench::Observed> observe(std::span<const mosbench::Point> points,
                                              const mosbench::Pose& map_from_sensor) override {
    auto voxels = std::make_unique<Voxels>();
    for (const mosbench::Point& point : points) {
      const Eigen::Vector3d p =
          map_from_sensor * Eigen::Vector3d(point.x, point.y, point.z) / voxel_size_m_;
      auto& voxel = voxels->of_points.emplace_back();
      if (!p.allFinite()) continue;
      if (p.cwiseAbs().maxCoeff() > 1e9) throw std::range_error("a point is out of reach");
      voxel.emplace(std::lround(p.x()), std::lround(p.y()), std::lround(p.z()));
    }
    return voxels;
  }

  std::vector<mosbench::LabelledScan> push(std::unique_ptr<mosbench::Observed> observed) override {
    const auto* voxels = dynamic_cast<const Voxels*>(observed.get());
    if (voxels == nullptr) throw std::logic_error("another method observed this scan");
    if (finished_) throw std::logic_error("pushed a scan after finish");
    mosbench::LabelledScan scan;
    scan.scan_index = scan_count_++;
    scan.judged = scan.scan_index > 0;  // the first scan has nothing to have moved from
    for (const auto& voxel : voxels->of_points) {
      const bool moves = scan.judged && voxel && !seen_.contains(*voxel);
      scan.labels.push_back(moves ? mosbench::kMovingLabel : mosbench::kStaticLabel);
      scan.nonfinite_points += !voxel;
    }
    for (const auto& voxel : voxels->of_points) {
      if (voxel) seen_.insert(*voxel);
    }
    return {scan};
  }

  std::vector<mosbench::LabelledScan> finish() override {
    finished_ = true;
    return {};
  }

 private:
  double voxel_size_m_;
  std::size_t scan_count_ = 0;
  bool finished_ = false;
  std::set<Voxel> seen_;
};

mosbench::Settings default_settings() {
  mosbench::Setting voxel_size;
  voxel_size.name = "voxel_size_m";
  voxel_size.value = 0.5;
  voxel_size.meaning = "edge of a voxel";
  voxel_size.lowest = 0.01;
  voxel_size.highest = 10.0;
  return mosbench::Settings({voxel_size});
}

mosbench::MethodKind new_voxels() {
  return {.name = "new-voxels",
          .title = "New voxels",
          .source = "tests/examples/add_a_method.cpp",
          .summary = "a point moves when its voxel was empty in all scans before",
          .defaults = default_settings(),
          .check = [](const mosbench::Settings&) {},
          .make = [](const mosbench::Settings& settings,
                     const mosbench::RunContext&) -> std::unique_ptr<mosbench::Method> {
            return std::make_unique<NewVoxels>(settings);
          }};
}

}  // namespace

/// Shows a wall of ten points and one point that moves by a metre per scan; prints how many move.
int main() {
  const mosbench::MethodKind kind = new_voxels();
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
