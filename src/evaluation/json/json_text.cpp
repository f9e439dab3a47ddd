// JSON as text. Numbers and texts are written and read by nlohmann/json. Its containers are not used: their
// destructors allocate, which ends the program where memory has run out.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>
#include <utility>

#include "slalom/evaluation/json.hpp"

namespace slalom {

struct JsonText {
  using Value = nlohmann::ordered_json;

  /// Appends the text of `json`, which stands `level` levels deep.
  static void write(const Json& json, int indent, int level, std::string& text) {
    if (json.is_array() || json.is_object())
      write_elements(json, indent, level, text);
    else
      text += scalar(json).dump(-1, ' ', false, Value::error_handler_t::replace);
  }

  static Json& append(Json& object, std::string key) { return object.append(std::move(key), nullptr); }

  /// Throws JsonError where two members of an object have the same key. To look for each key when it is read
  /// would take time that grows with the square of their number.
  static void check_keys(const Json& object) {
    const std::vector<std::string>& keys = object.keys_;
    std::vector<std::size_t> order(keys.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return keys[a] < keys[b]; });
    const auto twice = std::adjacent_find(order.begin(), order.end(),
                                          [&](std::size_t a, std::size_t b) { return keys[a] == keys[b]; });
    if (twice != order.end()) throw JsonError("duplicate key '" + keys[*twice] + "'");
  }

 private:
  static Value scalar(const Json& json) {
    switch (json.type_) {
      case Json::Type::boolean:
        return json.boolean_;
      case Json::Type::integer:
        return json.integer_;
      case Json::Type::natural:
        return json.natural_;
      case Json::Type::real:
        return json.real_;
      case Json::Type::text:
        return json.text_;
      default:
        return nullptr;
    }
  }

  static void write_elements(const Json& json, int indent, int level, std::string& text) {
    const auto begin_line = [&](int at) {
      if (indent < 0) return;
      text += '\n';
      text.append(static_cast<std::size_t>(indent * at), ' ');
    };
    const bool has_keys = json.is_object();
    text += has_keys ? '{' : '[';
    for (std::size_t i = 0; i < json.size(); ++i) {
      if (i > 0) text += ',';
      begin_line(level + 1);
      if (has_keys) {
        text += Value(json.keys_[i]).dump(-1, ' ', false, Value::error_handler_t::replace);
        text += indent < 0 ? ":" : ": ";
      }
      write(json.values_[i], indent, level + 1, text);
    }
    if (!json.empty()) begin_line(level);
    text += has_keys ? '}' : ']';
  }
};

namespace {

/// Makes a value of the events of nlohmann's parser, which calls these functions.
class JsonReader {
 public:
  using Value = JsonText::Value;

  Json result() && { return std::move(root_); }

  bool null() { return add(nullptr); }
  bool boolean(bool value) { return add(value); }
  bool number_integer(Value::number_integer_t value) { return add(value); }
  bool number_unsigned(Value::number_unsigned_t value) { return add(value); }
  bool number_float(Value::number_float_t value, const std::string&) { return add(value); }
  bool string(std::string& value) { return add(std::move(value)); }
  bool binary(Value::binary_t&) { return false; }  // text has none
  bool key(std::string& name) {
    key_ = std::move(name);
    return true;
  }
  bool start_object(std::size_t) { return open(Json::object()); }
  bool start_array(std::size_t) { return open(Json::array()); }
  bool end_object() { return close(); }
  bool end_array() { return close(); }
  bool parse_error(std::size_t, const std::string&, const nlohmann::json::exception& error) {
    // The library's messages begin with its name in brackets, which says nothing to a user.
    const std::string message = error.what();
    const auto end = message.find("] ");
    throw JsonError("is not JSON: " + (end == std::string::npos ? message : message.substr(end + 2)));
  }

 private:
  bool add(Json value) {
    place() = std::move(value);
    return true;
  }

  bool open(Json container) {
    if (open_.size() == static_cast<std::size_t>(Json::deepest))
      throw JsonError("must not nest deeper than " + std::to_string(Json::deepest) + " levels");
    Json& at = place();
    at = std::move(container);
    open_.push_back(&at);
    return true;
  }

  bool close() {
    JsonText::check_keys(*open_.back());
    open_.pop_back();
    return true;
  }

  /// Where the next value goes.
  Json& place() {
    if (++values_ > Json::max_values)
      throw JsonError("must not have more than " + std::to_string(Json::max_values) + " values");
    if (open_.empty()) return root_;
    Json& container = *open_.back();
    if (container.is_object()) return JsonText::append(container, std::move(key_));
    container.push_back(nullptr);
    return container[container.size() - 1];
  }

  Json root_;
  std::vector<Json*> open_;  ///< containers that have not ended, from the outermost
  std::string key_;          ///< key of the next member
  std::size_t values_ = 0;   ///< that were read
};

}  // namespace

Json Json::parse(std::string_view text) {
  JsonReader reader;
  JsonText::Value::sax_parse(text, &reader);
  return std::move(reader).result();
}

Json Json::parse_or_null(std::string_view text) {
  try {
    return parse(text);
  } catch (const JsonError&) {
    return {};
  }
}

std::string Json::dump(int indent) const {
  std::string text;
  JsonText::write(*this, indent, 0, text);
  return text;
}

}  // namespace slalom
