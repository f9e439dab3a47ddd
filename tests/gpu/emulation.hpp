#pragma once

#include <string_view>
#include <vector>

#include "fake_cuda.hpp"
#include "slalom/gpu/gpu.hpp"

namespace slalom::gpu {

/// Runs the kernels' source on the host, as cmake/gpu/kernels.cu does on the device.
template <class P>
void emulate(const char* kernel, int blocks, int shared_bytes, const void* argument) {
  const auto& a = *static_cast<const Arguments<P>*>(argument);
  std::vector<Four> shared(shared_bytes / 16 + 1);
  float* const memory = &shared[0].x;
  if (std::string_view(kernel) == "slalom_guides") {
    for (int guide = 0; guide < blocks; ++guide) MovingGuide<P>{a, guide, memory}.run();
    return finish_guides(a, memory);
  }
  for (int group = 0; group < a.settings.groups; ++group) SampleBlock<P>{a, memory}.solve(group);
  combine(a, memory);
  a.buffers.report->done = a.solve;
}

}  // namespace slalom::gpu
