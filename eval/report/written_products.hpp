#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace mosbench {

/// The files that `mosbench run --write` can write beside the labels.
std::vector<std::string> product_names();

/// Writes products of a finished sequence of `mosbench run` into its folder, in the formats of
/// docs/formats/files.md. Each file appears whole; those that are there as they were written are
/// kept. Throws DataError, and UsageError for one that was changed since.
void write_products(const std::filesystem::path& folder, std::span<const std::string> names);

}  // namespace mosbench
