#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "slalom/solvers/solver_options.hpp"
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
/// Returns the ratio of simulated to real time of a command: 0, or in [0.001, 100].
double rate(const nlohmann::ordered_json& command);
/// Returns the number of steps of a command, at most `max_steps`.
int steps(const nlohmann::ordered_json& command);
constexpr int max_steps = 400;
/// Throws std::invalid_argument for options with more samples times steps than a page can wait for: 2^22 take
/// about 0.05 s.
void check_samples(const SolverOptions& options);

}  // namespace field

/// The pages that are open: one drives, the others watch and can take over.
class Audience {
 public:
  using Json = nlohmann::ordered_json;
  using Obey = std::function<void(std::uint64_t client, const std::string& what, const Json& command)>;

  explicit Audience(Server& server) : server_(server) {}

  void take_over(std::uint64_t client);
  /// Throws std::invalid_argument unless the client drives.
  void require_driver(std::uint64_t client) const;

  /// Sends a message to one client, or to all with 0.
  void tell(std::uint64_t client, const Json& message);
  void tell_text(std::uint64_t client, std::string text);
  /// Executes what has come: a page that is opened by `open`, a command by `obey`. A command is answered by
  /// an error with the reason, and by `done` if it has an `id`. Of a drag, only the last step is executed.
  /// The first client drives; if it leaves, the one that has watched longest.
  void turn(const std::function<void(std::uint64_t client)>& open, const Obey& obey);
  std::uint64_t refused() const noexcept { return refused_; }  ///< messages that were not valid commands

 private:
  void leave(std::uint64_t client);
  void tell_roles();
  void execute(const Received& message, const Obey& obey);

  Server& server_;
  std::vector<std::uint64_t> clients_;  ///< by age
  std::uint64_t driving_client_ = 0;    ///< 0 if there is no client
  std::uint64_t refused_ = 0;
};

}  // namespace slalom::view
