// A driver without a device behind it: memory is the host's, and `fake_launch` runs the kernels.

#include "fake_cuda.hpp"

#include <cstdlib>
#include <cstring>

int fake_query = 0, fake_allocation = 0, fake_images = 0;
void (*fake_launch)(const char*, int, int, const void*) = nullptr;

// clang-format off
extern "C" {
using Size = std::size_t;
int cuInit(unsigned) { return 0; }
int cuGetErrorString(int, const char** text) { return *text = "fake failure", 0; }
int cuDeviceGetAttribute(int* value, int, int) { return *value = 9, 0; }
int cuDevicePrimaryCtxRetain(void** context, int) { return *context = &fake_query, 0; }
int cuDevicePrimaryCtxRelease_v2(int) { return 0; }
int cuCtxSetCurrent(void*) { return 0; }
int cuModuleLoadData(void**, const void*) { return fake_images-- > 0 ? 209 : 0; }
int cuModuleUnload(void*) { return 0; }
int cuModuleGetFunction(void** function, void*, const char* name) { return *function = const_cast<char*>(name), 0; }
int cuFuncSetAttribute(void*, int, int) { return 0; }
int cuOccupancyMaxActiveBlocksPerMultiprocessor(int* blocks, void*, int, Size) { return *blocks = 1, 0; }
int cuStreamCreate(void**, unsigned) { return 0; }
int cuStreamDestroy_v2(void*) { return 0; }
int cuStreamQuery(void*) { return fake_query; }
int cuMemAlloc_v2(void** address, Size bytes) {
  if (fake_allocation == 0) *address = std::malloc(bytes);
  return fake_allocation;
}
int cuMemFree_v2(void* address) { return std::free(address), 0; }
int cuMemsetD8Async(void* address, unsigned char value, Size bytes, void*) { return std::memset(address, value, bytes), 0; }
int cuMemHostAlloc(void** address, Size bytes, unsigned) { return *address = std::malloc(bytes), 0; }
int cuMemFreeHost(void* address) { return std::free(address), 0; }
int cuMemcpyHtoDAsync_v2(void* to, const void* from, Size bytes, void*) { return std::memcpy(to, from, bytes), 0; }
int cuMemcpyDtoH_v2(void* to, const void* from, Size bytes) { return std::memcpy(to, from, bytes), 0; }
int cuLaunchKernel(void* function, unsigned blocks, unsigned, unsigned, unsigned, unsigned, unsigned, unsigned shared_bytes,
                   void*, void** arguments, void**) {
  if (fake_query == 0) fake_launch(static_cast<const char*>(function), int(blocks), int(shared_bytes), arguments[0]);
  return 0;
}
}
