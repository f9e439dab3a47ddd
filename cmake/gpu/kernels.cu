// The translation unit that NVRTC compiles: HEADER is the user's header, PROBLEM the user's struct.
#include HEADER
#include "slalom/gpu/kernels/guides.hpp"
#include "slalom/gpu/kernels/samples.hpp"

namespace slalom::gpu {

using A = Arguments<PROBLEM>;

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

// SLALOM_RESIDENT: blocks that a multiprocessor holds; 1 leaves twice as many registers to a thread.
extern "C" __global__ void __launch_bounds__(block_threads, SLALOM_RESIDENT)
    slalom_samples(const __grid_constant__ A a) {
  const SampleBlock<PROBLEM> block{a, shared_memory()};
  for (int group = int(blockIdx.x); group < a.settings.groups; group += int(gridDim.x)) block.solve(group);
  if (!last_block(a.buffers.ticket)) return;
  combine(a, shared_memory());
  __threadfence_system();
  __syncthreads();
  if (threadIdx.x == 0) *static_cast<volatile unsigned*>(&a.buffers.report->done) = a.solve;
}
extern "C" __global__ void __launch_bounds__(block_threads, 1) slalom_guides(const __grid_constant__ A a) {
  MovingGuide<PROBLEM>{a, int(blockIdx.x), shared_memory()}.run();
  if (last_block(a.buffers.ticket + 1)) finish_guides(a, shared_memory());
}

}  // namespace slalom::gpu
