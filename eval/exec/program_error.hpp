#pragma once

#include <string>

#include "datasets/text/errors.hpp"

namespace mosbench {

/// A program behind --method exec: does not do what it should. Whoever knows the scan names it.
class ProgramError : public DataError {
 public:
  ProgramError(const std::string& wrong, const std::string& expected)
      : DataError("exec", wrong, expected), wrong_(wrong), expected_(expected) {}

  const std::string& wrong() const { return wrong_; }
  const std::string& expected() const { return expected_; }

 private:
  std::string wrong_, expected_;
};

}  // namespace mosbench
