#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstdint>
#include <mosbench/scan.hpp>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace mosbench::python {

namespace py = pybind11;

/// Adds methods, odometry and their settings.
void bind_methods(py::module_& module);
/// Adds readers of data sets.
void bind_datasets(py::module_& module);
/// Adds protocols and results.
void bind_scores(py::module_& module);

/// Arrays in C order, and aligned as C++ reads them.
inline constexpr int kPlain =
    py::array::c_style | py::array::forcecast | py::detail::npy_api::NPY_ARRAY_ALIGNED_;
using FloatArray = py::array_t<float, kPlain>;
using DoubleArray = py::array_t<double, kPlain>;

/// Points of an array (N, 3) or (N, 4), which it keeps.
class ArrayPoints {
 public:
  /// Throws py::value_error for other shapes, and for what are no numbers.
  explicit ArrayPoints(const py::array& array);
  /// Returns the points where they are, those of (N, 3) copied to `padded`. Needs no GIL.
  std::span<const Point> span(std::vector<Point>& padded) const;

 private:
  FloatArray array_;
  const float* values_;
  std::size_t count_;
  bool is_padded_;
};

/// Returns the pose of an array (4, 4) with the last row 0 0 0 1. Throws py::value_error.
Pose pose_of(const py::array& matrix);
/// Returns an array of the same numbers, its rows one after the other.
template <int kRows, int kColumns>
py::array_t<double> matrix_of(const Eigen::Matrix<double, kRows, kColumns>& numbers) {
  const Eigen::Matrix<double, kRows, kColumns, Eigen::RowMajor> rows = numbers;
  return py::array_t<double>({kRows, kColumns}, rows.data());
}
/// Returns an array (N, 4) that owns the points.
py::array_t<float> array_of(std::vector<Point>&& points);
/// Returns the labels of an array (N) of integers. Throws py::value_error for other shapes and for
/// ids that are no uint32.
std::vector<std::uint32_t> labels_of(const py::array& labels, const std::string& name);

/// What keeps a vector alive for an array, and the vector.
template <typename Value>
std::pair<py::capsule, const std::vector<Value>*> owned(std::vector<Value>&& values) {
  auto* kept = new std::vector<Value>(std::move(values));
  return {py::capsule(kept, [](void* memory) { delete static_cast<std::vector<Value>*>(memory); }),
          kept};
}

/// Returns an array (N) that owns the vector.
template <typename Value>
py::array_t<Value> array_of(std::vector<Value>&& values) {
  const auto [owner, kept] = owned(std::move(values));
  return py::array_t<Value>(static_cast<py::ssize_t>(kept->size()), kept->data(), owner);
}

/// Returns the same, or None of an empty vector.
template <typename Value>
py::object array_or_none(std::vector<Value>&& values) {
  return values.empty() ? py::object(py::none()) : array_of(std::move(values));
}

/// Returns the names of the rows of a table.
template <typename Rows>
std::vector<std::string> names_of(const Rows& rows) {
  std::vector<std::string> names;
  for (const auto& row : rows) names.emplace_back(row.name);
  return names;
}

}  // namespace mosbench::python
