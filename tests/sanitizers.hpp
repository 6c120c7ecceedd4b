#pragma once

namespace mosbench {

/// Whether this is a build with a sanitizer, in which what takes seconds takes minutes.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace mosbench
