"""Compiles the module of the Python package by CMake. See pyproject.toml.

Without ROS, which a wheel cannot bring along, and with .h5 files where libhdf5-dev is installed.
CMAKE_ARGS, as in -DMOSBENCH_WITH_ROSBAG=ON, are passed on.
"""

import os
import pathlib
import re
import shlex
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = pathlib.Path(__file__).resolve().parent


def has_hdf5():
    """As CMakeLists.txt looks for it."""
    names = ("hdf5-serial", "hdf5")
    return any(subprocess.run(["pkg-config", "--exists", name], check=False).returncode == 0 for name in names)


class BuildByCMake(build_ext):
    def build_extension(self, extension):
        target = pathlib.Path(self.get_ext_fullpath(extension.name)).resolve()
        build = pathlib.Path(self.build_temp).resolve()
        options = {
            "CMAKE_BUILD_TYPE": "Release",
            "MOSBENCH_WITH_PYTHON": "ON",
            "MOSBENCH_WITH_PCL": "OFF",
            "MOSBENCH_WITH_ROSBAG": "OFF",
            "MOSBENCH_WITH_HDF5": "ON" if has_hdf5() else "OFF",
            "MOSBENCH_BUILD_TESTS": "OFF",
            "MOSBENCH_BUILD_BENCH": "OFF",
            "Python3_EXECUTABLE": sys.executable,
        }
        definitions = [f"-D{name}={value}" for name, value in options.items()]
        definitions += shlex.split(os.environ.get("CMAKE_ARGS", ""))
        subprocess.run(["cmake", "-S", ROOT, "-B", build, *definitions], check=True)
        parallel = str(os.cpu_count() or 1)
        subprocess.run(["cmake", "--build", build, "--target", "mosbench_python", "-j", parallel], check=True)
        target.parent.mkdir(parents=True, exist_ok=True)
        self.copy_file(build / "python" / "mosbench" / target.name, target)
        for module in (build / "datasets/modules").glob("*.so"):
            self.copy_file(module, target.parent / module.name)


version = re.search(r"project\(mosbench VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text())
setup(
    version=version[1],
    ext_modules=[Extension("mosbench._mosbench", sources=[])],
    cmdclass={"build_ext": BuildByCMake},
)
