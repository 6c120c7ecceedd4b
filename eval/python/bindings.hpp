#pragma once

#include <pybind11/pybind11.h>

namespace mosbench::python {

namespace py = pybind11;

/// Adds methods, odometry and their settings.
void bind_methods(py::module_& module);
/// Adds readers of data sets.
void bind_datasets(py::module_& module);
/// Adds protocols and results.
void bind_scores(py::module_& module);

}  // namespace mosbench::python
