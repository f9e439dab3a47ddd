#include "solvers/kernels/kernels.hpp"

#include <array>

#include "solvers/kernels/kernel_table.hpp"

namespace slalom::detail {

namespace {

struct ForTarget {
  simd::Target target;
  template <class Kernel>
  auto of() const {
    return simd::kernel<Kernel>(target);
  }
};

}  // namespace

const Kernels<float>& kernels(simd::Target target) {
  using simd::Target;
  static const std::array<Kernels<float>, 4> tables{
      kernel_table<float>(ForTarget{Target::generic}), kernel_table<float>(ForTarget{Target::sse4}),
      kernel_table<float>(ForTarget{Target::avx2}), kernel_table<float>(ForTarget{Target::avx512})};
  switch (target) {
    case Target::sse4:
      return tables[1];
    case Target::avx2:
      return tables[2];
    case Target::avx512:
      return tables[3];
    case Target::generic:
      break;
  }
  return tables[0];
}

template <>
const Kernels<float>& kernels<float>() {
  static const Kernels<float>& chosen = kernels(simd::active_target());
  return chosen;
}

}  // namespace slalom::detail
