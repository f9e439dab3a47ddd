#pragma once

/// The kernels are written once: NVRTC compiles them for the GPU, and any compiler for the host, where a
/// block runs as loops, so that they are tested without a GPU. A block works in phases: `SLALOM_EACH(i, n)`
/// spreads a loop over the threads of the block, `SLALOM_BARRIER()` ends a phase.

#if defined(__CUDACC_RTC__)
#define SLALOM_ON_GPU 1
#define SLALOM_EACH(i, n) for (int i = int(threadIdx.x); i < (n); i += int(blockDim.x))
#define SLALOM_EACH_WARP(i, n) for (int i = int(threadIdx.x) / 32; i < (n); i += int(blockDim.x) / 32)
#define SLALOM_EACH_LANE(i, n) for (int i = int(threadIdx.x) % 32; i < (n); i += 32)
#define SLALOM_ONE_WARP() if (threadIdx.x < 32)
#define SLALOM_ONE_LANE() if (threadIdx.x % 32 == 0)
#define SLALOM_ONE_THREAD() if (threadIdx.x == 0)
#define SLALOM_BARRIER() __syncthreads()
#define SLALOM_UNROLL_ALL _Pragma("unroll")
#else
#define SLALOM_ON_GPU 0
#define SLALOM_EACH(i, n) for (int i = 0; i < (n); ++i)
#define SLALOM_EACH_WARP(i, n) for (int i = 0; i < (n); ++i)
#define SLALOM_EACH_LANE(i, n) for (int i = 0; i < (n); ++i)
#define SLALOM_ONE_WARP()
#define SLALOM_ONE_LANE()
#define SLALOM_ONE_THREAD()
#define SLALOM_BARRIER()
#define SLALOM_UNROLL_ALL
#endif

#include <cmath>
#include <cstring>
#include <limits>

namespace slalom::gpu {

constexpr float infinite = std::numeric_limits<float>::infinity();

inline float clamped(float x, float low, float high) {
  return x < low ? low : x > high ? high : x;
}
inline double clamped(double x, double low, double high) {
  return x < low ? low : x > high ? high : x;
}
inline bool is_finite(float x) {
  return x - x == 0.0f;
}

/// Operations of `reduce`.
struct Least {
  static constexpr float neutral = infinite;
  template <class T>
  static T of(T a, T b) {
    return b < a ? b : a;
  }
};
struct Sum {
  static constexpr float neutral = 0;
  template <class T>
  static T of(T a, T b) {
    return a + b;
  }
};

/// Reduces value(0) ... value(n - 1), float or double, in the same order on the GPU and on the host. Every
/// warp has the result.
template <class Operation, class Value>
auto reduce(int n, Value&& value) {
  using T = decltype(value(0));
#if SLALOM_ON_GPU
  T x = Operation::neutral;
  for (int i = int(threadIdx.x) & 31; i < n; i += 32) x = Operation::of(x, value(i));
  for (int h = 16; h > 0; h /= 2) x = Operation::of(x, __shfl_xor_sync(0xffffffffu, x, h));
  return x;
#else
  T lane[32];
  for (int l = 0; l < 32; ++l) {
    lane[l] = Operation::neutral;
    for (int i = l; i < n; i += 32) lane[l] = Operation::of(lane[l], value(i));
  }
  for (int h = 16; h > 0; h /= 2)
    for (int l = 0; l < h; ++l) lane[l] = Operation::of(lane[l], lane[l + h]);
  return lane[0];
#endif
}

/// ceil(log2(n))
constexpr int log2_of(int n) {
  int l = 0;
  while ((1 << l) < n) ++l;
  return l;
}
/// Rows, rounded up to whole float4.
constexpr int padded_rows(int rows) {
  return (rows + 3) / 4 * 4;
}

}  // namespace slalom::gpu
