#include "slalom/gpu/session.hpp"

#include <dlfcn.h>

#include <chrono>
#include <cstring>
#include <exception>

namespace slalom::gpu {

// The functions of libcuda that are used: name here, name there, parameters. Handles are pointers, results 0
// where all is well.
// clang-format off
#define SLALOM_DRIVER(X) \
  X(init, "cuInit", unsigned) \
  X(error_text, "cuGetErrorString", int, const char**) \
  X(device_get, "cuDeviceGet", int*, int) \
  X(device_name, "cuDeviceGetName", char*, int, int) \
  X(device_attribute, "cuDeviceGetAttribute", int*, int, int) \
  X(context_retain, "cuDevicePrimaryCtxRetain", void**, int) \
  X(context_release, "cuDevicePrimaryCtxRelease_v2", int) \
  X(context_set, "cuCtxSetCurrent", void*) \
  X(module_load, "cuModuleLoadData", void**, const void*) \
  X(module_unload, "cuModuleUnload", void*) \
  X(module_global, "cuModuleGetGlobal_v2", Address*, std::size_t*, void*, const char*) \
  X(module_function, "cuModuleGetFunction", void**, void*, const char*) \
  X(function_attribute, "cuFuncSetAttribute", void*, int, int) \
  X(occupancy, "cuOccupancyMaxActiveBlocksPerMultiprocessor", int*, void*, int, std::size_t) \
  X(stream_create, "cuStreamCreate", void**, unsigned) \
  X(stream_destroy, "cuStreamDestroy_v2", void*) \
  X(stream_query, "cuStreamQuery", void*) \
  X(allocate, "cuMemAlloc_v2", Address*, std::size_t) \
  X(free, "cuMemFree_v2", Address) \
  X(fill, "cuMemsetD8_v2", Address, unsigned char, std::size_t) \
  X(host_allocate, "cuMemHostAlloc", void**, std::size_t, unsigned) \
  X(host_free, "cuMemFreeHost", void*) \
  X(host_address, "cuMemHostGetDevicePointer_v2", Address*, void*, unsigned) \
  X(copy_in, "cuMemcpyHtoD_v2", Address, const void*, std::size_t) \
  X(copy_in_queued, "cuMemcpyHtoDAsync_v2", Address, const void*, std::size_t, void*) \
  X(copy_out, "cuMemcpyDtoH_v2", void*, Address, std::size_t) \
  X(launch, "cuLaunchKernel", void*, unsigned, unsigned, unsigned, unsigned, unsigned, unsigned, unsigned, void*, void**, void**)
// clang-format on

struct Session::Driver {
#define SLALOM_MEMBER(function, name, ...) int (*function)(__VA_ARGS__);
  SLALOM_DRIVER(SLALOM_MEMBER)

  Driver() {
    void* const library = dlopen("libcuda.so.1", RTLD_NOW | RTLD_LOCAL);
    if (!library) throw DeviceError(std::string("GPU: no driver: ") + dlerror());
    const auto find = [&](auto& function, const char* name) {
      void* const symbol = dlsym(library, name);
      if (!symbol) throw DeviceError(std::string("GPU: the driver is too old: it has no ") + name);
      std::memcpy(&function, &symbol, sizeof symbol);
    };
#define SLALOM_FIND(function, name, ...) find(function, name);
    SLALOM_DRIVER(SLALOM_FIND)
  }

  /// Calls a function with a context. Returns its result, or that of the choice of the context.
  template <class... Parameters, class... Arguments>
  int in(void* context, int (*function)(Parameters...), Arguments... arguments) const {
    const int result = context_set(context);
    return result == 0 ? function(arguments...) : result;
  }
  std::string text(int result) const {
    const char* words = nullptr;
    error_text(result, &words);
    return words ? words : "error " + std::to_string(result);
  }
};

namespace {

// Numbers of cuda.h.
constexpr int multiprocessors = 16, major_version = 75, minor_version = 76, dynamic_shared_bytes = 8;
constexpr int not_ready = 600;
constexpr unsigned non_blocking = 1, device_map = 2;
constexpr std::chrono::seconds longest_wait{1};  ///< for all that is queued

}  // namespace

bool Session::check(int result, const char* call) noexcept {
  if (result == 0) return true;
  if (fault_.empty()) {
    try {
      fault_ = std::string("GPU: ") + call + ": " + driver_->text(result);
    } catch (const std::exception&) {  // out of memory: the result says that something failed
    }
  }
  return false;
}

void Session::require(int result, const char* call) const {
  if (result != 0) throw DeviceError(std::string("GPU: ") + call + ": " + driver_->text(result));
}

Session::Session(std::span<const Image> images, const Layout& layout) {
  static const Driver driver;
  driver_ = &driver;
  require(driver.init(0), "start of the driver");
  int device = 0;
  require(driver.device_get(&device, 0), "first device");
  char device_name[128] = {};
  require(driver.device_name(device_name, sizeof device_name, device), "name of the device");
  name_ = device_name;
  int major = 0, minor = 0;
  require(driver.device_attribute(&major, major_version, device), "architecture");
  require(driver.device_attribute(&minor, minor_version, device), "architecture");
  require(driver.device_attribute(&processors_, multiprocessors, device), "multiprocessors");
  architecture_ = 10 * major + minor;
  require(driver.context_retain(&context_, device), "context");
  try {
    require(driver.context_set(context_), "context");
    load(images, layout);
    require(driver.stream_create(&stream_, non_blocking), "stream");
  } catch (...) {
    if (module_) driver.module_unload(module_);
    driver.context_release(device);
    throw;
  }
}

Session::~Session() {
  synchronize();
  if (driver_->stream_query(stream_) == not_ready) return;  // freeing would wait for a kernel that never ends
  for (const Address address : memory_) driver_->free(address);
  for (void* const address : host_memory_) driver_->host_free(address);
  driver_->stream_destroy(stream_);
  driver_->module_unload(module_);
  driver_->context_release(0);
}

/// Takes the code for the latest architecture that this device runs, or the PTX.
void Session::load(std::span<const Image> images, const Layout& layout) {
  const Image* best = nullptr;
  std::string present;
  for (const Image& image : images) {
    present +=
        (present.empty() ? "" : ", ") + std::to_string(image.architecture) + (image.ptx ? " (PTX)" : "");
    const bool runs =
        image.ptx ? image.architecture <= architecture_
                  : image.architecture / 10 == architecture_ / 10 && image.architecture <= architecture_;
    if (runs && (!best || best->ptx || (!image.ptx && image.architecture > best->architecture)))
      best = &image;
  }
  if (!best) {
    throw DeviceError("GPU: " + name_ + " has architecture " + std::to_string(architecture_) +
                      ", the problem is compiled for " + present);
  }
  require(driver_->module_load(&module_, best->begin), "loading the problem's code");
  Address address = 0;
  std::size_t bytes = 0;
  require(driver_->module_global(&address, &bytes, module_, "slalom_layout"), "slalom_layout");
  Layout found{};
  require(driver_->copy_out(&found, address, sizeof found), "slalom_layout");
  if (!(found == layout))
    throw DeviceError("GPU: the code was made from another version of the problem or of slalom");
}

Session::Address Session::allocate(std::size_t bytes) {
  Address address = 0;
  memory_.reserve(memory_.size() + 1);
  require(driver_->in(context_, driver_->allocate, &address, bytes), "memory");
  memory_.push_back(address);
  require(driver_->fill(address, 0, bytes), "memory");
  return address;
}

void* Session::allocate_on_host(std::size_t bytes, Address& device) {
  void* address = nullptr;
  host_memory_.reserve(host_memory_.size() + 1);
  require(driver_->in(context_, driver_->host_allocate, &address, bytes, device_map), "memory of the host");
  host_memory_.push_back(address);
  std::memset(address, 0, bytes);
  require(driver_->host_address(&device, address, 0), "memory of the host");
  return address;
}

void Session::copy_in(Address to, const void* from, std::size_t bytes) {
  require(driver_->in(context_, driver_->copy_in, to, from, bytes), "copy to the device");
}

void Session::copy_out(void* to, Address from, std::size_t bytes) {
  if (!synchronize()) throw DeviceError(fault_);
  require(driver_->copy_out(to, from, bytes), "copy from the device");
}

void* Session::kernel(const char* kernel_name, int threads, int shared_bytes) {
  void* function = nullptr;
  require(driver_->in(context_, driver_->module_function, &function, module_, kernel_name), kernel_name);
  require(driver_->function_attribute(function, dynamic_shared_bytes, shared_bytes), "shared memory");
  if (resident_blocks(function, threads, shared_bytes) < 1)
    throw DeviceError(std::string("GPU: a block of ") + kernel_name + " does not fit into the device");
  return function;
}

int Session::resident_blocks(void* function, int threads, int shared_bytes) {
  int each = 0;
  require(driver_->occupancy(&each, function, threads, static_cast<std::size_t>(shared_bytes)), "occupancy");
  return each * processors_;
}

bool Session::refresh(Address to, const void* from, std::size_t bytes) noexcept {
  return check(driver_->in(context_, driver_->copy_in_queued, to, from, bytes, stream_),
               "copy to the device");
}

bool Session::launch(void* function, int blocks, int threads, int shared_bytes,
                     const void* argument) noexcept {
  void* arguments[] = {const_cast<void*>(argument)};
  return check(driver_->in(context_, driver_->launch, function, static_cast<unsigned>(blocks), 1u, 1u,
                           static_cast<unsigned>(threads), 1u, 1u, static_cast<unsigned>(shared_bytes),
                           stream_, arguments, nullptr),
               "launch");
}

bool Session::alive() noexcept {
  const int result = driver_->stream_query(stream_);
  return result == not_ready || check(result, "kernel");
}

bool Session::synchronize() noexcept {
  using Clock = std::chrono::steady_clock;
  const auto give_up = Clock::now() + longest_wait;
  int result = driver_->context_set(context_);
  while (result == 0 && (result = driver_->stream_query(stream_)) == not_ready && Clock::now() < give_up)
    result = 0;
  return check(result, "kernel");
}

}  // namespace slalom::gpu
