#pragma once

#include <mosbench/method.hpp>
#include <string>
#include <string_view>

namespace mosbench {

/// MethodKind::name of all of them.
inline constexpr std::string_view kExecKind = "exec";

/// Returns a method that hands every scan to a program of the user, which labels it. The program is
/// a shell command, started once per sequence; docs/formats/exec.md describes the messages over its
/// stdin and stdout. Its faults are a ProgramError of `push`: no answer within `timeout_s`, an
/// early end, a message of another kind or size, labels other than 9 and 251. The same command
/// always gives the same row. Throws UsageError for an empty one.
const MethodKind& exec_method(const std::string& command);

}  // namespace mosbench
