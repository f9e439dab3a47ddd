#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "view/session/session.hpp"

#include "src/evaluation/json.hpp"
#include "view/session/command_fields.hpp"

/// Which commands wait, so that none delays those of other clients.
namespace slalom::view {
namespace {

constexpr std::size_t max_deferred = 256;  // commands of a client that wait

// Commands that continue from the tick that is shown, which must be driven again if it is a past one.
constexpr std::string_view continuing[] = {"step",   "play",          "add",    "move", "remove",
                                           "nudge",  "place_car",     "set",    "undo", "redo",
                                           "preset", "reset_options", "method", "fork", "ghost"};
// Commands that create a controller or load a course: one of each client in a turn.
constexpr std::string_view costly[] = {"scenario", "restart", "lap",  "set",   "undo",         "redo",
                                       "preset",   "method",  "fork", "ghost", "reset_options"};

bool is_among(const auto& names, const std::string& name) {
  return std::find(std::begin(names), std::end(names), name) != std::end(names);
}

/// The text of a field; empty if it is missing or no text.
std::string text_or_empty(const Json& command, const char* key) {
  const auto found = command.find(key);
  return found != command.end() && found->is_string() ? found->get<std::string>() : std::string();
}

/// The identifier to be repeated in the answer; null if the command has none.
Json id_of(const Json& command) {
  const auto given = command.find("id");
  return given != command.end() && given->is_number_integer() ? *given : Json();
}

/// Whether a newer command of the same client makes a waiting one void: it shows another tick or another
/// drive.
bool replaces(const std::string& newer, const Redrive& waiting) {
  if (newer == "seek" || newer == "lap") return waiting.is_lap || waiting.view >= 0;
  return waiting.is_lap && (newer == "scenario" || newer == "restart");
}

}  // namespace

/// Handles what has come. The commands of a client are handled in their order: while its steps are driven, or
/// ticks are driven again for one of its commands, its further ones wait. Those of other clients do not.
void Session::handle_all() {
  std::vector<Received> all = std::exchange(deferred_, {});
  const std::size_t known = all.size();
  for (Received& each : server_.take()) all.push_back(std::move(each));
  served_.clear();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].kind == Received::Kind::left) forget(all[i].client);
    if (i >= known) cancel_replaced(all[i]);
    if (must_wait(all[i]))
      defer(std::move(all[i]));
    else
      handle(all[i]);
  }
}

bool Session::must_wait(const Received& received) const {
  if (received.kind != Received::Kind::message) return false;
  const std::uint64_t client = received.client;
  return (steps_left_ > 0 && client == stepping_client_) ||
         std::ranges::any_of(redrives_,
                             [&](const Redrive& each) { return each.received.client == client; }) ||
         std::ranges::any_of(deferred_, [&](const Received& each) { return each.client == client; }) ||
         std::ranges::find(served_, client) != served_.end();
}

void Session::defer(Received received) {
  const auto waiting = std::ranges::count(deferred_, received.client, &Received::client);
  if (static_cast<std::size_t>(waiting) < max_deferred) return deferred_.push_back(std::move(received));
  ++refused_;
  refuse(received.client, "too many commands wait for those before them");
}

/// Nothing waits any more for a client that has left.
void Session::forget(std::uint64_t client) {
  if (client == stepping_client_) steps_left_ = 0;
  std::erase_if(redrives_, [&](const Redrive& each) { return each.received.client == client; });
  std::erase_if(deferred_, [&](const Received& each) { return each.client == client; });
}

/// Cancels the waiting commands of a client that its newer command makes void.
void Session::cancel_replaced(const Received& newer) {
  const auto waiting = std::ranges::find_if(
      redrives_, [&](const Redrive& each) { return each.received.client == newer.client; });
  if (newer.kind != Received::Kind::message || waiting == redrives_.end()) return;
  const std::string what = text_or_empty(parse_json_or_null(newer.text), "do");
  if (!replaces(what, *waiting)) return;
  std::vector<Received> cancelled{std::move(waiting->received)};
  redrives_.erase(waiting);
  for (const Received& each : deferred_)
    if (each.client == newer.client) cancelled.push_back(each);
  std::erase_if(deferred_, [&](const Received& each) { return each.client == newer.client; });
  for (const Received& each : cancelled) {
    const Json command = parse_json_or_null(each.text);
    refuse(each.client,
           text_or_empty(command, "do").substr(0, 40) + ": cancelled, since '" + what +
               "' came before it was executed",
           id_of(command));
  }
}

void Session::handle(const Received& received) {
  if (received.kind == Received::Kind::joined) return greet(received.client);
  if (received.kind == Received::Kind::left) {
    state_changed_ = true;
    return;
  }
  const Json command = parse_json_or_null(received.text);
  if (!command.is_object()) {
    ++refused_;
    return refuse(received.client, "a command must be a JSON object");
  }
  const std::string what = text_or_empty(command, "do");
  if (is_among(costly, what)) served_.push_back(received.client);
  Redrive redrive = redrive_for(received, what, command);
  if (redrive.view >= 0 || redrive.copies || redrive.is_lap)
    redrives_.push_back(std::move(redrive));
  else
    execute(received.client, command);
}

/// What a command needs to be driven again. Fields that are wrong are reported when the command is executed.
Redrive Session::redrive_for(const Received& received, const std::string& what, const Json& command) const {
  Redrive redrive{.received = received};
  if (is_among(continuing, what)) redrive.view = viewed_;
  redrive.copies = simulation_->ticks() > 0 &&
                   (what == "fork" || (what == "ghost" && !text_or_empty(command, "method").empty()));
  const auto contact = what == "lap" && options_.load_lap ? command.find("contact") : command.end();
  redrive.is_lap = contact != command.end() && contact->is_number() && contact->get<double>() >= 0;
  return redrive;
}

/// Drives again a few ticks for the command that has waited longest, and executes it once it has what it
/// needs.
void Session::drive_again() {
  if (redrives_.empty()) return;
  Redrive& first = redrives_.front();
  const std::uint64_t client = first.received.client;
  RedriveBudget budget;
  bool is_ready = false;
  const Json command = parse_json_or_null(first.received.text);
  const bool is_valid = attempt(client, command, [&] {
    if (first.is_lap && !first.search) search_contact(first, command);
    is_ready = first.advance(*simulation_, ghost_ ? &*ghost_ : nullptr, budget);
  });
  redriven_ += static_cast<std::uint64_t>(budget.taken());
  if (is_valid && !is_ready) return;
  prepared_ = std::move(first);
  redrives_.pop_front();
  if (is_valid) execute_prepared();
  prepared_.reset();
}

/// Executes the command for which everything has been driven. It continues from the tick that was shown when
/// it came, whatever another client has shown since.
void Session::execute_prepared() {
  const Redrive& prepared = prepared_.value();
  const int shown = viewed_;
  if (!prepared.is_lap) viewed_ = prepared.view;
  const bool is_done = execute(prepared.received.client, parse_json_or_null(prepared.received.text));
  if (prepared.is_lap || viewed_ != prepared.view) return;
  if (!is_done) {
    viewed_ = shown;
  } else if (shown >= 0) {  // the command continued from the newest tick, which is not the one on the screens
    is_newest_sent_ = false;
    publish_newest();
  }
}

/// Calls `action` and answers the client if it throws. False then.
bool Session::attempt(std::uint64_t client, const Json& command, const std::function<void()>& action) {
  try {
    action();
    return true;
  } catch (const MalformedCommand& error) {
    ++refused_;
    refuse(client, error.what(), id_of(command));
  } catch (const std::exception& error) {
    refuse(client, error.what(), id_of(command));
  }
  return false;
}

bool Session::execute(std::uint64_t client, const Json& command) {
  return attempt(client, command, [&] {
    obey(client, command);
    const Json id = id_of(command);
    if (!id.is_null()) tell_done(client, id);
  });
}

}  // namespace slalom::view
