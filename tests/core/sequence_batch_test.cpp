#include "slalom/core/sequence_batch.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>

namespace slalom {
namespace {

TEST(AlignedBuffer, IsZeroedAndAligned) {
  const AlignedBuffer buffer(37);
  EXPECT_EQ(buffer.size(), 37);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(buffer.data()) % 64, 0u);
  for (int i = 0; i < 37; ++i) EXPECT_EQ(buffer[i], 0.0f);
}

TEST(SequenceBatch, RowsAreStepsTimesInputs) {
  SequenceBatch batch(3, 2, 5);
  EXPECT_EQ(batch.rows(), 6);
  EXPECT_EQ(batch.stride(), simd::padding);
  batch.at(2, 1, 4) = 7;
  EXPECT_EQ(batch[5][4], 7.0f);
  EXPECT_EQ(batch.data(5), batch.row(2, 1));
  EXPECT_EQ(batch.data(5) - batch.data(4), batch.stride());
}

TEST(SequenceBatch, SamplesAreCopiedInAndOut) {
  SequenceBatch batch(2, 2, 20);
  const std::array<float, 4> sequence{1, 2, 3, 4};
  batch.set_sample(17, sequence);
  EXPECT_EQ(batch.at(0, 0, 17), 1.0f);
  EXPECT_EQ(batch.at(1, 1, 17), 4.0f);
  EXPECT_EQ(batch.at(1, 1, 16), 0.0f);
  EXPECT_EQ(batch.at(1, 1, 18), 0.0f);
  std::array<float, 4> copy{};
  batch.get_sample(17, copy);
  EXPECT_EQ(copy, sequence);
}

}  // namespace
}  // namespace slalom
