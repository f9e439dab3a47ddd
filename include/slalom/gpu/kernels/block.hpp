#pragma once

/// The kernels are written once: NVRTC compiles them for the GPU, and any compiler for the host, where a
/// block is one thread, so that they are tested without a GPU.

#include <cmath>
#include <cstring>
#include <limits>

#if defined(__CUDACC_RTC__)
#define SLALOM_PRAGMA(text) _Pragma(#text)
#define SLALOM_UNROLLED(steps) SLALOM_PRAGMA(unroll steps)
#else
#define SLALOM_UNROLLED(steps)
#endif

namespace slalom::gpu {

constexpr int block_threads = 256;            ///< threads of a block of any kernel on the GPU
constexpr int most_shared_bytes = 64 * 1024;  ///< shared memory of a block; every GPU from Turing on has it
constexpr float infinite = std::numeric_limits<float>::infinity();

/// Four values that are read at once.
struct alignas(16) Four {
  float x, y, z, w;
};

/// The threads of a block, and instructions that differ between GPU and host.
#if defined(__CUDACC_RTC__)
struct Threads {
  static constexpr int lanes = 32;  ///< threads of a warp
  static int thread() { return int(threadIdx.x); }
  static int threads() { return int(blockDim.x); }
  static void barrier() { __syncthreads(); }
  template <class T>
  static T shuffle(T x, int distance) {
    return __shfl_xor_sync(0xffffffffu, x, distance);
  }
  /// Reads past the first-level cache, which may hold what was there before other blocks wrote.
  static Four read_written(const float* from) {
    const float4 v = __ldcg(reinterpret_cast<const float4*>(from));
    return {v.x, v.y, v.z, v.w};
  }
  static unsigned reverse_bytes(unsigned x) { return __byte_perm(x, 0, 0x0123); }
  static float reciprocal_sqrt(float x) { return rsqrtf(x); }
};
#else
struct Threads {
  static constexpr int lanes = 1;
  static int thread() { return 0; }
  static int threads() { return 1; }
  static void barrier() {}
  template <class T>
  static T shuffle(T x, int /*distance*/) {
    return x;
  }
  static Four read_written(const float* from) { return {from[0], from[1], from[2], from[3]}; }
  static unsigned reverse_bytes(unsigned x) { return __builtin_bswap32(x); }
  static float reciprocal_sqrt(float x) { return 1 / std::sqrt(x); }
};
#endif

/// A block of threads, which run a kernel together.
struct Block : Threads {
  static int lane() { return thread() % lanes; }
  static int warp() { return thread() / lanes; }
  static int warps() { return threads() / lanes; }

  /// Spreads the calls body(0) ... body(n - 1) over the threads.
  template <class Body>
  static void each(int n, Body&& body) {
    for (int i = thread(); i < n; i += threads()) body(i);
  }
  /// Combines value(0) ... value(n - 1), float or double. Every warp has the result.
  template <class Value, class Operation>
  static auto reduce(int n, float neutral, Value&& value, Operation&& combined) {
    decltype(value(0)) x = neutral;
    for (int i = lane(); i < n; i += lanes) x = combined(x, value(i));
    for (int h = lanes / 2; h > 0; h /= 2) x = combined(x, shuffle(x, h));
    return x;
  }
  template <class Value>
  static auto least(int n, Value&& value) {
    return reduce(n, infinite, value, [](auto a, auto b) { return b < a ? b : a; });
  }
  template <class Value>
  static auto sum(int n, Value&& value) {
    return reduce(n, 0, value, [](auto a, auto b) { return a + b; });
  }
};

template <class T>
T clamped(T x, T low, T high) {
  return x < low ? low : x > high ? high : x;
}
inline bool is_finite(float x) {
  return x - x == 0.0f;
}
/// ceil(log2(n))
constexpr int log2_of(int n) {
  int l = 0;
  while ((1 << l) < n) ++l;
  return l;
}
/// Rows, rounded up to whole `Four`.
constexpr int padded_rows(int rows) {
  return (rows + 3) / 4 * 4;
}

}  // namespace slalom::gpu
