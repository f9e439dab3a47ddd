#include "slalom/maps/yaml_text.hpp"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <charconv>
#include <cmath>
#include <sstream>

#include "slalom/core/error.hpp"
#include "slalom/core/read_file.hpp"

namespace slalom::maps {
namespace {

/// Refuses texts that yaml-cpp would follow without end, before any node is made: aliases, deep nesting, and
/// further documents, of which some texts have infinitely many for yaml-cpp.
class Limiter final : public YAML::EventHandler {
 public:
  explicit Limiter(const std::string& file) : file_(file) {}

  void OnDocumentStart(const YAML::Mark& at) override {
    if (++documents_ > 2) refuse_document(at);
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& at, YAML::anchor_t anchor) override { check(at, anchor); }
  void OnAlias(const YAML::Mark& at, YAML::anchor_t) override { refuse_alias(at); }
  void OnScalar(const YAML::Mark& at, const std::string&, YAML::anchor_t anchor,
                const std::string&) override {
    check(at, anchor);
  }
  void OnSequenceStart(const YAML::Mark& at, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    enter(at, anchor);
  }
  void OnSequenceEnd() override { --depth_; }
  void OnMapStart(const YAML::Mark& at, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    enter(at, anchor);
  }
  void OnMapEnd() override { --depth_; }

 private:
  [[noreturn]] void fail(const YAML::Mark& at, const std::string& rule) const {
    throw IoError(file_, at.line + 1, rule);
  }
  [[noreturn]] void refuse_alias(const YAML::Mark& at) const {
    fail(at, "must not have anchors and aliases (& and *): write the value out");
  }
  [[noreturn]] void refuse_document(const YAML::Mark& at) const {
    fail(at, "must have only one YAML document, this is a second one");
  }
  /// Checks a node. A second document is reported at its first node.
  void check(const YAML::Mark& at, YAML::anchor_t anchor) const {
    if (documents_ > 1) refuse_document(at);
    if (anchor != 0) refuse_alias(at);
  }
  void enter(const YAML::Mark& at, YAML::anchor_t anchor) {
    check(at, anchor);
    if (++depth_ > YamlLimits::depth)
      fail(at, "must not nest deeper than " + std::to_string(YamlLimits::depth) + " levels");
  }

  const std::string& file_;
  int documents_ = 0, depth_ = 0;
};

/// A hint for a line that a tab indents, which yaml-cpp does not give.
std::string tab_hint(const std::string& text, int line) {
  std::istringstream stream(text);
  std::string found;
  for (int number = 0; number < line && std::getline(stream, found);) ++number;
  const bool indents = found.substr(0, found.find_first_not_of(" \t")).find('\t') != std::string::npos;
  return indents ? "; the line begins with a tab, but YAML must be indented with spaces" : "";
}

}  // namespace

std::string yaml_text(const std::filesystem::path& file) {
  const std::string text = read_file(file, YamlLimits::bytes), name = file.string();
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    Limiter limiter(name);
    while (parser.HandleNextDocument(limiter)) {
    }
    YAML::Load(text);  // finds the errors that only building the nodes shows
  } catch (const YAML::Exception& error) {
    const int line = error.mark.line + 1;
    throw IoError(name, line, "is not YAML: " + error.msg + tab_hint(text, line));
  }
  return text;
}

std::optional<double> finite_number(std::string_view text) noexcept {
  if (text.size() > 1 && text.front() == '+') text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc{} && end == text.data() + text.size();
  if (!whole || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace slalom::maps
