#include <pybind11/stl.h>

#include <mutex>

#include "eval/cli/command_line.hpp"
#include "eval/python/bindings.hpp"
#include "eval/result/tell.hpp"

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
  return {printed.exit_code, printed.bytes};
}

}  // namespace

void bind_commands(py::module_& module) { module.def("command", command); }

}  // namespace mosbench::python
