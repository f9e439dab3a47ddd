#pragma once

#include <cstddef>
#include <type_traits>

/// Functions of the core that a GPU computes in its own way, for `float`: the packs' arithmetic, one lane
/// each. For a compiler of the processor they are declarations that nothing uses.
namespace slalom::detail::gpu {

#if defined(__CUDACC_RTC__)

/// Whether functions of `T` are those below.
template <class T>
inline constexpr bool computes = std::is_same_v<T, float>;

/// Sine and cosine of an angle, rad, as in core/pack/math.hpp.
inline void sin_cos(float x, float& s, float& c) {
  const float sum = fmaf(x, 0.318309886f, 12582912.0f), n = sum - 12582912.0f;
  const float r = fmaf(n, 8.74227766e-8f, fmaf(n, -3.14159274f, x)), x2 = r * r;
  s = r + r * x2 * (-0.166666643f + x2 * (8.33317683e-3f + x2 * (-1.98170522e-4f + x2 * 2.62108806e-6f)));
  c = (1.0f - 0.5f * x2) +
      x2 * x2 * (4.16666647e-2f + x2 * (-1.38887578e-3f + x2 * (2.4781316e-5f + x2 * -2.64315039e-7f)));
  const int sign = __float_as_int(sum) << 31;
  s = __int_as_float(__float_as_int(s) ^ sign);
  c = __int_as_float(__float_as_int(c) ^ sign);
}

inline float sin(float x) {
  float s, c;
  return sin_cos(x, s, c), s;
}
inline float cos(float x) {
  float s, c;
  return sin_cos(x, s, c), c;
}

/// The storage index of a position in cells, in the ring of the map for positions outside.
inline std::ptrdiff_t cell_index(float row, float column, int last_row, int last_column, int stride_log2) {
  const unsigned r = static_cast<unsigned>(static_cast<int>(row)),
                 c = static_cast<unsigned>(static_cast<int>(column));
  return (::min(r, static_cast<unsigned>(last_row)) << stride_log2) +
         ::min(c, static_cast<unsigned>(last_column));
}

inline float tanh(float x) {
  return 1.0f - __fdividef(2.0f, __expf(x + x) + 1.0f);
}

/// Adds to sums of 8 neurons the products of `inputs` values with their weights [input][neuron].
template <int Samples, class Value>
inline void weigh(const float* weight, int inputs, float (&sum)[Samples][8], Value&& value) {
  const float4* from = reinterpret_cast<const float4*>(weight);
#pragma unroll 4
  for (int i = 0; i < inputs; ++i) {
    const float4 a = __ldg(from + 2 * i), b = __ldg(from + 2 * i + 1);
    float x[Samples];
    value(i, x);
#pragma unroll
    for (int s = 0; s < Samples; ++s) {
      sum[s][0] += a.x * x[s], sum[s][1] += a.y * x[s], sum[s][2] += a.z * x[s], sum[s][3] += a.w * x[s];
      sum[s][4] += b.x * x[s], sum[s][5] += b.y * x[s], sum[s][6] += b.z * x[s], sum[s][7] += b.w * x[s];
    }
  }
}

/// Dense layers of at most 32 values, `weight` as in MlpNetwork, for the 32 samples of a warp: a lane brings
/// the inputs of its sample, computes 8 neurons of 4 samples, and has the outputs of its sample. Returns
/// false, and has done nothing, where the network is larger or not the whole warp is here.
template <int Inputs, int Outputs, class Activate>
inline bool dense_layers(const float* weight, int layers, const int* sizes, const float (&inputs)[Inputs],
                         float (&outputs)[Outputs], Activate&& activate) {
  if (__activemask() != 0xffffffffu) return false;
  for (int layer = 0; layer <= layers; ++layer)
    if (sizes[layer] > 32) return false;
  __shared__ float4 values[256 / 32][32][8];  // [warp][value][four samples]
  float4(&of_four)[32][8] = values[threadIdx.x / 32];
  float(*const of_one)[32] = reinterpret_cast<float(*)[32]>(&of_four[0][0]);
  const int lane = int(threadIdx.x) & 31, four = lane & 7, part = lane >> 3;
#pragma unroll
  for (int i = 0; i < Inputs; ++i) of_one[i][lane] = inputs[i];
  for (int layer = 0; layer < layers; ++layer) {
    const int entering = sizes[layer], blocks = (sizes[layer + 1] + 7) / 8;
    const bool last = layer + 1 == layers;
    __syncwarp();
    if (blocks == 1) {  // each lane computes its own sample
      float sum[1][8];
#pragma unroll
      for (int k = 0; k < 8; ++k) sum[0][k] = weight[k];
      weigh(weight + 8, entering, sum, [&](int i, float(&x)[1]) { x[0] = of_one[i][lane]; });
      if (!last) activate(sum[0]);
      __syncwarp();
#pragma unroll
      for (int k = 0; k < 8; ++k) of_one[k][lane] = sum[0][k];
    } else {
      const float* const own = weight + (part < blocks ? part : 0) * 8 * (entering + 1);
      float sum[4][8];
#pragma unroll
      for (int k = 0; k < 8; ++k) sum[0][k] = sum[1][k] = sum[2][k] = sum[3][k] = own[k];
      weigh(own + 8, entering, sum, [&](int i, float(&x)[4]) {
        const float4 v = of_four[i][four];
        x[0] = v.x, x[1] = v.y, x[2] = v.z, x[3] = v.w;
      });
#pragma unroll
      for (int s = 0; s < 4; ++s)
        if (!last) activate(sum[s]);
      __syncwarp();
#pragma unroll
      for (int k = 0; k < 8; ++k)
        if (part < blocks) of_four[part * 8 + k][four] = {sum[0][k], sum[1][k], sum[2][k], sum[3][k]};
    }
    weight += blocks * 8 * (entering + 1);
  }
  __syncwarp();
#pragma unroll
  for (int i = 0; i < Outputs; ++i) outputs[i] = of_one[i][lane];
  __syncwarp();
  return true;
}

#else

template <class T>
inline constexpr bool computes = false;
void sin_cos(float x, float& s, float& c);
float sin(float x);
float cos(float x);
std::ptrdiff_t cell_index(float row, float column, int last_row, int last_column, int stride_log2);
float tanh(float x);
template <int Inputs, int Outputs, class Activate>
bool dense_layers(const float* weight, int layers, const int* sizes, const float (&inputs)[Inputs],
                  float (&outputs)[Outputs], Activate&& activate);

#endif

}  // namespace slalom::detail::gpu
