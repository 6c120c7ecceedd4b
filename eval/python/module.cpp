#include <pybind11/stl.h>

#include <mutex>
#include <stdexcept>
#include <system_error>

#include "datasets/text/errors.hpp"
#include "eval/cli/command_line.hpp"
#include "eval/python/bindings.hpp"
#include "eval/result/tell.hpp"
#include "eval/result/version.hpp"

namespace mosbench::python {
namespace {

/// Lets Python handle its signals, so that Ctrl-C ends the command with KeyboardInterrupt.
void handle_signals() {
  const py::gil_scoped_acquire acquired;
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

/// Returns exit code and answer of `mosbench ARGUMENTS...`.
std::pair<int, std::string> command(const std::vector<std::string>& arguments, bool quiet) {
  static std::mutex one_at_a_time;
  const py::gil_scoped_release released;
  const std::lock_guard lock(one_at_a_time);
  const CallerScope scope({.quiet = quiet, .at_each_scan = handle_signals});
  const Printed printed = answer_to(arguments, 0);
  if (!printed.failure.empty()) {
    if (printed.exit_code == kUsage) throw UsageError(printed.failure);
    throw DataError(printed.failure);
  }
  return {printed.exit_code, printed.bytes};
}

/// Errors of files become OSError, wrong values and calls ValueError, as their messages are.
void translate(std::exception_ptr pointer) {
  try {
    if (pointer) std::rethrow_exception(pointer);
  } catch (const DataError& error) {
    PyErr_SetString(PyExc_OSError, error.what());
  } catch (const std::system_error& error) {  // also of std::filesystem
    PyErr_SetString(PyExc_OSError, error.what());
  } catch (const UsageError& error) {
    PyErr_SetString(PyExc_ValueError, error.what());
  } catch (const std::logic_error& error) {
    PyErr_SetString(PyExc_ValueError, error.what());
  }
}

}  // namespace
}  // namespace mosbench::python

PYBIND11_MODULE(_mosbench, module) {
  using namespace mosbench::python;
  module.doc() = "What the package mosbench takes from the C++ library; import mosbench instead.";
  module.attr("__version__") = std::string(mosbench::kMosbenchVersion);
  pybind11::register_exception_translator(translate);
  bind_methods(module);
  bind_datasets(module);
  bind_scores(module);
  module.def("command", command);
}
