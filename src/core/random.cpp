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

/// Eight consecutive rows come from one block of Threefry, so a block a lane serves a pack of samples.
template <class Target>
SLALOM_INLINE void fill(SequenceBatch& batch, int first, int count, const KeyWords& given_key) {
  using F = Pack<Target>;
  using U = typename simd::detail::VectorTypes<F::lanes>::Unsigned;
  const KeyWords key = given_key;  // a copy, which no store can change: its schedule stays outside the loops
  const int rows = batch.steps() * batch.inputs();
  const std::ptrdiff_t stride = batch.stride();
  U lane{};
  for (int i = 0; i < F::lanes; ++i) lane[i] = static_cast<std::uint32_t>(i);
  for (int row = 0; row < rows; row += 8) {
    const int take = rows - row;
    float* const block = batch.row(0, 0) + row * stride;
    for (int sample = first; sample < first + count; sample += F::lanes) {
      const std::array<U, 4> words =
          detail::threefry(U(lane + static_cast<std::uint32_t>(sample)),
                           U(U{} + static_cast<std::uint32_t>(row / 8)), U{}, U{}, key);
      float* to = block + sample;
      for (int i = 0; 2 * i < take && i < 4; ++i, to += 2 * stride) {
        F even, odd;
        detail::normal_pair<F>(words[static_cast<std::size_t>(i)], even, odd);
        even.store(to);
        if (2 * i + 1 < take) odd.store(to + stride);
      }
    }
  }
}

using Fill = void (*)(SequenceBatch&, int, int, const KeyWords&);

SLALOM_TARGET_GENERIC void fill_generic(SequenceBatch& b, int first, int count, const KeyWords& key) {
  fill<simd::Generic>(b, first, count, key);
}
#if SLALOM_X86
SLALOM_TARGET_SSE4 void fill_sse4(SequenceBatch& b, int first, int count, const KeyWords& key) {
  fill<simd::Sse4>(b, first, count, key);
}
SLALOM_TARGET_AVX2 void fill_avx2(SequenceBatch& b, int first, int count, const KeyWords& key) {
  fill<simd::Avx2>(b, first, count, key);
}
SLALOM_TARGET_AVX512 void fill_avx512(SequenceBatch& b, int first, int count, const KeyWords& key) {
  fill<simd::Avx512>(b, first, count, key);
}
#endif

Fill choose_fill() {
#if SLALOM_X86
  switch (simd::active_target()) {
    case simd::Target::avx512:
      return fill_avx512;
    case simd::Target::avx2:
      return fill_avx2;
    case simd::Target::sse4:
      return fill_sse4;
    case simd::Target::generic:
      break;
  }
#endif
  return fill_generic;
}

}  // namespace

void RandomStream::refill() noexcept {
  words_ = detail::threefry(static_cast<std::uint32_t>(block_), static_cast<std::uint32_t>(block_ >> 32), 0u,
                            0u, key_words(key_, scalar_domain));
  ++block_;
  used_ = 0;
}

void fill_normal(SequenceBatch& batch, int first, int count, RandomKey key) noexcept {
  static const Fill fill_rows = choose_fill();
  fill_rows(batch, first, count, key_words(key, batch_domain));
}

}  // namespace slalom
