// Logs of Blueprint Subsea's Oculus. oculus_device.hpp describes how messages become events.
#pragma once

#include <isobath/event/event.hpp>
#include <isobath/io/bytes/byte_window.hpp>
#include <isobath/io/input/input_config.hpp>
#include <memory>

namespace isobath {

/// Messages back to back as sent over TCP. Times: the device's time since power-up (version 2), else estimated from the
/// ping rate and the ping numbers. Throws Error if the file begins with a message that states a larger payload than any
/// sonar sends.
/// Recognised by a ping result, by a message at the start, or by two messages back to back.
bool looks_like_oculus_stream(Bytes head);
std::unique_ptr<Source> open_oculus_stream(ByteWindow input, const InputConfig& config);

/// The `.oculus` container of ViewPoint 1: each message is in an item with the recorder's time; some items are
/// compressed. A damaged item loses only itself. Throws Error if the file is encrypted, truncated in its header, or
/// empty after it.
bool looks_like_oculus_container(Bytes head);
std::unique_ptr<Source> open_oculus_container(ByteWindow input, const InputConfig& config);

}  // namespace isobath
