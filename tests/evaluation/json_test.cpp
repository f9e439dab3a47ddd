// JSON values: types, text, order, comparison.
#include "slalom/evaluation/json.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

namespace slalom {
namespace {

TEST(Json, WritesWhatItReads) {
  const std::string text =
      R"({"b":[1,-2,18446744073709551615,0.1,1e+300,true,null],"a":{"":"\u0001 \"x\" \\ é"},"c":[],"d":{}})";
  const Json json = Json::parse(text);
  EXPECT_EQ(Json::parse(json.dump()), json);
  EXPECT_EQ(json.dump(), text);
  EXPECT_EQ(json.at("b")[2].get<std::uint64_t>(), std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(json.at("b")[1].get<int>(), -2);
  EXPECT_DOUBLE_EQ(json.at("b")[4].get<double>(), 1e300);
}

TEST(Json, BracesMakeObjectsAndArrays) {
  EXPECT_EQ((Json{{"one", 1}, {"two", {1, 2}}}).dump(), R"({"one":1,"two":[1,2]})");
  EXPECT_EQ((Json{1, "two", 3.0}).dump(), R"([1,"two",3.0])");
  EXPECT_EQ((Json{{"point", {{"x", 1.5}}}}).dump(), R"({"point":{"x":1.5}})");
  EXPECT_EQ(Json(std::vector<std::string>{"a", "b"}).dump(), R"(["a","b"])");
}

TEST(Json, KeepsTheOrderOfMembers) {
  Json json;
  json["z"] = 1;
  json["a"] = 2;
  json["z"] = 3;
  EXPECT_EQ(json.dump(), R"({"z":3,"a":2})");
  json.update({{"a", 5}, {"m", 6}});
  EXPECT_EQ(json.dump(), R"({"z":3,"a":5,"m":6})");
  EXPECT_EQ(json.dump(1), "{\n \"z\": 3,\n \"a\": 5,\n \"m\": 6\n}");
  EXPECT_EQ(Json::parse(R"({"z":[{},[],[3]],"a":2})").dump(1),
            "{\n \"z\": [\n  {},\n  [],\n  [\n   3\n  ]\n ],\n \"a\": 2\n}");
  json.erase("a");
  json.erase("none");
  EXPECT_EQ(json.dump(), R"({"z":3,"m":6})");
}

TEST(Json, AnObjectHasEachKeyOnce) {
  try {
    Json::parse(R"({"a":{"z":1,"y":2,"z":3}})");
    ADD_FAILURE() << "a key that stands twice was read";
  } catch (const JsonError& error) {
    EXPECT_STREQ(error.what(), "duplicate key 'z'");
  }
  EXPECT_EQ(Json::parse(R"([{"z":1},{"z":2}])").size(), 2u);
}

TEST(Json, AnObjectOfAMillionMembersIsReadInSeconds) {
  std::string text = "{";
  for (int i = 0; i < 1000000; ++i) text += (i > 0 ? ",\"" : "\"") + std::to_string(i) + "\":0";
  const Json json = Json::parse(text + "}");
  EXPECT_EQ(json.size(), 1000000u);
  EXPECT_EQ(json.flatten().size(), 1000000u);
}

TEST(Json, RefusesTooManyValues) {
  std::string text = "[0";
  for (std::size_t i = 2; i < Json::max_values; ++i) text += ",0";
  EXPECT_EQ(Json::parse(text + "]").size(), Json::max_values - 1);
  EXPECT_THROW(Json::parse(text + ",0]"), JsonError);
}

TEST(Json, WritesNumbersThatAreNotFiniteAsNull) {
  EXPECT_EQ(Json(std::numeric_limits<double>::infinity()).dump(), "null");
  EXPECT_EQ(Json(std::numeric_limits<double>::quiet_NaN()).dump(), "null");
}

TEST(Json, ReplacesBytesThatAreNotUtf8) {
  EXPECT_EQ(Json("a\xff"
                 "b")
                .dump(),
            "\"a\xEF\xBF\xBD"
            "b\"");
}

TEST(Json, ComparesNumbersByValue) {
  EXPECT_EQ(Json(1), Json(1u));
  EXPECT_EQ(Json(1), Json(1.0));
  EXPECT_NE(Json(-1), Json(std::numeric_limits<std::uint64_t>::max()));
  EXPECT_NE(Json("1"), Json(1));
  EXPECT_NE(Json::parse(R"({"a":1,"b":2})"), Json::parse(R"({"b":2,"a":1})"));
}

TEST(Json, FlattensToPaths) {
  EXPECT_EQ(Json::parse(R"({"a":{"b":[1,2]},"c":3,"d":[]})").flatten().dump(),
            R"({"/a/b/0":1,"/a/b/1":2,"/c":3,"/d":[]})");
}

TEST(Json, RefusesDeepNesting) {
  const auto nested = [](int depth) {
    return std::string(static_cast<std::size_t>(depth), '[') +
           std::string(static_cast<std::size_t>(depth), ']');
  };
  EXPECT_TRUE(Json::parse(nested(64)).is_array());
  EXPECT_THROW(Json::parse(nested(65)), JsonError);
  EXPECT_THROW(Json::parse(nested(1000000)), JsonError);
  EXPECT_TRUE(Json::parse_or_null(nested(1000000)).is_null());
}

TEST(Json, WholeNumbersAreNotCutToFit) {
  const Json json = Json::parse(R"([4294967298, 1e30, 2.5, -1, 7.0, 0, 2147483647])");
  EXPECT_THROW(json[0].get<int>(), JsonError);
  EXPECT_EQ(json[0].get<std::uint64_t>(), 4294967298U);
  for (const std::size_t i : {1, 2}) {
    EXPECT_THROW(json[i].get<int>(), JsonError) << i;
    EXPECT_THROW(json[i].get<std::uint64_t>(), JsonError) << i;
  }
  EXPECT_EQ(json[3].get<int>(), -1);
  EXPECT_THROW(json[3].get<std::uint64_t>(), JsonError);
  EXPECT_EQ(json[4].get<int>(), 7);
  EXPECT_EQ(json[6].get<int>(), 2147483647);
}

TEST(Json, RejectsWrongTypesAndMissingKeys) {
  const Json json = Json::parse(R"({"a":[1],"t":"text"})");
  EXPECT_THROW(json.at("b"), JsonError);
  EXPECT_THROW(json.at("a")[1], JsonError);
  EXPECT_THROW(json.at("t").get<double>(), JsonError);
  EXPECT_THROW(json.at("a").get<std::string>(), JsonError);
  EXPECT_THROW(json.at("a").items(), JsonError);
  EXPECT_THROW(Json::parse("{"), JsonError);
  EXPECT_TRUE(Json::parse_or_null("{").is_null());
  EXPECT_EQ(json.find("b"), nullptr);
}

}  // namespace
}  // namespace slalom
