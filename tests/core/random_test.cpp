// Numbers that are too large, and files that do not fit onto the disk.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <vector>

#include "slalom/core/files/write_file.hpp"
#include "slalom/core/numbers/count.hpp"
#include "slalom/core/random.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_words.hpp"

namespace slalom {
namespace {

TEST(FillNormal, ValueDependsOnKeyRowAndSampleAlone) {
  SequenceBatch whole(5, 2, 640), parts(5, 2, 640);
  fill_normal(whole, 0, 640, {7, 3});
  fill_normal(parts, 320, 320, {7, 3});
  fill_normal(parts, 0, 320, {7, 3});
  SequenceBatch other(5, 2, 640);
  fill_normal(other, 0, 640, {7, 4});
  int equal = 0;
  for (int t = 0; t < 5; ++t)
    for (int i = 0; i < 2; ++i)
      for (int k = 0; k < 640; ++k) {
        ASSERT_EQ(whole.at(t, i, k), parts.at(t, i, k));
        equal += whole.at(t, i, k) == other.at(t, i, k);
      }
  EXPECT_LT(equal, 3);
}

/// Anderson and Darling's statistic of sorted values against the standard normal distribution.
double anderson_darling(const std::vector<double>& sorted) {
  const double n = sorted.size();
  double sum = 0;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const double low = 0.5 * std::erfc(-sorted[i] / std::sqrt(2.0));
    const double high = 0.5 * std::erfc(sorted[sorted.size() - 1 - i] / std::sqrt(2.0));
    sum += (2.0 * static_cast<double>(i) + 1) * (std::log(low) + std::log(high));
  }
  return -n - sum / n;
}

TEST(FillNormal, PassesAndersonDarlingOnMillionsOfDraws) {
  for (std::uint64_t stream = 0; stream < 4; ++stream) {
    const int rows = 8, samples = 1 << 17;
    SequenceBatch batch(rows, 1, samples);
    fill_normal(batch, 0, samples, {11, stream});
    std::vector<double> values;
    for (int t = 0; t < rows; ++t)
      for (int k = 0; k < samples; ++k) values.push_back(static_cast<double>(batch.at(t, 0, k)));
    std::sort(values.begin(), values.end());
    EXPECT_LT(anderson_darling(values), 7.0) << "stream " << stream;  // beyond it lie fewer than 1 in 2000
  }
}

TEST(FillNormal, RowsSamplesAndStreamsAreNotCorrelated) {
  const int rows = 8, samples = 1 << 16;
  SequenceBatch a(rows, 1, samples), b(rows, 1, samples);
  fill_normal(a, 0, samples, {5, 1});
  fill_normal(b, 0, samples, {5, 2});
  const double bound = 5.5 / std::sqrt(static_cast<double>(samples));
  const auto correlation = [&](const float* x, const float* y, int count, bool squares) {
    double sum = 0;
    for (int k = 0; k < count; ++k) {
      const double u = x[k], v = y[k];
      sum += squares ? 0.5 * (u * u - 1) * (v * v - 1) : u * v;
    }
    return sum / count;
  };
  for (const bool squares : {false, true}) {
    for (int r = 0; r < rows; ++r) {
      for (int q = 0; q < r; ++q) {
        EXPECT_NEAR(correlation(a.row(r, 0), a.row(q, 0), samples, squares), 0, bound) << r << " " << q;
      }
      for (const int lag : {1, 2, 4, 8, 16, 64}) {
        EXPECT_NEAR(correlation(a.row(r, 0), a.row(r, 0) + lag, samples - lag, squares), 0, bound)
            << r << " " << lag;
      }
      EXPECT_NEAR(correlation(a.row(r, 0), b.row(r, 0), samples, squares), 0, bound) << r;
    }
  }
}

/// Chi-squared of counts that are expected to be equal.
double chi_squared(const std::vector<int>& counts) {
  double sum = 0, chi2 = 0;
  for (const int count : counts) sum += count;
  const double expected = sum / static_cast<double>(counts.size());
  for (const int count : counts) chi2 += (count - expected) * (count - expected) / expected;
  return chi2;
}

/// The two values of a pair come from the same 32 bits: nothing of that may be seen between them.
TEST(FillNormal, PairsAreUniformInAngle) {
  const int rows = 8, samples = 1 << 18, parts = 64;
  SequenceBatch batch(rows, 1, samples);
  fill_normal(batch, 0, samples, {17, 1});
  std::vector<int> cells(parts * parts), octants(8);
  const auto part = [&](double x) {
    return static_cast<std::size_t>(std::min(0.5 * std::erfc(-x / std::sqrt(2.0)) * parts, parts - 1.0));
  };
  for (int row = 0; row < rows; row += 2)
    for (int k = 0; k < samples; ++k) {
      const double x = batch.at(row, 0, k), y = static_cast<double>(batch.at(row + 1, 0, k));
      ++cells[part(x) * parts + part(y)];
      const auto octant = static_cast<std::size_t>(4 * (x < 0) + 2 * (y < 0) + (std::abs(x) < std::abs(y)));
      octants[octant] += std::hypot(x, y) > 4;
    }
  const double freedom = parts * parts - 1.0;
  EXPECT_NEAR(chi_squared(cells), freedom, 5 * std::sqrt(2 * freedom));
  EXPECT_LT(chi_squared(octants), 36);  // 7 degrees of freedom: the 1 - 1e-5 quantile is 35.3
}

TEST(RandomStream, UniformIsUniform) {
  RandomStream stream({42, 0});
  std::vector<int> bins(64);
  for (int i = 0; i < 1 << 16; ++i) ++bins[stream.uniform() * 64];
  EXPECT_LT(chi_squared(bins), 120);  // 63 degrees of freedom: the 1e-5 quantile is 123
  EXPECT_GT(chi_squared(bins), 25);
}

TEST(SaturateCast, StaysWithinTheRange) {
  EXPECT_EQ(saturate_cast<int>(-2.9), -2);
  EXPECT_EQ(saturate_cast<int>(3.9F), 3);
  for (const double beyond : {2147483648.0, 1e300, HUGE_VAL}) {
    EXPECT_EQ(saturate_cast<int>(beyond), 2147483647);
    EXPECT_EQ(saturate_cast<int>(-beyond), -2147483647 - 1);
  }
  EXPECT_EQ(saturate_cast<int>(std::nan("")), 1 + saturate_cast<int>(std::nanf(""), -1));
  EXPECT_EQ(saturate_cast<std::size_t>(-1.0), 0u);
  EXPECT_EQ(saturate_cast<std::size_t>(1e20), ~std::size_t{0});
  EXPECT_EQ(saturate_cast<std::uint32_t>(4294967295.5), 4294967295u);
}

TEST(Count, NamesWhatIsTooLong) {
  EXPECT_EQ(count(1.05, 0.1, 20, "path"), 11u);
  EXPECT_EQ(message_of([] { count(1e300, 0.5, 100, "path"); }),
            "path: 1e+300 m in steps of 0.5 m must be at most 50 m, 100 steps");
  EXPECT_THROW(count(std::nan(""), 1, 100, "path"), std::invalid_argument);
  EXPECT_THROW(count(1, 0, 100, "path"), std::invalid_argument);
}

class WriteFile : public testing::TemporaryFolder {
 protected:
  std::string refusal(const std::string& file) {
    return message_of<IoError>([&] { write_file(file, std::string(5000, 'x')); });
  }
};

TEST_F(WriteFile, StatesTheReasonOfTheSystem) {
  EXPECT_EQ(refusal("/dev/full"), "/dev/full: cannot be written: No space left on device");
  EXPECT_TRUE(std::filesystem::exists("/dev/full"));
  const std::string file = (folder_ / "none" / "file").string();
  EXPECT_EQ(refusal(file), file + ": cannot be written: No such file or directory");
}

TEST_F(WriteFile, LeavesNoPartOfAFile) {
  const std::string file = (folder_ / "file").string();
  rlimit limit{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &limit), 0);
  const rlimit small{1000, limit.rlim_max};
  const auto before = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::string message = refusal(file);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
  std::signal(SIGXFSZ, before);
  EXPECT_EQ(message, file + ": cannot be written: File too large");
  EXPECT_FALSE(std::filesystem::exists(file));
}

}  // namespace

}  // namespace slalom
