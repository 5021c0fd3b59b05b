// The MCAP reader and the native log in it: any bytes.
#include <cstdint>
#include <isobath/base/error.hpp>
#include <isobath/io/mcap/native_log.hpp>
#include <sstream>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace isobath;
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  try {
    McapReader reader(std::make_unique<std::istringstream>(bytes), "fuzz");
    while (reader.next()) {
    }
    const auto source = open_native_log(std::make_unique<std::istringstream>(bytes), "fuzz");
    while (const auto event = source->next()) {
      if (const auto* ping = std::get_if<Ping>(&*event)) (void)check(*ping);
    }
  } catch (const Error&) {
  }
  return 0;
}
