#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "datasets/disk/files.hpp"
#include "datasets/doctor/doctor.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/layouts/dataset.hpp"
#include "datasets/sequence/pose_mark.hpp"
#include "eval/cli/flags.hpp"
#include "eval/engine/pose_finding.hpp"
#include "eval/job/job.hpp"
#include "eval/python/bindings.hpp"
#include "eval/result/reading_json.hpp"

namespace mosbench::python {
namespace {

using namespace py::literals;

using SharedDataset = std::shared_ptr<Dataset>;

/// One sequence, which keeps its data set alive.
struct OpenSequence {
  SharedDataset dataset;
  const Sequence* sequence;
};

SharedDataset open_shared(const std::filesystem::path& path, const std::string& kind,
                          const std::vector<std::string>& sequences,
                          const std::vector<std::string>& reading_flags, bool with_poses) {
  OpenOptions options{dataset_kind_option(kind), sequences, reading_of(reading_flags)};
  if (!with_poses) options.reading.poses = ByOdometry{};
  const py::gil_scoped_release released;
  return std::make_shared<Dataset>(open_dataset(path, options));
}

/// Returns where the ray of each point starts, (N, 3); None where all start at the sensor.
py::object origins_of(const RayOrigins& origins) {
  if (origins.empty()) return py::none();
  py::array_t<double> rows({origins.of_point.size(), std::size_t{3}});
  double* row = rows.mutable_data();
  for (std::size_t i = 0; i < origins.of_point.size(); ++i, row += 3) {
    Eigen::Map<Eigen::Vector3d>{row} = origins.at(i);
  }
  return rows;
}

py::dict read_scan(const OpenSequence& opened, std::size_t scan_index) {
  if (scan_index >= opened.sequence->size()) throw py::index_error("no such scan");
  Frame frame;
  {
    const py::gil_scoped_release released;
    opened.sequence->read(scan_index, frame);
  }
  return py::dict(
      "index"_a = scan_index, "stem"_a = frame.stem, "points"_a = array_of(std::move(frame.points)),
      "pose"_a = matrix_of(frame.map_from_sensor.matrix()), "stamp_ns"_a = frame.stamp_ns,
      "point_times_ns"_a = array_or_none(std::move(frame.point_times_ns)),
      "radial_velocity_m_s"_a = array_or_none(std::move(frame.radial_velocity_m_s)),
      "origins"_a = origins_of(frame.origins),
      "truth"_a = frame.truth ? py::object(array_of(std::move(*frame.truth))) : py::none());
}

py::array_t<double> poses_of(const OpenSequence& opened) {
  const std::size_t count = opened.sequence->size();
  py::array_t<double> poses({count, std::size_t{4}, std::size_t{4}});
  using Rows = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
  for (std::size_t k = 0; k < count; ++k) {
    Eigen::Map<Rows>(poses.mutable_data() + 16 * k) = opened.sequence->map_from_sensor(k).matrix();
  }
  return poses;
}

std::vector<OpenSequence> sequences_of(const SharedDataset& dataset) {
  std::vector<OpenSequence> sequences;
  for (const auto& sequence : dataset->sequences) sequences.push_back({dataset, sequence.get()});
  return sequences;
}

/// Writes KITTI's rows, marked as the lidar's, or with stamps those of TUM.
void write_pose_file(const std::filesystem::path& file, const std::vector<py::array>& matrices,
                     const std::optional<std::vector<std::int64_t>>& stamps_ns) {
  std::vector<Pose> poses;
  for (const py::array& matrix : matrices) poses.push_back(pose_of(matrix));
  const std::string rows = stamps_ns ? tum_rows(*stamps_ns, poses) : format_poses(poses);
  if (!stamps_ns && has_foreign_mark(file)) {
    throw DataError(file.string() + ".frame", "is no mark of poses", "another name of the poses");
  }
  if (!stamps_ns) mark_poses(file, rows, {});
  write_file_atomic(file, rows);
}

}  // namespace

void bind_datasets(py::module_& module) {
  module.def("open", open_shared);
  module.def("reading_names", [] { return names_of(reading_fields()); });
  module.def("write_poses", write_pose_file);
  py::class_<Dataset, SharedDataset>(module, "Dataset")
      .def_property_readonly("kind",
                             [](const Dataset& d) { return std::string(to_string(d.kind)); })
      .def_property_readonly("root", [](const Dataset& d) { return d.root; })
      .def_property_readonly("remarks", [](const Dataset& d) { return d.remarks; })
      .def("sequences", sequences_of);
  py::class_<OpenSequence>(module, "Sequence")
      .def_property_readonly("name", [](const OpenSequence& s) { return s.sequence->name(); })
      .def_property_readonly("remarks", [](const OpenSequence& s) { return s.sequence->remarks(); })
      .def_property_readonly("warnings",
                             [](const OpenSequence& s) { return doubts_of(*s.sequence); })
      .def_property_readonly(
          "simulated", [](const OpenSequence& s) { return s.sequence->simulated().has_value(); })
      .def_property_readonly("poses", poses_of)
      .def("__len__", [](const OpenSequence& s) { return s.sequence->size(); })
      .def("read", read_scan);
}

}  // namespace mosbench::python
