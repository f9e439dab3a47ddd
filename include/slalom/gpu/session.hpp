#pragma once

#include <cstddef>
#include <cstdint>
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

/// Code of a problem for one architecture, or PTX for later ones; `slalom_gpu_problem` makes it.
struct Image {
  int architecture = 0;                  ///< 90: compute capability 9.0
  bool ptx = false;                      ///< PTX, which the driver compiles
  const unsigned char* begin = nullptr;  ///< first byte of the code
  const unsigned char* end = nullptr;    ///< end of the code
};

/// The code of problem `P`. Defined by `slalom_gpu_problem(... PROBLEM P)`; without it, the program does not
/// link.
template <class P>
std::span<const Image> images();

/// The layout that host and device must have in common.
struct Layout {
  int problem;    ///< size of the problem, bytes
  int alignment;  ///< alignment of the problem, bytes
  int arguments;  ///< size of the arguments of a kernel, bytes
  int inputs;     ///< number of inputs
  /// Whether two layouts are the same.
  bool operator==(const Layout&) const = default;
};

/// The code of a problem on a device, with a stream and memory of its own. Constructor, `allocate`, `copy_in`
/// and `copy_out` throw DeviceError; the other functions return false where the device fails, and `fault`
/// says why.
class Session {
 public:
  using Address = std::uint64_t;  ///< on the device

  /// Loads the code for the first device. Throws if there is none, or if its layout differs.
  Session(std::span<const Image> images, const Layout& layout);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Zeroed memory on the device. It lasts as long as the session.
  Address allocate(std::size_t bytes);
  /// Zeroed memory of the host that the device writes; `device` is its address there.
  void* allocate_on_host(std::size_t bytes, Address& device);
  /// Copies to the device and waits until it is done.
  void copy_in(Address to, const void* from, std::size_t bytes);
  /// Copies from the device and waits until it is done.
  void copy_out(void* to, Address from, std::size_t bytes);

  /// An entry point of the code, for launches with so much shared memory. Throws if a block does not fit.
  void* kernel(const char* name, int threads, int shared_bytes);
  /// Blocks of a kernel that the device holds at a time.
  int resident_blocks(void* kernel, int threads, int shared_bytes);

  /// Queues a copy to the device; `from` is read before this returns.
  bool refresh(Address to, const void* from, std::size_t bytes) noexcept;
  /// Queues a launch of a kernel with its argument.
  bool launch(void* kernel, int blocks, int threads, int shared_bytes, const void* argument) noexcept;
  /// Whether the device still works; asks it, which takes some microseconds.
  bool alive() noexcept;
  /// Waits for everything that is queued, for a second at most: then the device counts as failed.
  bool synchronize() noexcept;
  /// The first failure; empty if there is none.
  const std::string& fault() const noexcept { return fault_; }

 private:
  struct Driver;
  bool check(int result, const char* call) noexcept;
  void require(int result, const char* call) const;
  void load(std::span<const Image> images, const Layout& layout);

  const Driver* driver_;
  std::string name_, fault_;
  int architecture_ = 0, processors_ = 0;
  void *context_ = nullptr, *module_ = nullptr, *stream_ = nullptr;
  std::vector<Address> memory_;
  std::vector<void*> host_memory_;
};

}  // namespace slalom::gpu
