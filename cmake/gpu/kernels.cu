// The translation unit that NVRTC compiles: HEADER is the user's header, PROBLEM the user's struct.
#include HEADER
#include "slalom/gpu/kernels/guides.hpp"
#include "slalom/gpu/kernels/samples.hpp"

namespace {

using A = slalom::gpu::Arguments<PROBLEM>;

__device__ float* shared_memory() {
  extern __shared__ float4 memory[];
  return reinterpret_cast<float*>(memory);
}

/// Whether this is the last block to come here; it then sees what the others have written.
__device__ bool last_block(unsigned* ticket) {
  __shared__ bool last;
  __threadfence();
  __syncthreads();
  if (threadIdx.x == 0) {
    last = atomicAdd(ticket, 1u) == gridDim.x - 1;
    if (last) *ticket = 0;
  }
  __syncthreads();
  if (last) __threadfence();
  return last;
}

template <bool guided>
__device__ void samples(const A& a) {
  float* const memory = shared_memory();
  for (int group = int(blockIdx.x); group < a.settings.groups; group += int(gridDim.x)) {
    slalom::gpu::solve_group<PROBLEM, guided>(a, group, memory);
    __syncthreads();
  }
  if (!last_block(a.buffers.ticket)) return;
  slalom::gpu::combine<PROBLEM, guided>(a, memory);
  __threadfence_system();
  __syncthreads();
  if (threadIdx.x == 0) *static_cast<volatile unsigned*>(&a.buffers.report->done) = a.solve;
}

}  // namespace

// SLALOM_RESIDENT: blocks that a multiprocessor holds; 1 leaves twice as many registers to a thread.
#define KERNEL(blocks) extern "C" __global__ void __launch_bounds__(slalom::gpu::block_threads, blocks)
KERNEL(SLALOM_RESIDENT) slalom_mppi(const __grid_constant__ A a) { samples<false>(a); }
KERNEL(SLALOM_RESIDENT) slalom_svg_mppi(const __grid_constant__ A a) { samples<true>(a); }
KERNEL(1) slalom_guides(const __grid_constant__ A a) {
  slalom::gpu::MovingGuide<PROBLEM>(a, int(blockIdx.x), shared_memory()).run();
  if (last_block(a.buffers.ticket + 1)) slalom::gpu::finish_guides(a, shared_memory());
}
KERNEL(1) slalom_reset(const __grid_constant__ A a) { slalom::gpu::reset(a, shared_memory()); }
/// The layout that the host must have, too.
extern "C" __device__ const int slalom_layout[4] = {int(sizeof(PROBLEM)), int(alignof(PROBLEM)), int(sizeof(A)),
                                                   PROBLEM::inputs};
