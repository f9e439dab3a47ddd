#include "slalom/evaluation/json.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace slalom {

namespace {

template <class T>
std::vector<Json> elements_of(const std::vector<T>& values) {
  return {values.begin(), values.end()};
}

}  // namespace

/// Numbers of any type, and paths to values.
struct JsonValues {
  static bool equal_numbers(const Json& a, const Json& b) {
    using Type = Json::Type;
    if (a.type_ == Type::real || b.type_ == Type::real) return a.get<double>() == b.get<double>();
    if (a.type_ == Type::integer && a.integer_ < 0)
      return b.type_ == Type::integer && a.integer_ == b.integer_;
    if (b.type_ == Type::integer && b.integer_ < 0) return false;
    return number<std::uint64_t>(a) == number<std::uint64_t>(b);
  }

  /// A whole number that `Number` can hold.
  template <class Number>
  static Number whole(const Json& json) {
    using Type = Json::Type;
    const bool fits = json.type_ == Type::integer   ? std::in_range<Number>(json.integer_)
                      : json.type_ == Type::natural ? std::in_range<Number>(json.natural_)
                      : json.type_ == Type::real
                          ? json.real_ == std::trunc(json.real_) && std::abs(json.real_) <= 0x1p53 &&
                                std::in_range<Number>(static_cast<std::int64_t>(json.real_))
                          : throw JsonError("must be a number");
    if (!fits)
      throw JsonError(json.dump() + " must be a whole number in [" +
                      std::to_string(std::numeric_limits<Number>::min()) + ", " +
                      std::to_string(std::numeric_limits<Number>::max()) + "]");
    return number<Number>(json);
  }

  template <class Number>
  static Number number(const Json& json) {
    switch (json.type_) {
      case Json::Type::integer:
        return static_cast<Number>(json.integer_);
      case Json::Type::natural:
        return static_cast<Number>(json.natural_);
      case Json::Type::real:
        return static_cast<Number>(json.real_);
      default:
        throw JsonError("must be a number");
    }
  }

  static void flatten(const std::string& path, const Json& json, Json& all) {
    if (json.empty()) {
      all.append(path, json);
    } else if (json.is_array()) {
      for (std::size_t i = 0; i < json.size(); ++i) flatten(path + "/" + std::to_string(i), json[i], all);
    } else {
      for (const auto& [key, value] : json.items()) flatten(path + "/" + key, value, all);
    }
  }
};

Json::Json(const Json&) = default;
Json::Json(Json&&) noexcept = default;
Json& Json::operator=(const Json&) = default;
Json& Json::operator=(Json&&) noexcept = default;
Json::~Json() = default;

Json::Json(Signed number) : type_(Type::integer), integer_(number.value) {}
Json::Json(Unsigned number) : type_(Type::natural), natural_(number.value) {}
Json::Json(double value) : type_(Type::real), real_(value) {}
Json::Json(const char* value) : Json(std::string(value)) {}
Json::Json(std::string value) : type_(Type::text), text_(std::move(value)) {}
Json::Json(std::vector<Json> values) : type_(Type::array), values_(std::move(values)) {}
Json::Json(const std::vector<std::string>& values) : Json(elements_of(values)) {}
Json::Json(const std::vector<double>& values) : Json(elements_of(values)) {}
Json::Json(const std::vector<int>& values) : Json(elements_of(values)) {}

Json::Json(std::initializer_list<Json> elements) {
  const bool all_members = std::all_of(elements.begin(), elements.end(), [](const Json& each) {
    return each.is_array() && each.size() == 2 && each[0].is_string();
  });
  type_ = all_members ? Type::object : Type::array;
  for (const Json& each : elements) {
    if (all_members)
      (*this)[each.values_[0].text_] = each.values_[1];
    else
      values_.push_back(each);
  }
}

Json Json::array() {
  return std::vector<Json>{};
}

Json Json::array(std::initializer_list<Json> elements) {
  return std::vector<Json>(elements);
}

Json Json::object() {
  Json made;
  made.type_ = Type::object;
  return made;
}

template <>
bool Json::get<bool>() const {
  if (!is_boolean()) throw JsonError("must be true or false");
  return boolean_;
}

template <>
int Json::get<int>() const {
  return JsonValues::whole<int>(*this);
}

template <>
std::uint64_t Json::get<std::uint64_t>() const {
  return JsonValues::whole<std::uint64_t>(*this);
}

template <>
double Json::get<double>() const {
  return JsonValues::number<double>(*this);
}

template <>
std::string Json::get<std::string>() const {
  if (!is_string()) throw JsonError("must be a string");
  return text_;
}

void Json::push_back(Json value) {
  if (is_null()) type_ = Type::array;
  if (!is_array()) throw JsonError("must be an array to append to it");
  values_.push_back(std::move(value));
}

const Json& Json::operator[](std::size_t index) const {
  if (!is_array() || index >= values_.size())
    throw JsonError("element " + std::to_string(index) + " is missing");
  return values_[index];
}

Json& Json::operator[](std::size_t index) {
  return const_cast<Json&>(std::as_const(*this)[index]);
}

Json& Json::operator[](const std::string& key) {
  if (is_null()) type_ = Type::object;
  if (!is_object()) throw JsonError("must be an object to have a key '" + key + "'");
  const auto found = std::find(keys_.begin(), keys_.end(), key);
  if (found != keys_.end()) return values_[static_cast<std::size_t>(found - keys_.begin())];
  return append(key, nullptr);
}

Json& Json::append(std::string key, Json value) {
  // If memory runs out, there is neither a key without a value nor a value without a key.
  if (values_.size() == values_.capacity()) values_.reserve(2 * values_.size() + 1);
  keys_.push_back(std::move(key));
  return values_.emplace_back(std::move(value));
}

const Json* Json::find(std::string_view key) const noexcept {
  const auto found = std::find(keys_.begin(), keys_.end(), key);
  return found == keys_.end() ? nullptr : &values_[static_cast<std::size_t>(found - keys_.begin())];
}

const Json& Json::at(std::string_view key) const {
  const Json* found = find(key);
  if (found == nullptr) throw JsonError("key '" + std::string(key) + "' is missing");
  return *found;
}

std::vector<Json::Member> Json::items() const& {
  if (!is_object()) throw JsonError("must be an object");
  std::vector<Member> all;
  all.reserve(keys_.size());
  for (std::size_t i = 0; i < keys_.size(); ++i) all.push_back({keys_[i], values_[i]});
  return all;
}

void Json::erase(std::string_view key) {
  const auto found = std::find(keys_.begin(), keys_.end(), key);
  if (found == keys_.end()) return;
  values_.erase(values_.begin() + (found - keys_.begin()));
  keys_.erase(found);
}

void Json::update(const Json& other) {
  for (const auto& [key, value] : other.items()) (*this)[key] = value;
}

Json Json::flatten() const {
  Json all = object();
  JsonValues::flatten("", *this, all);
  return all;
}

bool operator==(const Json& a, const Json& b) {
  if (a.is_number() && b.is_number()) return JsonValues::equal_numbers(a, b);
  if (a.type_ != b.type_) return false;
  if (a.is_boolean()) return a.boolean_ == b.boolean_;
  return a.text_ == b.text_ && a.keys_ == b.keys_ && a.values_ == b.values_;
}

}  // namespace slalom
