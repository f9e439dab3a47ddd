// The ways in which AVX-512 kernels read cells, and the choice between them.
#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <vector>

#include "slalom/core/dispatch.hpp"
#include "slalom/core/grid_view.hpp"
#include "slalom/core/simd.hpp"

namespace slalom::simd {
namespace {

struct ReadCells {
  template <class Target>
  SLALOM_KERNEL static void run(const float* cells, const std::int32_t* indices, float* values) {
    using F = Pack<Target>;
    for (int k = 0; k < padding; k += F::lanes) {
      IntPack<Target> index;
      std::memcpy(&index.v, indices + k, sizeof index.v);
      F r[4] = {F(0.0f), F(0.0f), F(0.0f), F(0.0f)};
      Operations<Target>::gather_cells(cells, index.v, r[0].v, r[1].v, r[2].v, r[3].v);
      for (int layer = 0; layer < 4; ++layer) r[layer].store(values + layer * padding + k);
    }
  }
};

class CellReads : public testing::Test {
 protected:
  ~CellReads() override { set_cell_access(before_); }

 private:
  CellAccess before_ = active_cell_access().access;
};

TEST_F(CellReads, GiveTheSameBitsBothWays) {
  constexpr int count = 5000;
  std::vector<float> cells(4 * count);
  for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = 0.37f * static_cast<float>(i) - 3;
  std::int32_t indices[padding];
  for (int k = 0; k < padding; ++k) indices[k] = k * 7919 % count;
  indices[3] = 0;
  indices[9] = count - 1;
  for (const CellAccess access : {CellAccess::loads, CellAccess::gathers}) {
    SCOPED_TRACE(name(access));
    set_cell_access(access);
    float values[4 * padding] = {};
    kernel<ReadCells>()(cells.data(), indices, values);
    for (int layer = 0; layer < 4; ++layer)
      for (int k = 0; k < padding; ++k)
        EXPECT_EQ(values[layer * padding + k], cells[static_cast<std::size_t>(4 * indices[k] + layer)]);
  }
}

TEST_F(CellReads, AreMeasuredWithoutAChangeOfTheChoice) {
  set_cell_access(CellAccess::gathers);
  const CellAccessChoice choice = measure_cell_access();
  if (!supported(Target::avx512)) {
    EXPECT_EQ(choice.access, CellAccess::loads);
    EXPECT_EQ(choice.loads_ns, 0);
    EXPECT_EQ(choice.gathers_ns, 0);
    return;
  }
  EXPECT_GT(choice.loads_ns, 0);
  EXPECT_GT(choice.gathers_ns, 0);
  EXPECT_EQ(choice.access == CellAccess::gathers, choice.gathers_ns <= 1.03 * choice.loads_ns);
}

TEST(CellAccess, HasNames) {
  EXPECT_STREQ(name(CellAccess::loads), "loads");
  EXPECT_STREQ(name(CellAccess::gathers), "gathers");
}

}  // namespace
}  // namespace slalom::simd
