#include "maps/yaml_file.hpp"

#include <yaml-cpp/eventhandler.h>

#include <set>
#include <sstream>
#include <string_view>

#include "slalom/core/error.hpp"
#include "slalom/core/read_file.hpp"

namespace slalom::maps::detail {
namespace {

/// Refuses what yaml-cpp would follow without end, before any node is made: aliases, deep nesting, and
/// further documents, of which some texts have infinitely many for yaml-cpp.
class Limiter final : public YAML::EventHandler {
 public:
  explicit Limiter(const std::string& file) : file_(file) {}

  void OnDocumentStart(const YAML::Mark& at) override {
    if (++documents_ > 1) fail(at, "must have only one YAML document, this is a second one");
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
  void check(const YAML::Mark& at, YAML::anchor_t anchor) const {
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

/// yaml-cpp accepts duplicate keys and keeps one of them.
void check_repeated_keys(const std::filesystem::path& file, const YAML::Node& map,
                         const std::string& prefix) {
  if (!map.IsMap()) return;
  std::set<std::string> seen;
  for (const auto& entry : map) {
    if (!entry.first.IsScalar()) continue;
    const std::string key = prefix + entry.first.Scalar();
    if (!seen.insert(key).second)
      throw IoError(file.string(), entry.first.Mark().line + 1, "key " + key + ": duplicate key");
    check_repeated_keys(file, entry.second, key + ".");
  }
}

/// yaml-cpp does not mention that a tab must not indent.
std::string tab_hint(const std::string& text, int line) {
  std::istringstream stream(text);
  std::string found;
  for (int number = 0; number < line && std::getline(stream, found);) ++number;
  const bool indents = found.substr(0, found.find_first_not_of(" \t")).find('\t') != std::string::npos;
  return indents ? "; the line begins with a tab, but YAML must be indented with spaces" : "";
}

}  // namespace

YAML::Node load_yaml(const std::filesystem::path& file) {
  const std::string text = read_file(file, YamlLimits::bytes), name = file.string();
  YAML::Node document;
  try {
    std::istringstream checked(text);
    YAML::Parser parser(checked);
    Limiter limiter(name);
    while (parser.HandleNextDocument(limiter)) {
    }
    document = YAML::Load(text);
  } catch (const YAML::Exception& error) {
    const int line = error.mark.line + 1;
    throw IoError(name, line, "is not YAML: " + error.msg + tab_hint(text, line));
  }
  check_repeated_keys(file, document, "");
  return document;
}

void throw_at(const std::filesystem::path& file, const YAML::Node& at, const std::string& key,
              const std::string& rule) {
  const std::string value = at.IsScalar() && !at.Scalar().empty() ? "'" + at.Scalar() + "' " : "";
  throw IoError(file.string(), at.Mark().line + 1, "key " + key + ": " + value + rule);
}

}  // namespace slalom::maps::detail
