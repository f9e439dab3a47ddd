#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

/// JSON for results, settings and messages. The text is written and read with nlohmann/json, which only
/// json_text.cpp includes.
namespace slalom {

/// A text that is not JSON, a value of another type than asked for, or a missing key.
struct JsonError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A JSON value. Objects keep the order in which their members were inserted.
class Json {
 public:
  struct Member;

  /// Null.
  Json() = default;
  /// Null.
  Json(std::nullptr_t) {}
  /// True or false.
  template <std::same_as<bool> T>
  Json(T value) : type_(Type::boolean), boolean_(value) {}
  /// An integer.
  template <std::signed_integral T>
  Json(T value) : Json(Signed{value}) {}
  /// An integer >= 0.
  template <std::unsigned_integral T>
  requires(!std::same_as<T, bool>)  // a bool is unsigned
      Json(T value)
      : Json(Unsigned{value}) {}
  /// A number; infinite values and NaN are written as null.
  Json(double value);
  Json(const char* value);                       ///< a string
  Json(std::string value);                       ///< a string
  Json(const std::vector<std::string>& values);  ///< an array
  Json(const std::vector<double>& values);       ///< an array
  Json(const std::vector<int>& values);          ///< an array
  Json(std::vector<Json> values);                ///< an array
  /// An object if all elements are pairs whose first element is a string; otherwise an array.
  Json(std::initializer_list<Json> elements);
  Json(const Json& other);                 ///< a copy
  Json(Json&& other) noexcept;             ///< the other may then only be destroyed or assigned to
  Json& operator=(const Json& other);      ///< a copy
  Json& operator=(Json&& other) noexcept;  ///< the other may then only be destroyed or assigned to
  ~Json();

  static Json array();                                      ///< an array without elements
  static Json array(std::initializer_list<Json> elements);  ///< an array of these elements
  static Json object();                                     ///< an object without members

  static constexpr int deepest = 64;                      ///< levels of arrays and objects that are parsed
  static constexpr std::size_t max_values = 1U << 20;     ///< that are parsed; each takes about 100 bytes
  static constexpr std::uint64_t max_bytes = 1ULL << 24;  ///< size of a JSON file that is read

  /// Throws JsonError if the text is not JSON, nests deeper than `deepest`, has more than `max_values`
  /// values, or has a key twice in one object.
  static Json parse(std::string_view text);
  /// Null where `parse` throws.
  static Json parse_or_null(std::string_view text);

  /// The text, in one line, or with `indent` spaces per level. Bytes that are not UTF-8 become U+FFFD.
  std::string dump(int indent = -1) const;

  /// Whether the value is null.
  bool is_null() const noexcept { return type_ == Type::null; }
  /// Whether the value is true or false.
  bool is_boolean() const noexcept { return type_ == Type::boolean; }
  /// Whether the value is a number that was written or given as an integer.
  bool is_integer() const noexcept { return type_ == Type::integer || type_ == Type::natural; }
  /// Whether the value is a number.
  bool is_number() const noexcept { return is_integer() || type_ == Type::real; }
  /// Whether the value is a string.
  bool is_string() const noexcept { return type_ == Type::text; }
  /// Whether the value is an array.
  bool is_array() const noexcept { return type_ == Type::array; }
  /// Whether the value is an object.
  bool is_object() const noexcept { return type_ == Type::object; }

  /// The value as bool, int, std::uint64_t, double or std::string. Numbers are converted into each other.
  /// Throws JsonError on a value of another type.
  template <class T>
  T get() const;

  /// Elements of an array or members of an object; 0 for anything else.
  std::size_t size() const noexcept { return values_.size(); }
  /// Whether size() is 0.
  bool empty() const noexcept { return values_.empty(); }
  /// The first element of an array or value of an object.
  std::vector<Json>::const_iterator begin() const noexcept { return values_.begin(); }
  /// Past the last element.
  std::vector<Json>::const_iterator end() const noexcept { return values_.end(); }

  /// Appends to an array; null becomes an array.
  void push_back(Json value);
  /// The element of an array. Throws JsonError where there is none.
  Json& operator[](std::size_t index);
  /// The same.
  const Json& operator[](std::size_t index) const;
  /// The same.
  Json& operator[](int index) { return (*this)[static_cast<std::size_t>(index)]; }
  /// The same.
  const Json& operator[](int index) const { return (*this)[static_cast<std::size_t>(index)]; }

  /// The member of this key. Inserts a null where there is none; null becomes an object.
  Json& operator[](const std::string& key);
  /// The same.
  Json& operator[](const char* key) { return (*this)[std::string(key)]; }
  /// The member of this key. Throws JsonError where there is none.
  const Json& at(std::string_view key) const;
  /// The same as `at`.
  const Json& operator[](const std::string& key) const { return at(key); }
  /// The same as `at`.
  const Json& operator[](const char* key) const { return at(key); }
  /// Null pointer where there is no such member.
  const Json* find(std::string_view key) const noexcept;
  /// Whether there is a member of this key.
  bool contains(std::string_view key) const noexcept { return find(key) != nullptr; }
  /// The members of an object, in order; the references live as long as the object.
  std::vector<Member> items() const&;
  std::vector<Member> items() const&& = delete;
  /// Removes the member of this key, where there is one.
  void erase(std::string_view key);
  /// Inserts the members of another object; those of the same key are replaced.
  void update(const Json& other);
  /// The object with a member for every value below this one; its key is the path, "/a/b/0". Two values have
  /// the same path only where a key contains a slash.
  Json flatten() const;

  /// Numbers are equal if their values are. Objects are equal if their members are, in the same order.
  friend bool operator==(const Json& a, const Json& b);

 private:
  enum class Type { null, boolean, integer, natural, real, text, array, object };
  struct Signed {
    std::int64_t value;
  };
  struct Unsigned {
    std::uint64_t value;
  };
  explicit Json(Signed number);
  explicit Json(Unsigned number);
  /// Appends a member to an object that has none of this key.
  Json& append(std::string key, Json value);
  friend struct JsonText;
  friend struct JsonValues;

  Type type_ = Type::null;
  union {
    bool boolean_;
    std::int64_t integer_;
    std::uint64_t natural_ = 0;
    double real_;
  };
  std::string text_;
  std::vector<std::string> keys_;  ///< keys of an object's members
  std::vector<Json> values_;       ///< values of an array's elements or an object's members
};

/// A member of an object. It refers into the object.
struct Json::Member {
  const std::string& key;  ///< differs from those of the other members
  const Json& value;       ///< value of any type
};

template <>
bool Json::get<bool>() const;
template <>
int Json::get<int>() const;
template <>
std::uint64_t Json::get<std::uint64_t>() const;
template <>
double Json::get<double>() const;
template <>
std::string Json::get<std::string>() const;

}  // namespace slalom
