// The other end of a WebServer, on bare sockets: what a browser does, and what it never would.
#pragma once

#include <arpa/inet.h>
#include <cstdint>
#include <netinet/tcp.h>
#include <optional>
#include <poll.h>
#include <string>
#include <string_view>
#include <sys/socket.h>
#include <unistd.h>
#include <utility>

namespace isobath::test {

/// A TCP connection; whoever waits in it gives up after kPatience, which only a failing test sees.
class Wire {
 public:
  static constexpr int kPatienceMs = 10000;

  explicit Wire(int port, int receive_buffer = 0) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    if (receive_buffer > 0) setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
    const int on = 1;
    setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    open_ = ::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
  }
  Wire(Wire&& other) noexcept
      : socket_(std::exchange(other.socket_, -1)), open_(other.open_), got_(std::move(other.got_)) {}
  Wire& operator=(Wire&&) = delete;
  ~Wire() {
    if (socket_ >= 0) ::close(socket_);
  }

  /// False where the other end takes no more.
  bool send(std::string_view bytes) {
    while (open_ && !bytes.empty()) {
      pollfd ready{socket_, POLLOUT, 0};
      if (::poll(&ready, 1, kPatienceMs) != 1) return false;
      const ssize_t n = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
      if (n <= 0) return open_ = false;
      bytes.remove_prefix(static_cast<std::size_t>(n));
    }
    return open_;
  }

  /// `size` bytes, or fewer where the other end has closed, or nothing came for `patience`.
  std::string take(std::size_t size, int patience_ms = kPatienceMs) {
    while (got_.size() < size && more(patience_ms)) continue;
    std::string taken = got_.substr(0, size);
    got_.erase(0, taken.size());
    return taken;
  }
  /// Up to and with `end`.
  std::string take_until(std::string_view end) {
    while (got_.find(end) == std::string::npos && more(kPatienceMs)) continue;
    const std::size_t at = got_.find(end);
    return take(at == std::string::npos ? got_.size() : at + end.size(), 0);
  }
  /// All until the other end closes.
  std::string take_all() {
    while (more(kPatienceMs)) continue;
    return std::exchange(got_, {});
  }
  /// Whether the other end has closed, or does so soon.
  bool ends() {
    while (more(kPatienceMs)) got_.clear();
    return !open_;
  }

 private:
  bool more(int patience_ms) {
    pollfd ready{socket_, POLLIN, 0};
    if (!open_ || ::poll(&ready, 1, patience_ms) != 1) return false;
    char bytes[65536];
    const ssize_t n = ::recv(socket_, bytes, sizeof bytes, 0);
    if (n <= 0) return open_ = false;
    got_.append(bytes, static_cast<std::size_t>(n));
    return true;
  }

  int socket_;
  bool open_ = false;
  std::string got_;
};

enum Opcode : unsigned { kContinuation = 0, kText = 1, kBinary = 2, kClose = 8, kPing = 9, kPong = 10 };

/// A frame of RFC 6455, 5.2, as a client sends it: masked, with zeros, so that the bytes stay legible.
inline std::string frame_bytes(unsigned opcode, std::string_view payload, bool last = true, bool masked = true) {
  std::string bytes(1, static_cast<char>((last ? 0x80u : 0u) | opcode));
  const unsigned mask = masked ? 0x80 : 0;
  if (payload.size() < 126) {
    bytes += static_cast<char>(mask | payload.size());
  } else {
    bytes += static_cast<char>(mask | 126);
    bytes += static_cast<char>(payload.size() >> 8);
    bytes += static_cast<char>(payload.size() & 0xff);
  }
  if (masked) bytes.append(4, '\0');
  return bytes.append(payload);
}

/// A client of the socket.
class SocketPage {
 public:
  /// `headers`: further ones, each ended by \r\n.
  explicit SocketPage(int port, const std::string& headers = "", int receive_buffer = 0) : wire(port, receive_buffer) {
    // The key and what it must be answered by are those of RFC 6455, 1.3.
    wire.send("GET /socket HTTP/1.1\r\nHost: localhost:" + std::to_string(port) +
              "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
              "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
              headers + "\r\n");
    answer = wire.take_until("\r\n\r\n");
  }
  [[nodiscard]] bool open() const {
    return answer.starts_with("HTTP/1.1 101") && answer.find("s3pPLMBiTxaQ9kYGzzhZRbK+xOo=") != std::string::npos;
  }
  bool say(std::string_view text) { return wire.send(frame_bytes(kText, text)); }

  /// The next binary message; pings are answered on the way. Nothing where the connection ends: see `closed`.
  std::optional<std::string> next(int patience_ms = Wire::kPatienceMs) {
    std::string message;
    for (;;) {
      const std::string head = wire.take(2, patience_ms);
      if (head.size() < 2) return std::nullopt;
      const unsigned first = static_cast<unsigned char>(head[0]);
      std::uint64_t size = static_cast<unsigned char>(head[1]) & 0x7fu;
      if (size >= 126) {
        const std::string wide = wire.take(size == 126 ? 2 : 8);
        size = 0;
        for (const char c : wide) size = size << 8 | static_cast<unsigned char>(c);
      }
      const std::string payload = wire.take(size);
      if (payload.size() < size) return std::nullopt;
      switch (first & 0xfu) {
        case kPing: wire.send(frame_bytes(kPong, payload)); break;
        case kPong: ++pongs; break;
        case kClose:
          if (size >= 2) {
            closed = static_cast<unsigned char>(payload[0]) << 8 | static_cast<unsigned char>(payload[1]);
          }
          return std::nullopt;
        default:
          message += payload;
          if ((first & 0x80u) != 0) return message;
      }
    }
  }
  /// Reads on until the server closes; the code that it says why by, 0 where it says none.
  int close_code() {
    while (next()) continue;
    return closed;
  }

  Wire wire;
  std::string answer;
  int closed = 0, pongs = 0;
};

}  // namespace isobath::test
