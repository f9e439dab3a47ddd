#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "view/server/server.hpp"

namespace slalom::view {

/// A malformed command, in contrast to one that cannot be executed.
struct MalformedCommand : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// Fields of a command. The functions throw MalformedCommand, which names the key, where a field is missing
/// or of another type.
namespace field {

/// Throws unless a rule holds.
void require(bool holds, const char* key, const char* rule);
/// Returns a finite number; `otherwise` if it is missing.
double number(const nlohmann::ordered_json& command, const char* key, std::optional<double> otherwise = {});
/// Returns an integer in [-1e9, 1e9]; `otherwise` if it is missing.
int integer(const nlohmann::ordered_json& command, const char* key, std::optional<int> otherwise = {});
std::string text(const nlohmann::ordered_json& command, const char* key);
bool flag(const nlohmann::ordered_json& command, const char* key);

}  // namespace field

/// The pages that are open: one drives, the others watch and can take over.
class Audience {
 public:
  using Json = nlohmann::ordered_json;

  explicit Audience(Server& server) : server_(server) {}

  /// Adds a client; the first one drives.
  void join(std::uint64_t client);
  /// If the client that drives has left, the one that has watched longest drives.
  void leave(std::uint64_t client);
  void take_over(std::uint64_t client);
  /// Throws std::invalid_argument unless the client drives.
  void require_driver(std::uint64_t client) const;
  /// Tells each client whether it drives or watches.
  void tell_roles();

  /// Sends a message to one client, or to all with 0.
  void tell(std::uint64_t client, const Json& message);
  void tell_text(std::uint64_t client, std::string text);
  /// Executes a command by `obey` and answers it: an error with the reason, and `done` if it has an `id`.
  void execute(std::uint64_t client, const Json& command,
               const std::function<void(const std::string& what)>& obey);
  std::uint64_t refused() const noexcept { return refused_; }  ///< messages that were not valid commands

 private:
  Server& server_;
  std::vector<std::uint64_t> clients_;  ///< by age
  std::uint64_t driving_client_ = 0;    ///< 0 if there is no client
  std::uint64_t refused_ = 0;
};

}  // namespace slalom::view
