// Bytes of a MOOSDB or of its client, as they come over a link; what is read is written as the same messages again.
#include <isobath/io/formats/moos/given_obstacle.hpp>
#include <isobath/io/formats/moos/moos_messages.hpp>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace isobath;
  const Bytes bytes = std::as_bytes(std::span(data, size));
  SourceReport report;
  FrameStream frames(moos_frame_at);
  frames.push(bytes, {}, 0);
  while (const auto found = frames.next(report)) {
    if (is_moos_greeting(found->frame)) continue;
    const auto messages = moos_messages_of(found->frame, report);
    const auto packet = moos_packet(messages);
    if (packet.size() > found->frame.size()) __builtin_trap();
    SourceReport again;
    if (moos_packet(moos_messages_of(packet, again)) != packet || !again.rejected.empty()) __builtin_trap();
    for (const MoosMessage& message : messages) {
      const auto obstacle = given_obstacle_of(message.text);
      if (obstacle && !is_convex(obstacle->outline_W)) __builtin_trap();
      if (obstacle) (void)given_obstacle_text(*obstacle);
    }
  }
  if (report.bytes_skipped > size) __builtin_trap();
  return 0;
}
