// Packets of a group: any bytes; what is read writes the same bytes again.
#include <algorithm>
#include <cstdint>
#include <isobath/mission/messages/group_words.hpp>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace isobath;
  const std::span<const std::uint8_t> bytes(data, size);
  const auto word = group_word_of(bytes);
  if (!word) return 0;
  const FrameBytes again = std::visit([](const auto& known) { return to_bytes(known); }, *word);
  if (again.size() != size) __builtin_trap();
  if (group_word_of(again) != word) __builtin_trap();
  return 0;
}
