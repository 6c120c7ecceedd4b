#pragma once

#include <mosbench/method.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

/// MethodKind::name of all of them.
inline constexpr std::string_view kExecKind = "exec";
/// The setting of mosbench itself among those of a program.
inline constexpr std::string_view kTimeout_s = "timeout_s";

/// Returns a method that hands every scan to a program of the user, which labels it. The program is
/// a shell command, started once per sequence; docs/formats/exec.md describes the messages over its
/// stdin and stdout. Its faults are a ProgramError of `push`: no answer within `timeout_s`, an
/// early end, a message of another kind or size, labels other than 9 and 251. It gets the values of
/// its `own` settings, which are beside `timeout_s`, numbers or texts. The same command with
/// settings of the same names and types always gives the same row. Throws UsageError for an empty
/// command.
const MethodKind& exec_method(const std::string& command, const std::vector<Setting>& own = {});

}  // namespace mosbench
