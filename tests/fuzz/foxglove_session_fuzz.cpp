// A viewer of a run: any bytes as its messages, a line each; after each, frames are made until there is none. A text
// frame must be JSON, a binary one a message of a subscription or a time.
#include <isobath/base/error.hpp>
#include <isobath/server/foxglove_session.hpp>
#include <nlohmann/json.hpp>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace isobath;
  std::string_view text(reinterpret_cast<const char*>(data), size);
  ViewerFeed feed;
  const std::size_t pose = feed.open({"/foxglove/pose", "foxglove.PoseInFrame", "{}"});
  FoxgloveSession session(feed, "Isobath", "1");
  std::int64_t now = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const Hearing hearing = session.on_message(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    feed.write(pose, Time(Duration(++now)), "{}");
    for (WebFrame frame = session.next(); frame.bytes() > 0; frame = session.next()) {
      if (frame.text) {
        ISOBATH_ASSERT(nlohmann::json::accept(frame.own));
      } else {
        ISOBATH_ASSERT((frame.own[0] == 1 && frame.own.size() == 15) || (frame.own[0] == 2 && frame.own.size() == 9));
      }
    }
    if (hearing.hang_up) break;
  }
  return 0;
}
