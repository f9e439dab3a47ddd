// Options by name and as text: every type, every refusal with its value and rule.
#include "slalom/core/option_access.hpp"
#include "slalom/core/error.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace slalom
