#pragma once

#include "solvers/kernels/kernels.hpp"
#include "solvers/kernels/lanes.hpp"

/// The kernel of the published program's rejection: see published_rejection.hpp.
namespace slalom::detail::kernel {

/// The logarithm of a product of many factors, computed with a single logarithm: the product is stored as a
/// number in [1, 2) and an exponent.
template <class F>
class LongProduct {
 public:
  SLALOM_INLINE void multiply(const F& factor) { product_ = product_ * factor; }
  /// Normalises the product. To be called after at most two factors, so that it cannot overflow.
  SLALOM_INLINE void settle() {
    if constexpr (is_pack<F>) {
      using V = typename F::Vector;
      const auto bits = reinterpret_cast<Integers>(product_.v);
      exponent_ = exponent_ + ((bits >> 23) - 127);
      product_ = F(reinterpret_cast<V>((bits & 0x007fffff) | 0x3f800000));
    } else {
      logarithm_ += log(product_);
      product_ = 1;
    }
  }
  SLALOM_INLINE F logarithm() const {
    if constexpr (is_pack<F>) {
      const F n(__builtin_convertvector(exponent_, typename F::Vector));
      return log(product_) + n * F(-2.12194440e-4f) + n * F(0.693359375f);
    } else {
      return logarithm_;
    }
  }

 private:
  template <class G>
  struct IntegersOf {
    using type = double;
  };
  template <class T>
  struct IntegersOf<Pack<T>> {
    using type = typename simd::IntPack<T>::Vector;
  };
  using Integers = typename IntegersOf<F>::type;

  F product_ = F(1.0f);
  F logarithm_ = F(0.0f);
  Integers exponent_{};
};

/// log of prod over rows of (base + density), the inverse of the published program's probability of keeping a
/// sample: density = exp((v - mean)^2 / deviation) / sqrt(2 pi variance); for base see `RejectionRows`.
struct PublishedRejection {
  template <class Target>
  SLALOM_KERNEL static void run(const Rows<RealIn<Target>>& v, const RejectionRows<RealIn<Target>>& d,
                                Range range, RealIn<Target>* logarithms) {
    using F = PackIn<Target>;
    using L = Lanes<F>;
    for (int k = range.first; k < range.first + range.count; k += L::count) {
      LongProduct<F> product;
      for (int r = 0; r < v.rows; ++r) {
        const F difference = L::load(v.row(r) + k) - F(d.rejected_mean[r]);
        const F density = exp(difference * difference * F(d.rejected_inverse[r])) * F(d.rejected_scale[r]);
        product.multiply(F(d.base[r]) + density);
        if (r % 2 == 1 || r + 1 == v.rows) product.settle();
      }
      L::store(product.logarithm(), logarithms + k);
    }
  }
};

}  // namespace slalom::detail::kernel
