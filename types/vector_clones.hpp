#pragma once

/// Before a function: one clone of it for AVX2 beside the plain one, chosen when the program is
/// loaded. Both give the same bits: integers do anyway, and floating point where expressions are
/// not fused (-ffp-contract=off; AVX2 alone has no fused multiply-add either). The sanitizers'
/// run-times are not up yet when such a choice is made, so they get the plain function.
#if defined(__x86_64__) && !defined(DEPTHSCOPE_SANITIZED)
#define DEPTHSCOPE_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define DEPTHSCOPE_CLONES
#endif
