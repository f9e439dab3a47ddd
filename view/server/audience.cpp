#include "view/server/audience.hpp"

#include <algorithm>

#include "json/json.hpp"

namespace slalom::view {
namespace {

/// Whether a message is a later step of the same drag of a body: only the last one is worth a plan.
bool replaces(const Received& later, const Received& earlier) {
  if (later.kind != Received::Kind::message || earlier.kind != Received::Kind::message ||
      later.client != earlier.client)
    return false;
  const Json a = parse_json_or_null(earlier.text), b = parse_json_or_null(later.text);
  const auto same = [&](const char* key) { return a.contains(key) && b.contains(key) && a[key] == b[key]; };
  if (!a.is_object() || !b.is_object() || a.contains("id") || !same("do")) return false;
  return a["do"] == "place_car" || (a["do"] == "move" && same("body") && same("drag"));
}

}  // namespace

namespace field {

void require(bool holds, const char* key, const char* rule) {
  if (!holds) throw MalformedCommand(std::string(key) + ": must be " + rule);
}

double number(const Json& command, const char* key, std::optional<double> otherwise) {
  if (otherwise && !command.contains(key)) return *otherwise;
  const auto found = command.find(key);
  const bool is_number = found != command.end() && found->is_number();
  require(is_number && std::isfinite(found->get<double>()), key, "a finite number");
  return found->get<double>();
}

int integer(const Json& command, const char* key, std::optional<int> otherwise) {
  const double value = number(command, key, otherwise);
  require(std::floor(value) == value && std::abs(value) <= 1e9, key, "an integer");
  return static_cast<int>(value);
}

std::string text(const Json& command, const char* key) {
  const auto found = command.find(key);
  require(found != command.end() && found->is_string(), key, "text");
  return found->get<std::string>();
}

bool flag(const Json& command, const char* key) {
  const auto found = command.find(key);
  require(found != command.end() && found->is_boolean(), key, "true or false");
  return found->get<bool>();
}

double rate(const Json& command) {
  const double rate = number(command, "rate");
  require(rate == 0 || (rate >= 0.001 && rate <= 100), "rate", "0 for the maximum speed, or in [0.001, 100]");
  return rate;
}

int steps(const Json& command) {
  return std::clamp(integer(command, "ticks", 1), 1, max_steps);
}

void check_samples(const SolverOptions& options) {
  constexpr std::int64_t most = std::int64_t{1} << 22;
  const int* samples = options.find<int>("samples");
  const int* horizon = options.find<int>("horizon");
  if (!samples || !horizon || std::int64_t{*samples} * *horizon <= most) return;
  throw std::invalid_argument("samples: " + std::to_string(*samples) + " must be at most " +
                              std::to_string(most / *horizon) + " in the live view, for " +
                              std::to_string(*horizon) + " steps");
}

}  // namespace field

void Audience::leave(std::uint64_t client) {
  std::erase(clients_, client);
  if (client != driving_client_) return;
  driving_client_ = clients_.empty() ? 0 : clients_.front();
  tell_roles();
}

void Audience::take_over(std::uint64_t client) {
  driving_client_ = client;
  tell_roles();
}

void Audience::require_driver(std::uint64_t client) const {
  if (client != driving_client_)
    throw std::invalid_argument("another page drives this car; take over to change it");
}

/// Tells each client whether it drives or watches.
void Audience::tell_roles() {
  for (const std::uint64_t client : clients_)
    tell(client, {{"type", "role"}, {"drives", client == driving_client_}});
}

void Audience::tell(std::uint64_t client, const Json& message) {
  tell_text(client, json_text(message));
}

void Audience::tell_text(std::uint64_t client, std::string text) {
  server_.send(client, {std::make_shared<const std::string>(std::move(text)), false});
}

void Audience::turn(const std::function<void(std::uint64_t client)>& open, const Obey& obey) {
  const std::vector<Received> received = server_.take();
  for (std::size_t i = 0; i < received.size(); ++i) {
    const Received& each = received[i];
    if (i + 1 < received.size() && replaces(received[i + 1], each)) continue;
    if (each.kind == Received::Kind::joined) {
      clients_.push_back(each.client);
      if (driving_client_ == 0) driving_client_ = each.client;
      open(each.client);
      tell_roles();
    } else if (each.kind == Received::Kind::left) {
      leave(each.client);
    } else {
      execute(each, obey);
    }
  }
}

void Audience::execute(const Received& message, const Obey& obey) {
  const Json command = parse_json_or_null(message.text);
  const auto id = command.find("id");
  const bool has_id = id != command.end() && id->is_number_integer();
  const auto fail = [&](const char* why) {
    Json error = {{"type", "error"}, {"message", why}};
    if (has_id) error["id"] = *id;
    tell(message.client, error);
  };
  try {
    if (!command.is_object()) throw MalformedCommand("a command must be a JSON object");
    obey(message.client, field::text(command, "do"), command);
    if (has_id) tell(message.client, {{"type", "done"}, {"id", *id}});
  } catch (const MalformedCommand& error) {
    ++refused_;
    fail(error.what());
  } catch (const std::exception& error) {
    fail(error.what());
  }
}

}  // namespace slalom::view
