#include "solvers/kernels/kernel_table.hpp"

namespace slalom::detail {

namespace {

struct OnDouble {
  template <class Kernel>
  auto of() const {
    return &Kernel::template run<Reference>;
  }
};

}  // namespace

template <>
const Kernels<double>& kernels<double>() {
  static const Kernels<double> table = kernel_table<double>(OnDouble{});
  return table;
}

}  // namespace slalom::detail
