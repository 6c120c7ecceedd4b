#pragma once

/// Put before a hot function to compile it twice, for AVX2 machines and for any x86-64, and to
/// choose at load time. Contraction is off, so both give the same bits. The resolvers run before a
/// sanitizer's run-time is up, so sanitized builds keep to one copy.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__) && !defined(__clang__)
#define MOSBENCH_MULTIARCH __attribute__((target_clones("arch=haswell", "default")))
#else
#define MOSBENCH_MULTIARCH
#endif
