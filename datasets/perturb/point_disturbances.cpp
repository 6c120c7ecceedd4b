#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "datasets/formats/point_range.hpp"
#include "datasets/perturb/perturbation.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

/// Calls `change` with the index of every return.
template <typename Change>
void for_returns(Frame& frame, Change&& change) {
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    if (is_return(frame.points[i])) change(i);
  }
}

/// Adds to a range, without letting the return come nearer than 1 cm.
void add_to_range(Point& point, double by_m) {
  constexpr double kNearest_m = 0.01;
  const double now_m = range_m(point);
  set_range(point, now_m, std::max(now_m + by_m, std::min(now_m, kNearest_m)));
}

Point moved(const Pose& pose, const Point& point) {
  const Eigen::Vector3d p =
      pose.translation() + rotated(pose.linear(), Eigen::Vector3d(point.x, point.y, point.z));
  return {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()),
          point.intensity};
}

template <typename Probability>
ChangePoints lose_by(const Draws& draws, Probability&& probability) {
  return [=](std::size_t source, Frame& frame) {
    const Draws of_scan = draws.of(source);
    for_returns(frame, [&](std::size_t i) {
      if (of_scan.uniform(i) < probability(frame.points[i])) lose_point(frame, i);
    });
  };
}

/// Returns the beam of a return from the sines of the elevations between two beams, falling.
std::size_t beam_of(const Point& point, const std::vector<double>& sines_between) {
  const double sine = point.z / range_m(point);
  const auto below =
      std::ranges::partition_point(sines_between, [&](double s) { return s > sine; });
  return static_cast<std::size_t>(below - sines_between.begin());
}

std::vector<double> sines_between_beams(const Perturbation& shared) {
  const double step_deg =
      (*shared.beams_top_deg - *shared.beams_bottom_deg) / static_cast<double>(shared.beams_of - 1);
  std::vector<double> sines;
  for (std::size_t beam = 0; beam + 1 < shared.beams_of; ++beam) {
    const double edge_deg = *shared.beams_top_deg - (static_cast<double>(beam) + 0.5) * step_deg;
    sines.push_back(sin_cos(edge_deg * kRadPerDeg).sin);
  }
  return sines;
}

/// Points lie beam by beam in columns where every scan has all of them.
void check_columns(const PerturbContext& context) {
  const std::size_t beams = context.shared.beams_of;
  for (const ScanEntry& scan : context.original.scans) {
    const bool whole = scan.points > 0 && scan.points % beams == 0 &&
                       scan.points == context.original.scans.front().points;
    if (whole) continue;
    throw UsageError(fmt::format(
        "{}: beams: scan {} of {} has {} points, which are no columns of {} beams, expected "
        "beams_top_deg and beams_bottom_deg, the elevations of the outer beams",
        option("perturb"), scan.stem, context.original.name.text(), scan.points, beams));
  }
}

/// The sensor's motion to the next scan, and back to the one before, as rotation vector and
/// translation.
struct Motions {
  struct Way {
    Eigen::Vector3d rotation_rad, translation_m;
  };
  Way next, before;
};

Motions::Way way(const Pose& from, const Pose& to, double sign) {
  const Pose step = compose(inverse_of(from), to);
  const Pose signed_step = sign > 0 ? step : inverse_of(step);
  return {rotation_vector(signed_step.linear()), signed_step.translation()};
}

/// At the ends of the sequence the motion goes on as it was.
std::vector<Motions> motions_of(const std::vector<ScanEntry>& scans) {
  const Motions::Way none{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  std::vector<Motions> motions(scans.size(), {none, none});
  for (std::size_t k = 0; k + 1 < scans.size(); ++k) {
    const Pose &here = scans[k].map_from_sensor, &there = scans[k + 1].map_from_sensor;
    motions[k].next = way(here, there, 1);
    motions[k + 1].before = way(there, here, 1);
    if (k == 0) motions[k].before = way(here, there, -1);
    if (k + 2 == scans.size()) motions[k + 1].next = way(there, here, -1);
  }
  return motions;
}

/// Returns the motion after a share of the way to the next scan, or to the one before if negative.
Pose part_of(const Motions& motions, double share) {
  const Motions::Way& whole = share < 0 ? motions.before : motions.next;
  Pose part = Pose::Identity();
  part.linear() = rotation_of(whole.rotation_rad * std::abs(share));
  part.translation() = whole.translation_m * std::abs(share);
  return part;
}

}  // namespace

ChangePoints range_noise(const PerturbContext& context) {
  return [draws = context.draws, sigma_m = context.strength](std::size_t source, Frame& frame) {
    const Draws of_scan = draws.of(source);
    for_returns(frame,
                [&](std::size_t i) { add_to_range(frame.points[i], sigma_m * of_scan.normal(i)); });
  };
}

ChangePoints range_bias(const PerturbContext& context) {
  return [bias_m = context.strength](std::size_t, Frame& frame) {
    for_returns(frame, [&](std::size_t i) { add_to_range(frame.points[i], bias_m); });
  };
}

ChangePoints dropout(const PerturbContext& context) {
  return lose_by(context.draws, [p = context.strength](const Point&) { return p; });
}

ChangePoints dropout_by_range(const PerturbContext& context) {
  return lose_by(context.draws, [per_m = context.strength](const Point& point) {
    return 1 - exponential(-per_m * range_m(point));
  });
}

ChangePoints fewer_beams(const PerturbContext& context) {
  const std::size_t beams = context.shared.beams_of;
  const std::size_t stride = beams / static_cast<std::size_t>(context.strength);
  if (context.shared.beams_top_deg) {
    return [stride, between = sines_between_beams(context.shared)](std::size_t, Frame& frame) {
      for_returns(frame, [&](std::size_t i) {
        if (beam_of(frame.points[i], between) % stride != 0) lose_point(frame, i);
      });
    };
  }
  check_columns(context);
  return [=](std::size_t, Frame& frame) {
    for_returns(frame, [&](std::size_t i) {
      if (i % beams % stride != 0) lose_point(frame, i);
    });
  };
}

ChangePoints mount_tilt(const PerturbContext& context) {
  // Looking down is a positive turn about y, to the left.
  Pose tilted_from_sensor = Pose::Identity();
  tilted_from_sensor.linear() = rotation_of({0, -context.strength * kRadPerDeg, 0});
  return [tilted_from_sensor](std::size_t, Frame& frame) {
    for_returns(frame, [&](std::size_t i) {
      frame.points[i] = moved(tilted_from_sensor, frame.points[i]);
    });
  };
}

ChangePoints time_warp(const PerturbContext& context) {
  const auto motions =
      std::make_shared<const std::vector<Motions>>(motions_of(context.original.scans));
  return [motions, turns = context.strength](std::size_t source, Frame& frame) {
    for_returns(frame, [&](std::size_t i) {
      Point& point = frame.points[i];
      const double share = -turns * angle_of(point.y, point.x) / kFullTurn_rad;
      point = moved(inverse_of(part_of((*motions)[source], share)), point);
    });
  };
}

}  // namespace mosbench
