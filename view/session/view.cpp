#include "slalom/view/serve.hpp"
#include "view/embedded.hpp"
#include "view/server/server.hpp"
#include "view/session/session.hpp"

namespace slalom::view {
namespace {

ServerOptions server_options(const ServeOptions& given) {
  if (given.token.empty() && !is_loopback(given.host))
    throw std::invalid_argument("token: must be given where other machines can reach host " + given.host);
  return {.host = given.host, .port = given.port, .ports = 10, .token = given.token, .framed_by = notebooks};
}

}  // namespace

void print_address(const std::string& address) {
  std::printf("%s\nopen this address in a browser; Ctrl-C ends\n", address.c_str());
  std::fflush(stdout);
}

struct View::Implementation {
  Implementation(std::unique_ptr<Subject> subject, const ServeOptions& options)
      : server(server_options(options), {{"/", {"text/html; charset=utf-8", page_html(), page_gzip()}}}),
        session((subject->restart(), std::move(subject)), server, {.against = options.against}) {
    address = address_of(server, server_options(options));
    if (options.ready) options.ready(address);
  }
  Server server;
  Session session;
  std::string address;
};

View::View(std::unique_ptr<Subject> subject, const ServeOptions& options)
    : implementation_(std::make_unique<Implementation>(std::move(subject), options)) {}
View::~View() = default;

const std::string& View::address() const noexcept {
  return implementation_->address;
}

void View::turn(std::chrono::nanoseconds at_most) {
  implementation_->session.turn(at_most);
}

}  // namespace slalom::view
