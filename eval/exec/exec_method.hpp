#pragma once

#include <mosbench/method.hpp>
#include <string>
#include <string_view>

namespace mosbench {

/// MethodKind::name of all of them.
inline constexpr std::string_view kExecKind = "exec";

/// Returns a method that hands every scan to a program of the user, which labels it: a shell
/// command, started once per sequence, with messages over its stdin and stdout as
/// docs/formats/exec.md describes them. Whatever the program does wrong is a ProgramError of
/// `push`: no answer within `timeout_s`, an early end, a message of another kind or size, other
/// labels than 9 and 251. Always the same row for the same command. Throws UsageError for an empty
/// one.
const MethodKind& exec_method(const std::string& command);

}  // namespace mosbench
