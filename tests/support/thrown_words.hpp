#pragma once

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

namespace slalom {

/// Expects that the call throws an `Error` whose message has all these words.
template <class Error, class Call>
void expect_error_with(const std::vector<const char*>& words, Call&& call) {
  try {
    call();
    ADD_FAILURE() << "did not throw; must name " << (words.empty() ? "" : words.front());
  } catch (const Error& error) {
    for (const char* word : words)
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << word << " in " << error.what();
  }
}

/// Returns the message of the `Error` that the call throws; "accepted" if it throws none.
template <class Error = std::invalid_argument, class Call>
std::string message_of(Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace slalom
