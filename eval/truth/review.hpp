#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace mosbench {

/// Serves the page of `mosbench truth review` on 127.0.0.1 to those who know its address with the
/// token, until the process ends. Each decision is on the disk before it is answered. `ready` takes
/// the address. Throws as `open_truth` and ResultScans, DataError also if no port is free.
void serve_review(const std::filesystem::path& folder,
                  const std::optional<std::filesystem::path>& data,
                  const std::function<void(const std::string& address)>& ready);

}  // namespace mosbench
