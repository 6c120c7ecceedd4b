#pragma once

#include <string>
#include <vector>

#include "datasets/text/errors.hpp"

namespace mosbench {

/// Collects errors of predictions: throws the first one or, where the user allows missing
/// predictions, keeps each as a remark.
class PredictionErrors {
 public:
  explicit PredictionErrors(bool allowed) : allowed_(allowed) {}

  /// Throws `error` unless it is allowed.
  void report(const DataError& error) {
    if (!allowed_) throw error;
    texts_.push_back(std::string("passed over: ") + error.what());
  }
  const std::vector<std::string>& texts() const { return texts_; }

 private:
  bool allowed_;
  std::vector<std::string> texts_;
};

}  // namespace mosbench
