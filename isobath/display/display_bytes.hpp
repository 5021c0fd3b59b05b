// DisplayBytes: writes the payload of a display item (docs/live-page.md): little-endian numbers in sequence, and packed
// runs.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

namespace isobath {

class DisplayBytes {
 public:
  template <class Number>
  DisplayBytes& add(Number value) {
    out_.append(reinterpret_cast<const char*>(&value), sizeof value);  // all supported machines are little-endian
    return *this;
  }
  DisplayBytes& add_floats(std::initializer_list<double> values) {
    for (const double v : values) add(static_cast<float>(v));
    return *this;
  }
  DisplayBytes& append(std::span<const std::uint8_t> bytes) {
    out_.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return *this;
  }
  DisplayBytes& pad_to(std::size_t multiple) {
    out_.append((multiple - out_.size() % multiple) % multiple, '\0');
    return *this;
  }
  /// PackBits: a run of two or more equal bytes takes two bytes, other bytes are copied.
  DisplayBytes& append_packed(std::span<const std::uint8_t> bytes) {
    constexpr std::size_t kMax = 128;
    std::size_t at = 0;
    while (at < bytes.size()) {
      std::size_t run = 1;
      while (run < kMax && at + run < bytes.size() && bytes[at + run] == bytes[at]) ++run;
      if (run > 1) {
        add(static_cast<std::uint8_t>(257 - run)).add(bytes[at]);
        at += run;
        continue;
      }
      std::size_t end = at + 1;  // until three equal bytes follow: a pair amid others is not worth a run of its own
      while (end < bytes.size() && end - at < kMax &&
             !(end + 2 < bytes.size() && bytes[end] == bytes[end + 1] && bytes[end] == bytes[end + 2])) {
        ++end;
      }
      add(static_cast<std::uint8_t>(end - at - 1)).append(bytes.subspan(at, end - at));
      at = end;
    }
    return *this;
  }
  [[nodiscard]] std::size_t size() const { return out_.size(); }
  /// Overwrites a number that is known only later.
  template <class Number>
  void put(std::size_t at, Number value) {
    std::memcpy(out_.data() + at, &value, sizeof value);
  }
  std::string take() { return std::move(out_); }

 private:
  std::string out_;
};

/// Unpacks the bytes of append_packed into `out`; false if they are not exactly `out.size()` bytes.
inline bool unpack_bits(std::string_view packed, std::span<std::uint8_t> out) {
  std::size_t from = 0, to = 0;
  while (from < packed.size()) {
    const auto head = static_cast<std::uint8_t>(packed[from++]);
    if (head == 128) continue;
    const bool as_is = head < 128;
    const std::size_t count = as_is ? head + 1U : 257U - head, taken = as_is ? count : 1;
    if (taken > packed.size() - from || count > out.size() - to) return false;
    if (as_is) {
      std::memcpy(out.data() + to, packed.data() + from, count);
    } else {
      std::memset(out.data() + to, static_cast<std::uint8_t>(packed[from]), count);
    }
    from += taken;
    to += count;
  }
  return to == out.size();
}

}  // namespace isobath
