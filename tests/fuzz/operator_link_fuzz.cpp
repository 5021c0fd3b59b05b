// The link to the operator: any bytes as a frame, and as the word of a whole one.
#include <cstddef>
#include <isobath/mission/agents/signaling_officer.hpp>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace isobath;
  const FrameBytes bytes(data, data + size);
  (void)status_of(bytes);
  if (const auto frame = frame_of(bytes)) ISOBATH_ASSERT(to_bytes(*frame) == bytes);
  OperatorConsole console;
  (void)console.on_frame(bytes);
  SignalingOfficer officer;
  for (const FrameBytes& frame : {bytes, to_bytes(Frame{FrameKind::kWord, 1, 1, bytes})}) {
    Outbox out;
    officer.on_message(LinkFrame{LinkFrame::Way::kFromOperator, frame}, Time{}, out);
    for (const Message& said : out.said()) {
      const auto* command = std::get_if<OperatorCommand>(&said);
      if (command && command->plan) check_mission(*command->plan);  // nothing unsound reaches the agents
    }
  }
  return 0;
}
