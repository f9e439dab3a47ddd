// Options by name and as text: every type, every refusal with its value and rule.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

#include "slalom/core/error.hpp"
#include "slalom/core/option_access.hpp"
#include "slalom/core/thread_pool.hpp"
#include "support/thrown_words.hpp"

namespace slalom {
namespace {

enum class Mood { calm, wild };
inline const char* const* enum_names(Mood) {
  static constexpr const char* names[] = {"calm", "wild", nullptr};
  return names;
}

struct SampleOptions {
  bool loud = false;
  int count = 3;
  std::uint64_t seed = 7;
  double gain = 0.5;
  PerInput spread = {0.1, 0.2};
  Mood mood = Mood::calm;
};

template <class Options, class Visit>
requires is_options_of<Options, SampleOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.loud, {"loud", "", ""});
  visit(o.count, {"count", "", "", 1, 10});
  visit(o.seed, {"seed", "", ""});
  visit(o.gain, {"gain", "m", "", 0});
  visit(o.spread, {"spread", "", "", 0, 1});
  visit(o.mood, {"mood", "", ""});
}

std::string refusal(const char* name, const char* text) {
  SampleOptions options;
  return message_of([&] { set_option(options, name, text); });
}

TEST(OptionAccess, SetsEveryType) {
  SampleOptions o;
  EXPECT_TRUE(set_option(o, "loud", "true"));
  EXPECT_TRUE(set_option(o, "count", "10"));
  EXPECT_TRUE(set_option(o, "seed", "18446744073709551615"));
  EXPECT_TRUE(set_option(o, "gain", "2.5e-3"));
  EXPECT_TRUE(set_option(o, "spread", "[ 1, 0.5,0 ]"));
  EXPECT_TRUE(set_option(o, "mood", "wild"));
  EXPECT_FALSE(set_option(o, "colour", "red"));
  EXPECT_TRUE(o.loud);
  EXPECT_EQ(o.count, 10);
  EXPECT_EQ(o.seed, 18446744073709551615u);
  EXPECT_EQ(o.gain, 2.5e-3);
  EXPECT_EQ(o.spread.values(), (std::vector<double>{1, 0.5, 0}));
  EXPECT_EQ(o.mood, Mood::wild);
  set_option(o, "spread", "0.25");
  EXPECT_EQ(o.spread.values(), std::vector<double>{0.25});
}

TEST(OptionAccess, ErrorsNameValueAndRule) {
  EXPECT_EQ(refusal("loud", "yes"), "'yes' must be true or false");
  EXPECT_EQ(refusal("count", "2.5"), "'2.5' must be an integer");
  EXPECT_EQ(refusal("count", "11"), "'11' must be in [1, 10]");
  EXPECT_EQ(refusal("count", "99999999999"),
            "'99999999999' must be an integer from -2147483648 to 2147483647");
  EXPECT_EQ(refusal("count", "100000000"), "'100000000' must be in [1, 10]");
  EXPECT_EQ(refusal("count", "99999999999x"), "'99999999999x' must be an integer");
  EXPECT_EQ(refusal("seed", "-1"), "'-1' must be an integer from 0 to 18446744073709551615");
  EXPECT_EQ(refusal("gain", "fast"), "'fast' must be a number");
  EXPECT_EQ(refusal("gain", "nan"), "'nan' must be a number");
  EXPECT_EQ(refusal("gain", ""), "'' must be a number");
  EXPECT_EQ(refusal("gain", "-0.5"), "'-0.5' must be at least 0");
  EXPECT_EQ(refusal("spread", "[0.1, 2]"), "'2' must be in [0, 1]");
  EXPECT_EQ(refusal("spread", "[]"), "'' must be a number");
  EXPECT_EQ(refusal("spread", "[1, 2"), "'[1, 2' must be a number or a list of numbers, [a, b]");
  EXPECT_EQ(refusal("mood", "tired"), "'tired' must be one of calm, wild");
}

TEST(OptionAccess, WritesWholeLimitsOut) {
  EXPECT_EQ(range_rule({.name = "samples", .min = 1, .max = 1e6}), "must be in [1, 1000000]");
  EXPECT_EQ(range_rule({.name = "step", .min = 1e-6, .max = 0.5}), "must be in [1e-06, 0.5]");
}

/// Returns the message of the validation; "accepted" if the options are valid.
template <class Options>
std::string validation_error(const Options& options, int inputs) {
  return message_of([&] { validate_options(options, "sample", inputs); });
}

struct ListOptions {
  int samples = 5000000;
  PerInput shares = {0.1, 0.2, 0.3};
};

template <class Options, class Visit>
requires is_options_of<Options, ListOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.samples, {"samples", "", "", 1, 4194304});
  visit(o.shares, {"shares", "", "", 0, 1, "", true});
}

TEST(OptionAccess, ValidationWritesWholeNumbersOut) {
  EXPECT_EQ(validation_error(ListOptions{}, 0), "sample.samples: 5000000 must be in [1, 4194304]");
}

TEST(OptionAccess, AListMayHaveAnyCount) {
  ListOptions o{.samples = 1};
  EXPECT_EQ(validation_error(o, 2), "accepted");
  o.shares = std::vector<double>{};
  EXPECT_EQ(validation_error(o, 2), "sample.shares: has 0 values, must have one or more");
  SampleOptions per_input{.spread = {0.1, 0.2, 0.3}};
  EXPECT_EQ(validation_error(per_input, 2),
            "sample.spread: has 3 values, must have one for all inputs, or one for each of the 2");
}

TEST(OptionAccess, ListsValuesThatReadBack) {
  SampleOptions o{.gain = 0.1 + 0.2};
  SampleOptions copy;
  const auto entries = list_options(o);
  ASSERT_EQ(entries.size(), 6u);
  for (const OptionEntry& entry : entries) set_option(copy, entry.declaration.name, to_text(entry.value));
  EXPECT_EQ(copy.gain, o.gain);
  EXPECT_EQ(copy.spread, o.spread);
  EXPECT_EQ(std::string(type_name(entries[0])), "flag");
  EXPECT_EQ(std::string(type_name(entries[4])), "numbers");
  EXPECT_EQ(entries[5].choices, (std::vector<std::string>{"calm", "wild"}));
  EXPECT_EQ(to_text(entries[4].value), "[0.1, 0.2]");
}

TEST(OptionAccess, MessagesAreCutBetweenCharacters) {
  EXPECT_EQ(shortened("short"), "short");
  std::string text(3000, 'x');
  for (std::size_t i = 0; i + 2 < text.size(); i += 3) text.replace(i, 3, "\u20ac");
  const std::string cut = shortened("a" + text + "b");
  EXPECT_EQ(cut, "a" + text.substr(0, 489) + " ... " + text.substr(0, 489) + "b");
}

TEST(OptionAccess, SuggestsSimilarNames) {
  const std::vector<std::string> names = {"samples", "temperature", "variance"};
  EXPECT_EQ(nearest_name("sampels", names), "samples");
  EXPECT_EQ(nearest_name("temprature", names), "temperature");
  EXPECT_EQ(nearest_name("colour", names), "");
}

TEST(ThreadPool, RunsEveryTaskOnceEachTime) {
  for (const int threads : {1, 2, 7}) {
    ThreadPool pool(threads);
    for (int round = 0; round < 2000; ++round) {
      const int count = round % 13;
      std::vector<std::atomic<int>> runs(13);
      pool.run(count, [&](int i) { ++runs[i]; });
      for (int i = 0; i < 13; ++i) ASSERT_EQ(runs[i], i < count ? 1 : 0);
    }
  }
}

TEST(ThreadPool, RunsAnyNumberOfTasks) {
  ThreadPool pool(3);
  for (const int count : {65534, 65535, 65536, 200001}) {
    std::vector<int> runs(count);
    pool.run(count, [&](int i) { ++runs[i]; });
    for (const int each : runs) ASSERT_EQ(each, 1);
  }
}

TEST(ThreadPool, AThreadTakesTasksOfAnotherOneThatIsBusy) {
  ThreadPool pool(2);
  constexpr int count = 6;
  std::atomic<int> ended{0};
  pool.run(count, [&](int i) {
    if (i == 0) {  // the caller's first task ends after all others, two of which are the caller's too
      while (ended.load() < count - 1) std::this_thread::yield();
    } else {
      for (volatile int work = 0; work < 300000;) work = work + 1;  // long enough to be worth a move
    }
    ++ended;
  });
  EXPECT_EQ(ended.load(), count);
}

TEST(ThreadPool, ServesSeveralCallersAtOnce) {
  ThreadPool pool(3);
  std::vector<std::thread> callers;
  std::atomic<int> wrong{0};
  for (int caller = 0; caller < 4; ++caller)
    callers.emplace_back([&] {
      for (int round = 0; round < 500; ++round) {
        std::atomic<int> sum{0};
        pool.run(9, [&](int i) { pool.run(2, [&](int) { sum += i; }); });  // a task may call, too
        wrong += sum.load() != 72;
      }
    });
  for (std::thread& caller : callers) caller.join();
  EXPECT_EQ(wrong.load(), 0);
}

TEST(ThreadPool, SleepingWorkersWake) {
  ThreadPool pool(3);
  for (int round = 0; round < 20; ++round) {
    std::atomic<int> sum{0};
    pool.run(8, [&](int i) { sum += i; });
    ASSERT_EQ(sum, 28);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

long voluntary_switches() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_nvcsw;
}

/// Counts how often threads went to sleep in some rounds with a pause after each.
long sleeps(ThreadPool& pool, int rounds, std::chrono::microseconds pause) {
  const long before = voluntary_switches();
  for (int round = 0; round < rounds; ++round) {
    pool.run(4 * pool.threads(), [](int) {  // longer together than anyone spins
      const auto until = std::chrono::steady_clock::now() + std::chrono::microseconds(30);
      while (std::chrono::steady_clock::now() < until) {
      }
    });
    std::this_thread::sleep_for(pause);  // workers go to sleep
  }
  return voluntary_switches() - before;
}

TEST(ThreadPool, AThreadSleepsAtMostOnceARound) {
  constexpr int rounds = 50;
  ThreadPool pool(3);
  long most = 0;
  // On a busy machine a worker may have to wait for its turn before it can as much as go to sleep.
  for (int pause = 200; pause <= 51200 && most < 2 * rounds; pause *= 4) {
    most = sleeps(pool, rounds, std::chrono::microseconds(pause));
    EXPECT_LE(most, (pool.threads() + 1) * rounds);  // the caller sleeps once more, between the rounds
  }
  EXPECT_GE(most, 2 * rounds) << "nobody slept: nothing was measured";
}

TEST(ThreadPool, RejectsInvalidSizes) {
  EXPECT_THROW(ThreadPool(0), std::invalid_argument);
  EXPECT_THROW(ThreadPool(-3), std::invalid_argument);
}

}  // namespace

}  // namespace slalom
