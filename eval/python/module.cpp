#include <stdexcept>
#include <system_error>

#include "datasets/text/errors.hpp"
#include "eval/python/bindings.hpp"
#include "eval/result/version.hpp"

namespace {

/// Errors of files become OSError, wrong values and calls ValueError, as their messages are.
void translate(std::exception_ptr pointer) {
  try {
    if (pointer) std::rethrow_exception(pointer);
  } catch (const mosbench::DataError& error) {
    PyErr_SetString(PyExc_OSError, error.what());
  } catch (const std::system_error& error) {  // also of std::filesystem
    PyErr_SetString(PyExc_OSError, error.what());
  } catch (const mosbench::UsageError& error) {
    PyErr_SetString(PyExc_ValueError, error.what());
  } catch (const std::logic_error& error) {
    PyErr_SetString(PyExc_ValueError, error.what());
  }
}

}  // namespace

PYBIND11_MODULE(_mosbench, module) {
  using namespace mosbench::python;
  module.doc() = "What the package mosbench takes from the C++ library; import mosbench instead.";
  module.attr("__version__") = std::string(mosbench::kMosbenchVersion);
  pybind11::register_exception_translator(translate);
  bind_methods(module);
  bind_datasets(module);
  bind_scores(module);
  bind_commands(module);
}
