// Logs of Blueprint Subsea's Oculus. oculus_device.hpp says what becomes of the messages.
#pragma once

#include <isobath/io/byte_window.hpp>
#include <isobath/io/event.hpp>
#include <isobath/io/input_config.hpp>
#include <memory>

namespace isobath {

/// Messages back to back as they come over TCP. Times: of the device since power-up (version 2), else made from the
/// ping rate and the ping numbers. Throws Error where the file begins with a message that promises more than any sonar
/// sends.
bool looks_like_oculus_stream(Bytes head);
std::unique_ptr<Source> open_oculus_stream(ByteWindow input, const InputConfig& config);

/// The `.oculus` container of ViewPoint 1: items with the recorder's time around the messages, some of them compressed.
/// A damaged item costs itself. Throws Error: encrypted, cut off in its header, nothing behind it.
bool looks_like_oculus_container(Bytes head);
std::unique_ptr<Source> open_oculus_container(ByteWindow input, const InputConfig& config);

}  // namespace isobath
