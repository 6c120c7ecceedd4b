#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "datasets/hdf5/hdf5_module.hpp"

namespace mosbench {

/// An array to be written by `write_hdf5`.
template <typename Value>
std::pair<Hdf5Array, std::string> hdf5_array(std::string name, Hdf5Number::Kind kind,
                                             std::vector<std::uint64_t> shape,
                                             const std::vector<Value>& values) {
  Hdf5Array array;
  array.name = std::move(name);
  array.number = {kind, sizeof(Value)};
  array.shape = std::move(shape);
  return {array, {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value)}};
}

struct Hdf5GroupBytes {
  std::string name;
  std::vector<std::pair<Hdf5Array, std::string>> arrays;
};

/// Writes any groups and arrays by libhdf5; throws std::runtime_error.
inline void write_hdf5(const std::filesystem::path& file,
                       const std::vector<Hdf5GroupBytes>& groups) {
  const auto check = [](const std::string& error) {
    if (!error.empty()) throw std::runtime_error(error);
  };
  std::unique_ptr<Hdf5Output> output;
  check(hdf5_functions(file).create(file, output));
  for (const Hdf5GroupBytes& group : groups) {
    for (const auto& [array, bytes] : group.arrays) check(output->add(group.name, array, bytes));
  }
  check(output->close());
}

}  // namespace mosbench
