#include "support/allocations.hpp"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

std::atomic<long> calls{0}, live{0};
thread_local long until_failure = -1;  // allocations of this thread before the one that fails; -1: none fails
thread_local bool has_failed = false;

void count_call() {
  ++calls;
  if (until_failure == 0) {
    until_failure = -1;
    has_failed = true;
    throw std::bad_alloc();
  }
  if (until_failure > 0) --until_failure;
}

void release(void* memory) {
  if (memory) --live;
  std::free(memory);
}

}  // namespace

// Not inlined: where a compiler sees malloc and free at new and delete, it warns that they do not match.
__attribute__((noinline)) void* operator new(std::size_t size) {
  count_call();
  void* const memory = std::malloc(size ? size : 1);
  if (!memory) throw std::bad_alloc();
  ++live;
  return memory;
}
__attribute__((noinline)) void* operator new(std::size_t size, std::align_val_t alignment) {
  count_call();
  const auto a = static_cast<std::size_t>(alignment);
  void* const memory = std::aligned_alloc(a, (size + a - 1) / a * a);
  if (!memory) throw std::bad_alloc();
  ++live;
  return memory;
}
// std::stable_sort asks this one for its buffer. The library's own calls the first one, that of
// AddressSanitizer does not.
__attribute__((noinline)) void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  try {
    return operator new(size);
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}
__attribute__((noinline)) void operator delete(void* memory) noexcept {
  release(memory);
}
__attribute__((noinline)) void operator delete(void* memory, const std::nothrow_t&) noexcept {
  release(memory);
}
__attribute__((noinline)) void operator delete(void* memory, std::size_t) noexcept {
  release(memory);
}
__attribute__((noinline)) void operator delete(void* memory, std::align_val_t) noexcept {
  release(memory);
}
__attribute__((noinline)) void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  release(memory);
}

namespace slalom::testing {

long allocations() noexcept {
  return calls;
}

long live_allocations() noexcept {
  return live;
}

void fail_allocation_after(long others) noexcept {
  has_failed = false;
  until_failure = others;
}

bool stop_failing() noexcept {
  until_failure = -1;
  return has_failed;
}

}  // namespace slalom::testing
