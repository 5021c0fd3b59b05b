// Bytes written by hand, and what tests do with sources: whole logs in memory, all events out.
#pragma once

#include <isobath/event/event.hpp>
#include <isobath/io/bytes/byte_window.hpp>
#include <memory>
#include <string>
#include <vector>

namespace isobath::test {

/// "42 52 02 00": hexadecimal, blanks and bars ignored; "00x16" stands for sixteen zero bytes.
inline std::string hex(std::string_view text) {
  std::string bytes;
  std::string token;
  const auto add = [&] {
    if (token.empty()) return;
    const std::size_t times = token.find('x');
    const int count = times == std::string::npos ? 1 : std::stoi(token.substr(times + 1));
    bytes.append(static_cast<std::size_t>(count), static_cast<char>(std::stoi(token.substr(0, 2), nullptr, 16)));
    token.clear();
  };
  for (const char c : text) {
    if (c == ' ' || c == '|' || c == '\n') {
      add();
    } else {
      token += c;
    }
  }
  add();
  return bytes;
}

template <class T>
std::string little(T value) {
  std::string bytes(sizeof value, '\0');
  for (std::size_t i = 0; i < sizeof value; ++i) bytes[i] = static_cast<char>(value >> (8 * i) & 0xff);
  return bytes;
}
template <class T>
std::string big(T value) {
  const std::string bytes = little(value);
  return {bytes.rbegin(), bytes.rend()};
}

/// A log in memory, owned by whoever still looks at it.
inline ByteWindow in_memory(std::string log) {
  auto owner = std::make_shared<const std::string>(std::move(log));
  return {"log in memory", bytes_of(*owner), owner};
}

inline std::vector<Event> drain(Source& source) {
  std::vector<Event> events;
  while (auto event = source.next()) events.push_back(std::move(*event));
  return events;
}

inline std::vector<float> beam(const Ping& ping, int beam = 0) {
  std::vector<float> values(static_cast<std::size_t>(ping.window.bins));
  ping.intensity.copy_beam(beam, values.data());
  return values;
}

/// The same event, samples and times included.
inline bool same_samples(const Event& a, const Event& b) {
  if (a.index() != b.index() || time_of(a) != time_of(b)) return false;
  if (const auto* p = std::get_if<Ping>(&a)) {
    const Ping& q = std::get<Ping>(b);
    if (p->window != q.window || p->fan->azimuth != q.fan->azimuth) return false;
    for (int i = 0; i < p->fan->beams(); ++i) {
      if (beam(*p, i) != beam(q, i)) return false;
    }
  }
  return true;
}

}  // namespace isobath::test
