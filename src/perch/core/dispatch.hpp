#pragma once

/// Marks a function to be compiled once for each of several x86-64 levels; the loader picks the best that the
/// processor has. Results are the same on all: no fused multiply-add (-ffp-contract=off), and the same
/// operations in the same order. Sanitizers run before the loader can pick, so they get one version.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__) && !defined(PERCH_SCALAR)
#define PERCH_DISPATCH __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
#define PERCH_DISPATCH
#endif
