#include "eval/cli/failure.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <new>
#include <system_error>

#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

enum ExitCode { kUsage = 2, kUnusable = 3, kInternal = 70 };

}  // namespace

Failure current_failure() {
  try {
    throw;
  } catch (const UsageError& error) {
    return {kUsage, error.what()};
  } catch (const DataError& error) {
    return {kUnusable, error.what()};
  } catch (const std::filesystem::filesystem_error& error) {
    return {kUnusable, error.what()};
  } catch (const std::system_error& error) {
    if (error.code() != std::errc::resource_unavailable_try_again) {
      return {kInternal, fmt::format("internal fault: {}", error.what())};
    }
    return {kUnusable, "the machine gives no more threads, expected fewer in --threads"};
  } catch (const std::bad_alloc&) {
    return {kUnusable, "the machine gives no more memory, expected smaller input"};
  } catch (const std::exception& error) {
    return {kInternal, fmt::format("internal fault: {}", error.what())};
  }
}

}  // namespace mosbench
