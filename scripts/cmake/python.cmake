# Finds what the Python package needs, and sets MOSBENCH_PYTHON_FOUND.
# Debian's numpy belongs to Debian's Python, whichever comes first in PATH.
if(EXISTS /usr/bin/python3)
  set(Python3_EXECUTABLE /usr/bin/python3 CACHE FILEPATH "Python of the package")
endif()
# Python first, or pybind11 searches for one in its own, older way.
find_package(Python3 QUIET COMPONENTS Interpreter Development.Module)
find_package(pybind11 2.10 QUIET)
if(pybind11_FOUND AND Python3_FOUND)
  set(MOSBENCH_PYTHON_FOUND ON)
else()
  message(STATUS "Left out: the Python package, because pybind11-dev or python3-dev is not installed")
endif()
