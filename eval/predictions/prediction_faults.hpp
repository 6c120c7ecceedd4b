#pragma once

#include <string>
#include <vector>

#include "datasets/files/errors.hpp"

namespace mosbench {

/// Meets a prediction that cannot be used: an error at once or, where the user allows missing
/// predictions, a remark.
class PredictionFaults {
 public:
  explicit PredictionFaults(bool allowed) : allowed_(allowed) {}

  /// Throws `fault` unless it is allowed.
  void report(const DataError& fault) {
    if (!allowed_) throw fault;
    texts_.push_back(std::string("passed over: ") + fault.what());
  }
  const std::vector<std::string>& texts() const { return texts_; }

 private:
  bool allowed_;
  std::vector<std::string> texts_;
};

}  // namespace mosbench
