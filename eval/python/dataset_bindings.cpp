#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "datasets/disk/files.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/layouts/dataset.hpp"
#include "datasets/sequence/pose_source.hpp"
#include "eval/cli/flags.hpp"
#include "eval/engine/pose_finding.hpp"
#include "eval/job/job_words.hpp"
#include "eval/python/arrays.hpp"
#include "eval/python/bindings.hpp"

namespace mosbench::python {
namespace {

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

py::dict read_scan(const OpenSequence& opened, std::size_t scan_index) {
  if (scan_index >= opened.sequence->size()) throw py::index_error("no such scan");
  Frame frame;
  {
    const py::gil_scoped_release released;
    opened.sequence->read(scan_index, frame);
  }
  py::dict scan;
  scan["index"] = scan_index;
  scan["stem"] = frame.stem;
  scan["points"] = array_of(std::move(frame.points));
  scan["pose"] = matrix_of(frame.map_from_sensor);
  scan["stamp_ns"] = frame.stamp_ns;
  const bool timed = !frame.point_times_ns.empty();
  scan["point_times_ns"] =
      timed ? py::object(array_of(std::move(frame.point_times_ns))) : py::none();
  const bool has_velocities = !frame.radial_velocity_m_s.empty();
  scan["radial_velocity_m_s"] =
      has_velocities ? py::object(array_of(std::move(frame.radial_velocity_m_s))) : py::none();
  scan["truth"] = frame.truth ? py::object(array_of(std::move(*frame.truth))) : py::none();
  return scan;
}

py::array_t<double> poses_of(const OpenSequence& opened) {
  const auto count = static_cast<py::ssize_t>(opened.sequence->size());
  py::array_t<double> poses({count, py::ssize_t{4}, py::ssize_t{4}});
  for (py::ssize_t k = 0; k < count; ++k) {
    const Pose& pose = opened.sequence->map_from_sensor(static_cast<std::size_t>(k));
    for (int row = 0; row < 4; ++row) {
      for (int column = 0; column < 4; ++column) {
        poses.mutable_at(k, row, column) = pose.matrix()(row, column);
      }
    }
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
  if (!stamps_ns) mark_as_lidars(file, rows);
  write_file_atomic(file, rows);
}

}  // namespace

void bind_datasets(py::module_& module) {
  module.def("open", open_shared);
  module.def("reading_names", reading_names);
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
      .def_property_readonly("poses", poses_of)
      .def("__len__", [](const OpenSequence& s) { return s.sequence->size(); })
      .def("read", read_scan);
}

}  // namespace mosbench::python
