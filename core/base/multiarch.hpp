#pragma once

/// Put before a hot function to compile it twice, for x86-64-v3 (AVX2) and for any x86-64, and to
/// choose at load time. An arch named after a processor would be chosen on its maker's only.
/// Contraction is off, so both give the same bits. The resolvers run before a sanitizer's run-time
/// is up, so sanitized builds keep to one copy.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__) && !defined(__clang__)
#define MOSBENCH_MULTIARCH __attribute__((target_clones("arch=x86-64-v3", "default")))
/// The same and for x86-64-v4, whose 32 registers and masks pay where 16 registers do not hold a
/// loop.
#define MOSBENCH_MULTIARCH_V4 \
  __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define MOSBENCH_MULTIARCH
#define MOSBENCH_MULTIARCH_V4
#endif
