#include "eval/result/caller.hpp"

#include <utility>

namespace mosbench {
namespace {

Caller& current_caller() {
  static Caller current;
  return current;
}

}  // namespace

const Caller& caller() { return current_caller(); }

CallerScope::CallerScope(Caller caller) { current_caller() = std::move(caller); }
CallerScope::~CallerScope() { current_caller() = {}; }

}  // namespace mosbench
