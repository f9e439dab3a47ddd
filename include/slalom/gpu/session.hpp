#pragma once

#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

/// A GPU through the driver's interface, which is loaded when the first session is opened: nothing of CUDA is
/// needed to build or to start a program.
namespace slalom::gpu {

/// No driver, no device, no code for it, too little memory, or a fault of the device.
class DeviceError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Code of a problem for one architecture, or PTX; `slalom_gpu_problem` makes it.
using Image = const unsigned char*;

/// The code of problem `P`, that for the latest architecture first and PTX last. Defined by
/// `slalom_gpu_problem(... PROBLEM P)`; without it, the program does not link.
template <class P>
std::span<const Image> images();

/// The code of a problem on the first device, with a stream and memory of its own. No function throws. The
/// first failure stays: from then on all calls do nothing and return false or null.
class Session {
 public:
  /// A kernel with the shared memory of its blocks.
  struct Kernel {
    void* function = nullptr;  ///< handle of the driver
    int shared_bytes = 0;      ///< shared memory of a block
    int resident_blocks = 0;   ///< blocks that the device holds at a time
  };

  /// Loads the first of the images that the device runs.
  explicit Session(std::span<const Image> images) noexcept;
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Zeroed memory on the device, or memory of the host that the device writes at the same address. It lasts
  /// as long as the session.
  void* allocate(std::size_t bytes, bool on_host = false);
  /// Queues a copy to the device; `from` is read before this returns.
  bool copy_in(void* to, const void* from, std::size_t bytes) noexcept;
  /// Waits for everything that is queued, and copies from the device.
  bool copy_out(void* to, const void* from, std::size_t bytes) noexcept;

  /// Prepares a kernel of the code.
  Kernel kernel(const char* name, int shared_bytes) noexcept;
  /// Queues a launch of a kernel with its argument.
  bool launch(const Kernel& kernel, int blocks, const void* argument) noexcept;
  /// Waits for everything that is queued, for a second at most: then the device counts as failed.
  bool synchronize() noexcept { return synchronize(true); }
  /// Whether the device still works; asks it, which takes some microseconds.
  bool alive() noexcept { return synchronize(false); }

  /// The first failure; empty if there is none.
  const std::string& fault() const noexcept { return fault_; }
  /// Throws DeviceError if there is a failure.
  void require() const {
    if (!fault_.empty()) throw DeviceError(fault_);
  }

 private:
  template <class... Parameters, class... Arguments>
  bool call(const char* what, int (*function)(Parameters...), Arguments... arguments) noexcept;
  bool check(const char* what, int result) noexcept;
  int query() const noexcept;
  bool synchronize(bool wait) noexcept;

  std::string fault_;
  int processors_ = 0;
  void *context_ = nullptr, *module_ = nullptr, *stream_ = nullptr;
  std::vector<void*> memory_, host_memory_;
};

}  // namespace slalom::gpu
