// JSON that is read from files: limits, and errors that name the key.
#include "json/json.hpp"

#include "support/thrown_words.hpp"

namespace slalom {
namespace {

TEST(Json, ErrorsSayWhereTheTextIsWrong) {
  const std::string error = message_of([] { parse_json("{\n\"a\": ]"); });
  EXPECT_EQ(error.rfind("is not JSON: parse error at line 2, column 6", 0), 0u) << error;
  EXPECT_THROW(parse_json(std::string(100000, '[')), std::invalid_argument);
  EXPECT_TRUE(parse_json_or_null("{").is_null());
  EXPECT_TRUE(parse_json(std::string(64, '[') + std::string(64, ']')).is_array());
}

TEST(Json, MembersAreCheckedAndErrorsNameTheKey) {
  const Json json = parse_json(R"({"large": 4294967298, "half": 2.5, "less": -1, "text": "a"})");
  EXPECT_EQ(member<std::uint64_t>(json, "large"), 4294967298U);
  EXPECT_EQ(member<int>(json, "less"), -1);
  EXPECT_DOUBLE_EQ(member<double>(json, "less"), -1);
  EXPECT_EQ(member<std::string>(json, "text"), "a");
  EXPECT_EQ(message_of([&] { member<int>(json, "none"); }), "key 'none' is missing");
  EXPECT_EQ(message_of([&] { member<double>(json, "text"); }), "key 'text': \"a\" must be a number");
  for (const char* key : {"large", "half", "text"})
    EXPECT_THROW(member<int>(json, key), std::invalid_argument) << key;
  EXPECT_THROW(member<std::uint64_t>(json, "less"), std::invalid_argument);
  EXPECT_THROW(member<int>(Json::array(), "large"), std::invalid_argument);
}

TEST(Json, BytesThatAreNotUtf8AreReplaced) {
  EXPECT_EQ(json_text("a\xff"), "\"a\xEF\xBF\xBD\"");
}

}  // namespace
}  // namespace slalom
