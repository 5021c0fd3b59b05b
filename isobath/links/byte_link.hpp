// ByteReceiver, ByteLink: the two ends of a link of a LinkHub (link_hub.hpp): what is told of it, and what sends.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <isobath/base/time.hpp>
#include <isobath/io/bytes/bytes.hpp>
#include <string>
#include <vector>

namespace isobath {

class ByteReceiver {
 public:
  virtual ~ByteReceiver() = default;
  virtual void on_bytes(Bytes bytes, Time time) = 0;
  virtual void on_open(Time /*time*/) {}
  /// The link has been lost, or could not be opened; it goes on trying.
  virtual void on_closed(Time /*time*/, const std::string& /*why*/) {}
  virtual void on_tick(Time /*time*/) {}
};

class ByteLink {
 public:
  ByteLink() = default;
  ByteLink(const ByteLink&) = delete;
  ByteLink& operator=(const ByteLink&) = delete;
  virtual ~ByteLink() = default;
  virtual void send(std::vector<std::byte> bytes) = 0;
  /// Breaks the link, as if its cable were pulled, for this long. For stand-ins.
  virtual void cut(std::chrono::milliseconds lasts) = 0;
  /// The port where a server listens, once it does.
  [[nodiscard]] virtual int port() const = 0;
  [[nodiscard]] virtual std::uint64_t dropped() const = 0;  ///< bytes
};

}  // namespace isobath
