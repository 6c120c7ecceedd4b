#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <limits>
#include <string_view>

#include "eval/python/bindings.hpp"

namespace mosbench::python {
namespace {

std::string shape_text(const py::array& array) {
  return fmt::format("({})", fmt::join(array.shape(), array.shape() + array.ndim(), ", "));
}

std::string type_text(const py::array& array) { return py::str(array.dtype()).cast<std::string>(); }

/// Returns the array with another type or order of its numbers where that is needed.
template <typename Plain>
Plain numbers_of(const py::array& array, std::string_view name) {
  if (std::string_view("fiu").find(array.dtype().kind()) == std::string_view::npos) {
    throw py::value_error(fmt::format("{}: has type {}, expected numbers", name, type_text(array)));
  }
  Plain plain = Plain::ensure(array);
  if (!plain) throw py::value_error(fmt::format("{}: cannot be read as numbers", name));
  return plain;
}

}  // namespace

ArrayPoints::ArrayPoints(const py::array& array) : array_(numbers_of<FloatArray>(array, "points")) {
  const bool is_table = array_.ndim() == 2 && (array_.shape(1) == 3 || array_.shape(1) == 4);
  if (!is_table) {
    throw py::value_error(
        fmt::format("points: has shape {}, expected (N, 3) or (N, 4)", shape_text(array_)));
  }
  values_ = array_.data();
  count_ = static_cast<std::size_t>(array_.shape(0));
  is_padded_ = array_.shape(1) == 4;
}

std::span<const Point> ArrayPoints::span(std::vector<Point>& padded) const {
  if (is_padded_) return {reinterpret_cast<const Point*>(values_), count_};
  padded.resize(count_);
  const float* value = values_;
  for (Point& point : padded) {
    point = {value[0], value[1], value[2], 0.0F};
    value += 3;
  }
  return padded;
}

Pose pose_of(const py::array& array) {
  const auto matrix = numbers_of<DoubleArray>(array, "pose");
  if (matrix.ndim() != 2 || matrix.shape(0) != 4 || matrix.shape(1) != 4) {
    throw py::value_error(fmt::format("pose: has shape {}, expected (4, 4)", shape_text(matrix)));
  }
  for (py::ssize_t i = 0; i < matrix.size(); ++i) {
    if (std::isfinite(matrix.data()[i])) continue;
    throw py::value_error(fmt::format("pose[{}, {}]: is {}, expected a finite number", i / 4, i % 4,
                                      matrix.data()[i]));
  }
  using Rows = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
  const Eigen::Map<const Rows> rows(matrix.data());
  if (rows.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
    throw py::value_error("pose: has another last row, expected 0 0 0 1");
  }
  Pose pose;
  pose.matrix().topRows<3>() = rows.topRows<3>();
  pose.makeAffine();
  return pose;
}

py::array_t<float> array_of(std::vector<Point>&& points) {
  const auto [owner, kept] = owned(std::move(points));
  const std::vector<py::ssize_t> shape = {static_cast<py::ssize_t>(kept->size()), 4};
  return py::array_t<float>(shape, reinterpret_cast<const float*>(kept->data()), owner);
}

std::vector<std::uint32_t> labels_of(const py::array& labels, const std::string& name) {
  const char kind = labels.dtype().kind();
  if (labels.ndim() != 1 || (kind != 'u' && kind != 'i' && kind != 'b')) {
    throw py::value_error(
        fmt::format("{}: has shape {} and type {}, expected (N) of integers or bool", name,
                    shape_text(labels), type_text(labels)));
  }
  const py::array_t<std::int64_t, py::array::c_style | py::array::forcecast> wide(labels);
  std::vector<std::uint32_t> ids;
  ids.reserve(static_cast<std::size_t>(wide.size()));
  for (py::ssize_t i = 0; i < wide.size(); ++i) {
    const std::int64_t id = wide.at(i);
    if (id < 0 || id > std::numeric_limits<std::uint32_t>::max()) {
      throw py::value_error(fmt::format("{}[{}]: is {}, expected a uint32", name, i, id));
    }
    ids.push_back(static_cast<std::uint32_t>(id));
  }
  return ids;
}

}  // namespace mosbench::python
