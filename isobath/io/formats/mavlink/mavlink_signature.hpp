// Signed MAVLink frames (mavlink.io, message signing): MavlinkKey is the secret of a vehicle, MavlinkSigner signs our
// frames, SignatureCheck tells which frames of others are to be trusted.
//
// A signature is the number of a link, a time in units of 10 microseconds since 2015, which grows with each frame, and
// the first six bytes of SHA-256 over the key, the frame and these two. The key is SHA-256 of a passphrase, as
// ground stations make it.
#pragma once

#include <array>
#include <cstdint>
#include <isobath/base/time.hpp>
#include <isobath/io/bytes/bytes.hpp>
#include <map>
#include <string>
#include <tuple>
#include <vector>

namespace isobath {

inline constexpr std::size_t kMavlinkSignatureBytes = 13;
inline constexpr std::byte kMavlinkSigned{1};  ///< among the incompatible flags of the head

class MavlinkKey {
 public:
  static constexpr std::size_t kMinPassphrase = 8;
  /// Throws Error for a passphrase of fewer characters.
  explicit MavlinkKey(std::string_view passphrase);
  /// The last six bytes of the signature of a frame; `bytes`: the frame with link and time.
  [[nodiscard]] std::array<std::byte, 6> seal_of(Bytes bytes) const;

 private:
  std::array<std::byte, 32> key_{};
};

class MavlinkSigner {
 public:
  explicit MavlinkSigner(const MavlinkKey& key, std::uint8_t link = 0) : key_(key), link_(link) {}
  /// Appends the signature to a frame whose head says that it has one.
  void sign(std::vector<std::byte>& frame, Time now);

 private:
  MavlinkKey key_;
  std::uint8_t link_;
  std::uint64_t last_ = 0;
};

/// Trusts a frame whose signature is right and later than those of its sender on its link; the first of a sender must
/// not be more than a minute older than the latest of all. Forgets no sender; trusts at most 1024.
class SignatureCheck {
 public:
  enum class Verdict : std::uint8_t { kTrusted, kUnsigned, kWrong, kRepeated };
  explicit SignatureCheck(const MavlinkKey& key) : key_(key) {}
  /// `frame`: complete, of either version of MAVLink.
  Verdict judge(Bytes frame);

 private:
  using Sender = std::tuple<std::uint8_t, std::uint8_t, std::uint8_t>;  ///< system, component, link
  MavlinkKey key_;
  std::map<Sender, std::uint64_t> last_;
  std::uint64_t latest_ = 0;
};
/// For people; nullptr: trusted.
const char* to_text(SignatureCheck::Verdict verdict);

}  // namespace isobath
