#include <algorithm>
#include <fmt/format.h>
#include <isobath/io/bytes/log_source.hpp>
#include <isobath/io/formats/oculus/oculus_device.hpp>
#include <isobath/io/formats/oculus/oculus_logs.hpp>
#include <zlib.h>

namespace isobath {
namespace {

constexpr std::uint32_t kFileMagic = 0x11223344;
constexpr std::uint32_t kItemMagic = 0xaabbccdd;
constexpr std::size_t kFileHeader = 48;
constexpr std::size_t kItemHeader = 40;
constexpr std::uint32_t kMinItemHeader = 36;
constexpr std::uint32_t kMaxHeader = 4096;
constexpr std::uint16_t kOculusMessage = 10;
constexpr std::size_t kZlibMaxRatio = 1032;  // maximum ratio of deflate: bounds the allocation for a small item

struct Item {
  std::uint32_t header_bytes = 0;
  std::uint16_t type = 0;
  double time_s = 0;
  std::uint16_t compression = 0;
  std::uint32_t payload_bytes = 0;
};

/// The item that starts at the first byte; empty: none.
std::optional<Item> item_at(Bytes bytes) {
  ByteCursor cursor(bytes);
  Item item;
  const auto magic = cursor.little<std::uint32_t>();
  item.header_bytes = cursor.little<std::uint32_t>();
  item.type = cursor.little<std::uint16_t>();
  cursor.skip(6);  // version, padding
  item.time_s = cursor.little<double>();
  item.compression = cursor.little<std::uint16_t>();
  cursor.skip(6);  // padding, original size
  item.payload_bytes = cursor.little<std::uint32_t>();
  const bool good = cursor.ok() && magic == kItemMagic && item.header_bytes >= kMinItemHeader &&
                    item.header_bytes <= kMaxHeader && item.payload_bytes <= kOculusMaxPayload + 16;
  return good ? std::optional(item) : std::nullopt;
}

/// Start of the first item at or after `from`; bytes.size() if there is none.
std::size_t find_item(Bytes bytes, std::size_t from) {
  const std::string_view text = text_of(bytes);
  for (std::size_t at = from;; ++at) {
    at = text.find("\xdd\xcc\xbb\xaa", at);
    if (at == std::string_view::npos) return bytes.size();
    if (item_at(bytes.subspan(at))) return at;
  }
}

class OculusContainer final : public LogSource {
 public:
  OculusContainer(ByteWindow input, const InputConfig& config)
      : LogSource(std::move(input), ".oculus log"), device_(config, report_) {
    read_header();
    report_.details["time"] = "clock of the recorder";
  }

 private:
  std::optional<Event> read() override;
  void read_header();
  void skip_to_item(Bytes view);
  std::size_t item_end(const Item& item);
  std::optional<Event> take(const Item& item, Bytes payload, std::size_t bytes);
  std::optional<Bytes> inflate(Bytes payload);

  OculusDevice device_;
  SampleArena arena_;
  std::uint64_t other_items_ = 0;
};

void OculusContainer::read_header() {
  const Bytes head = input_.want(kMaxHeader);
  ByteCursor cursor(head, 4);
  const auto header_bytes = cursor.little<std::uint32_t>();
  cursor.skip(18);  // source, version
  const auto encryption = cursor.little<std::uint16_t>();
  if (head.size() < kFileHeader)
    throw Error("ends within its header", {input_.name(), head.size()}, {}, "the log was cut off");
  if (encryption != 0) throw Error("is encrypted", {input_.name(), 26}, {}, "export it without encryption");
  if (header_bytes < kFileHeader || header_bytes > kMaxHeader) {
    throw Error(fmt::format("a header of {} bytes", header_bytes), {input_.name(), 4, {}, {}, "sizeHeader"},
                fmt::format("{} .. {}", kFileHeader, kMaxHeader));
  }
  if (head.size() <= header_bytes)
    throw Error("ends after its header: nothing was recorded", {input_.name(), head.size()});
  input_.advance(header_bytes);
}

std::optional<Event> OculusContainer::read() {
  for (;;) {
    const Bytes head = input_.want(kMaxHeader);
    if (head.empty()) return {};
    const auto item = item_at(head);
    if (!item) {
      skip_to_item(head);
      continue;
    }
    const std::size_t end = item_end(*item);
    const std::size_t begin = std::min<std::size_t>(item->header_bytes, end);
    auto event = take(*item, input_.want(end).subspan(begin, end - begin), end);
    input_.advance(end);
    if (event) return event;
  }
}

void OculusContainer::skip_to_item(Bytes view) {
  const std::size_t found = find_item(view, 1);
  // An item may begin in the last bytes of the view.
  const std::size_t sure = view.size() >= kMaxHeader ? view.size() - kItemHeader + 1 : view.size();
  report_.add_damage(input_.position(), std::min(found, sure), "no item starts here");
  input_.advance(std::min(found, sure));
}

// The stated payload length is used if the next item follows it; otherwise the item ends where the next one starts.
std::size_t OculusContainer::item_end(const Item& item) {
  const std::size_t promised = std::size_t{item.header_bytes} + item.payload_bytes;
  const Bytes view = input_.want(promised + kItemHeader);
  if (promised == view.size() || (promised < view.size() && item_at(view.subspan(promised)))) return promised;
  const std::size_t reach = std::min(promised + kItemHeader - 1, view.size());
  return std::min({promised, view.size(), find_item(view.first(reach), kMinItemHeader)});
}

/// The event of an item of `bytes` bytes at the input's position.
std::optional<Event> OculusContainer::take(const Item& item, Bytes payload, std::size_t bytes) {
  if (item.type != kOculusMessage) {
    report_.details["other items"] = fmt::format("{}, not read", ++other_items_);
    return {};
  }
  const bool compressed = item.compression == 1;
  const auto message = compressed ? inflate(payload) : std::optional(payload);
  const bool whole = message && oculus_message_at(*message).kind == Framing::Kind::kFrame;
  if (!whole || item.compression > 1) {
    report_.add_damage(input_.position(), bytes, "item whose message is damaged");
    return {};
  }
  if (!representable_seconds(item.time_s)) {
    reject("time out of range");
    return {};
  }
  return device_.event(*message, Time{seconds(item.time_s)}, compressed ? arena_.owner() : input_.owner());
}

/// Unpacks the format of qCompress: a big-endian size, then a zlib stream.
std::optional<Bytes> OculusContainer::inflate(Bytes payload) {
  ByteCursor cursor(payload);
  const auto size = cursor.big<std::uint32_t>();
  const Bytes packed = cursor.take(cursor.left());
  if (size == 0 || size > kOculusMaxPayload + 16 || size / kZlibMaxRatio > packed.size()) return {};
  std::byte* const out = arena_.take(size);
  uLongf got = size;
  const int status = uncompress(reinterpret_cast<Bytef*>(out), &got, reinterpret_cast<const Bytef*>(packed.data()),
                                static_cast<uLong>(packed.size()));
  if (status == Z_OK && got == size) return Bytes(out, size);
  arena_.give_back(size);
  return {};
}

}  // namespace

bool looks_like_oculus_container(Bytes head) {
  return ByteCursor(head).little<std::uint32_t>() == kFileMagic && head.size() >= 14 &&
         text_of(head.subspan(8, 6)) == "Oculus";
}

std::unique_ptr<Source> open_oculus_container(ByteWindow input, const InputConfig& config) {
  return std::make_unique<OculusContainer>(std::move(input), config);
}

}  // namespace isobath
