// Numbers that are too large, and files that do not fit onto the disk.
#include <sys/resource.h>

#include <csignal>

#include "slalom/core/files/write_file.hpp"
#include "slalom/core/numbers/count.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_words.hpp"

namespace slalom {
namespace {

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
