#include "view/server/clients.hpp"

#include <utility>

namespace slalom::view {

void Clients::add(std::uint64_t id, std::shared_ptr<Client> client) {
  clients_.emplace(id, std::move(client));
  size_ = static_cast<int>(clients_.size());
}

void Clients::remove(std::uint64_t id) {
  clients_.erase(id);
  size_ = static_cast<int>(clients_.size());
}

void Clients::clear() {
  clients_.clear();
  size_ = 0;
}

void Clients::send(std::uint64_t id, const Message& message) {
  const auto found = clients_.find(id);
  if (found == clients_.end()) return;
  const auto client = found->second;  // sending may remove it
  client->send(message);
}

void Clients::broadcast(const Message& message) {
  const auto all = clients_;  // sending may remove a client
  for (const auto& [id, client] : all) client->send(message);
}

void Clients::offer(const std::shared_ptr<const std::string>& frame) {
  const auto all = clients_;
  for (const auto& [id, client] : all) client->offer(frame);
}

void Clients::offer(std::uint64_t id, const std::shared_ptr<const std::string>& frame) {
  const auto found = clients_.find(id);
  if (found == clients_.end()) return;
  const auto client = found->second;
  client->offer(frame);
}

}  // namespace slalom::view
