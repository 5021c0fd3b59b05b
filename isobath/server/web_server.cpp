#include <csignal>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/server/http_connection.hpp>
#include <isobath/server/socket_client.hpp>
#include <isobath/server/web_hub.hpp>
#include <isobath/server/web_server.hpp>
#include <map>
#include <memory>
#include <mutex>
#include <netinet/tcp.h>
#include <thread>
#include <utility>
#include <vector>

namespace isobath {

/// Accepts connections for the hub and asks its clients for frames. Destroyed before the hub, whose context ends all.
struct WebServer::State {
  State(const WebServerConfig& config, WebSite site) : hub(config, std::move(site)) {}
  void listen();
  void accept();
  void enter(web::tcp::socket socket);
  void tick();
  void run();
  void close_all();

  web::Hub hub;
  web::tcp::acceptor acceptor{hub.context};
  web::net::steady_timer ticker{hub.context}, acceptor_rest{hub.context};
  int port = 0;
  std::thread thread;
};

void WebServer::State::listen() {
  web::error_code ec;
  const auto advise = [&](const std::string& problem) {
    throw Error(problem + ": " + ec.message(), {.key = "address, port"}, "an address of this machine, a free port",
                "choose another port, or 0 for any");
  };
  const auto address = web::net::ip::make_address(hub.config.address, ec);
  if (ec) advise("no address: " + hub.config.address);
  const web::tcp::endpoint end(address, static_cast<std::uint16_t>(hub.config.port));
  acceptor.open(end.protocol(), ec);
  if (!ec) acceptor.set_option(web::net::socket_base::reuse_address(true), ec);
  if (!ec) acceptor.bind(end, ec);
  if (!ec) acceptor.listen(128, ec);
  if (ec) advise(fmt::format("cannot serve at {}, port {}", hub.config.address, hub.config.port));
}

void WebServer::State::accept() {
  acceptor.async_accept([this](web::error_code ec, web::tcp::socket socket) {
    if (!acceptor.is_open()) return;
    if (!ec) {
      enter(std::move(socket));
      return accept();
    }
    hub.refuse("accept");  // out of descriptors, mostly
    acceptor_rest.expires_after(web::kReportsKept);
    acceptor_rest.async_wait([this](web::error_code) { accept(); });
  });
}

void WebServer::State::enter(web::tcp::socket socket) {
  web::error_code ignored;
  socket.set_option(web::tcp::no_delay(true), ignored);
#ifdef TCP_NOTSENT_LOWAT
  const int unsent = static_cast<int>(WebServer::kUnsentBytes);
  setsockopt(socket.native_handle(), IPPROTO_TCP, TCP_NOTSENT_LOWAT, &unsent, sizeof unsent);
#endif
  std::uint64_t number = 0;
  bool full = false;
  hub.count([&](WebCounts& c) {
    number = c.connections_ever;
    full = c.connections >= hub.config.max_connections;
  });
  if (full) {  // drop the connection that has waited longest for its request
    hub.refuse("connections");
    if (hub.requesting.empty()) return;
    hub.requesting.begin()->second->drop();
    hub.requesting.erase(hub.requesting.begin());
  }
  std::make_shared<web::HttpConnection>(hub, std::move(socket), number)->read();
}

void WebServer::State::tick() {
  ticker.expires_after(web::ticks_of(1 / hub.config.frames_hz));
  ticker.async_wait([this](web::error_code ec) {
    if (ec) return;
    const auto now = web::Clock::now();
    for (web::SocketClient* client : std::vector(hub.clients.begin(), hub.clients.end())) client->tick(now);
    tick();
  });
}

void WebServer::State::run() {
  accept();
  tick();
  for (bool again = true; again;) {
    try {
      hub.context.run();
      again = false;
    } catch (const std::exception&) {
      hub.refuse("exception");
    }
  }
}

void WebServer::State::close_all() {
  web::error_code ignored;
  acceptor.close(ignored);
  for (web::SocketClient* client : std::vector(hub.clients.begin(), hub.clients.end())) client->drop();
  for (const auto& [number, connection] : std::map(hub.requesting)) connection->drop();
}

WebServer::WebServer(const WebServerConfig& config, WebSite site)
    : state_(std::make_unique<State>(config, std::move(site))) {
  state_->listen();
  state_->port = state_->acceptor.local_endpoint().port();
  // The server's thread blocks all signals; the main thread handles them.
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  try {
    state_->thread = std::thread([state = state_.get()] { state->run(); });
  } catch (const std::system_error&) {
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    throw Error("the system cannot start a thread for the page");
  }
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

WebServer::~WebServer() {
  try {
    stop();
  } catch (...) {  // Asio may report that a timer could not be cancelled, which does not matter here
  }
}

int WebServer::port() const { return state_->port; }

WebCounts WebServer::counts() const {
  const std::lock_guard lock(state_->hub.mutex);
  return state_->hub.counts;
}

void WebServer::stop() {
  if (!state_->thread.joinable()) return;
  state_->hub.context.stop();
  state_->thread.join();
  state_->close_all();
}

}  // namespace isobath
