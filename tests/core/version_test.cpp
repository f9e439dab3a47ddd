#include "slalom/core/version.hpp"

#include <gtest/gtest.h>

#include <regex>

TEST(Version, IsThreeNumbers) {
  EXPECT_TRUE(std::regex_match(slalom::version(), std::regex("[0-9]+\\.[0-9]+\\.[0-9]+")));
}
