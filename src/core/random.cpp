#include "slalom/core/random.hpp"

#include "core/normal_pair.hpp"
#include "slalom/core/dispatch.hpp"

namespace slalom {

namespace {

using KeyWords = std::array<std::uint32_t, 4>;

KeyWords key_words(RandomKey key, std::uint32_t domain) {
  return {static_cast<std::uint32_t>(key.seed), static_cast<std::uint32_t>(key.seed >> 32),
          static_cast<std::uint32_t>(key.stream), static_cast<std::uint32_t>(key.stream >> 32) ^ domain};
}

constexpr std::uint32_t scalar_domain = 0x5ca1a800u, batch_domain = 0xba7c4000u;

/// Eight consecutive rows come from one block of Threefry, so a block per lane serves a pack of samples.
struct FillNormal {
  template <class Target>
  SLALOM_KERNEL static void run(SequenceBatch& batch, int first, int count, const KeyWords& given_key) {
    using F = Pack<Target>;
    using U = typename simd::detail::VectorTypes<F::lanes>::Unsigned;
    const KeyWords key =
        given_key;  // a copy, which no store can change: its schedule stays outside the loops
    const int rows = batch.rows();
    const std::ptrdiff_t stride = batch.stride();
    U lane{};
    for (int i = 0; i < F::lanes; ++i) lane[i] = static_cast<std::uint32_t>(i);
    for (int row = 0; row < rows; row += 8) {
      const int left = rows - row;
      float* const block = batch.data(row);
      for (int sample = first; sample < first + count; sample += F::lanes) {
        const std::array<U, 4> words =
            detail::threefry(U(lane + static_cast<std::uint32_t>(sample)),
                             U(U{} + static_cast<std::uint32_t>(row / 8)), U{}, U{}, key);
        float* to = block + sample;
        for (int i = 0; 2 * i < left && i < 4; ++i, to += 2 * stride) {
          F even, odd;
          detail::normal_pair<F>(words[i], even, odd);
          even.store(to);
          if (2 * i + 1 < left) odd.store(to + stride);
        }
      }
    }
  }
};

}  // namespace

void RandomStream::refill() noexcept {
  words_ = detail::threefry(static_cast<std::uint32_t>(block_), static_cast<std::uint32_t>(block_ >> 32), 0u,
                            0u, key_words(key_, scalar_domain));
  ++block_;
  used_ = 0;
}

void fill_normal(SequenceBatch& batch, int first, int count, RandomKey key) noexcept {
  simd::dispatch<FillNormal>(batch, first, count, key_words(key, batch_domain));
}

}  // namespace slalom
