#include "slalom/gpu/session.hpp"

#include <dlfcn.h>

#include <chrono>

#include "slalom/gpu/kernels/block.hpp"

namespace slalom::gpu {

namespace {

// The functions of libcuda that are used: name here, name there, parameters. Handles and addresses are
// pointers, results 0 where all is well.
// clang-format off
#define SLALOM_DRIVER(X) \
  X(init, "cuInit", unsigned) \
  X(error_text, "cuGetErrorString", int, const char**) \
  X(device_attribute, "cuDeviceGetAttribute", int*, int, int) \
  X(context_retain, "cuDevicePrimaryCtxRetain", void**, int) \
  X(context_release, "cuDevicePrimaryCtxRelease_v2", int) \
  X(context_set, "cuCtxSetCurrent", void*) \
  X(module_load, "cuModuleLoadData", void**, const void*) \
  X(module_unload, "cuModuleUnload", void*) \
  X(module_function, "cuModuleGetFunction", void**, void*, const char*) \
  X(function_attribute, "cuFuncSetAttribute", void*, int, int) \
  X(occupancy, "cuOccupancyMaxActiveBlocksPerMultiprocessor", int*, void*, int, std::size_t) \
  X(stream_create, "cuStreamCreate", void**, unsigned) \
  X(stream_destroy, "cuStreamDestroy_v2", void*) \
  X(stream_query, "cuStreamQuery", void*) \
  X(allocate, "cuMemAlloc_v2", void**, std::size_t) \
  X(free, "cuMemFree_v2", void*) \
  X(fill, "cuMemsetD8Async", void*, unsigned char, std::size_t, void*) \
  X(host_allocate, "cuMemHostAlloc", void**, std::size_t, unsigned) \
  X(host_free, "cuMemFreeHost", void*) \
  X(copy_in, "cuMemcpyHtoDAsync_v2", void*, const void*, std::size_t, void*) \
  X(copy_out, "cuMemcpyDtoH_v2", void*, const void*, std::size_t) \
  X(launch, "cuLaunchKernel", void*, unsigned, unsigned, unsigned, unsigned, unsigned, unsigned, unsigned, void*, void**, void**)
// clang-format on

/// The driver, or the reason why there is none.
struct Driver {
#define SLALOM_MEMBER(function, name, ...) int (*function)(__VA_ARGS__) = nullptr;
  SLALOM_DRIVER(SLALOM_MEMBER)
  std::string fault;

  Driver() {
    void* const library = dlopen("libcuda.so.1", RTLD_NOW | RTLD_LOCAL);
    if (!library) fault = std::string("GPU: no driver: ") + dlerror();
    const auto find = [&](auto& function, const char* name) {
      void* const symbol = library ? dlsym(library, name) : nullptr;
      if (!symbol && fault.empty()) fault = std::string("GPU: the driver is too old: it has no ") + name;
      std::memcpy(&function, &symbol, sizeof symbol);
    };
#define SLALOM_FIND(function, name, ...) find(function, name);
    SLALOM_DRIVER(SLALOM_FIND)
  }
};
const Driver& driver() {
  static const Driver loaded;
  return loaded;
}

// Numbers of cuda.h.
constexpr int multiprocessors = 16, dynamic_shared_bytes = 8, not_ready = 600;
constexpr unsigned non_blocking = 1, device_map = 2;

}  // namespace

bool Session::check(const char* what, int result) noexcept {
  if (result == 0) return true;
  const char* words = nullptr;
  driver().error_text(result, &words);
  try {
    if (fault_.empty())
      fault_ = std::string("GPU: ") + what + ": " + (words ? words : "error " + std::to_string(result));
  } catch (const std::bad_alloc&) {
    fault_ = "no memory";  // short enough to need none
  }
  return false;
}

/// Calls a function of the driver with the context.
template <class... Parameters, class... Arguments>
bool Session::call(const char* what, int (*function)(Parameters...), Arguments... arguments) noexcept {
  return fault_.empty() && check("context", driver().context_set(context_)) &&
         check(what, function(arguments...));
}

int Session::query() const noexcept {
  const int result = driver().context_set(context_);
  return result == 0 ? driver().stream_query(stream_) : result;
}

Session::Session(std::span<const Image> images) noexcept : fault_(driver().fault) {
  const Driver& d = driver();
  if (!fault_.empty() || !check("start of the driver", d.init(0)) ||
      !check("first device", d.context_retain(&context_, 0)))
    return;
  call("multiprocessors", d.device_attribute, &processors_, multiprocessors, 0);
  call("stream", d.stream_create, &stream_, non_blocking);
  int result = 209;  // no code for the device
  for (std::size_t i = 0; fault_.empty() && result != 0 && i < images.size(); ++i)
    result = d.module_load(&module_, images[i]);
  check("loading the problem's code", result);
}

Session::~Session() {
  if (!context_) return;
  const Driver& d = driver();
  synchronize();
  if (query() == not_ready) return;  // freeing would wait for a kernel that never ends
  for (void* const address : memory_) d.free(address);
  for (void* const address : host_memory_) d.host_free(address);
  if (stream_) d.stream_destroy(stream_);
  if (module_) d.module_unload(module_);
  d.context_release(0);
}

void* Session::allocate(std::size_t bytes, bool on_host) {
  auto& all = on_host ? host_memory_ : memory_;
  all.reserve(all.size() + 1);
  void* address = nullptr;
  if (!(on_host ? call("memory of the host", driver().host_allocate, &address, bytes, device_map)
                : call("memory", driver().allocate, &address, bytes)))
    return nullptr;
  all.push_back(address);
  if (on_host) return std::memset(address, 0, bytes);
  call("memory", driver().fill, address, static_cast<unsigned char>(0), bytes, stream_);
  return address;
}

bool Session::copy_in(void* to, const void* from, std::size_t bytes) noexcept {
  return bytes == 0 || call("copy to the device", driver().copy_in, to, from, bytes, stream_);
}

bool Session::copy_out(void* to, const void* from, std::size_t bytes) noexcept {
  return synchronize() && call("copy from the device", driver().copy_out, to, from, bytes);
}

Session::Kernel Session::kernel(const char* name, int shared_bytes) noexcept {
  Kernel kernel{nullptr, shared_bytes, 0};
  int each = 0;
  call(name, driver().module_function, &kernel.function, module_, name);
  call("shared memory", driver().function_attribute, kernel.function, dynamic_shared_bytes, shared_bytes);
  call("occupancy", driver().occupancy, &each, kernel.function, block_threads,
       static_cast<std::size_t>(shared_bytes));
  if (each < 1 && fault_.empty())
    fault_ = std::string("GPU: a block of ") + name + " does not fit into the device";
  kernel.resident_blocks = each * processors_;
  return kernel;
}

bool Session::launch(const Kernel& kernel, int blocks, const void* argument) noexcept {
  void* arguments[] = {const_cast<void*>(argument)};
  return call("launch", driver().launch, kernel.function, static_cast<unsigned>(blocks), 1u, 1u,
              static_cast<unsigned>(block_threads), 1u, 1u, static_cast<unsigned>(kernel.shared_bytes),
              stream_, arguments, nullptr);
}

bool Session::synchronize(bool wait) noexcept {
  using Clock = std::chrono::steady_clock;
  const auto give_up = Clock::now() + std::chrono::seconds(1);
  while (fault_.empty()) {
    const int result = query();
    if (result == not_ready && !wait) return true;
    if (result != not_ready || Clock::now() > give_up) return check("kernel", result);
  }
  return false;
}

}  // namespace slalom::gpu
