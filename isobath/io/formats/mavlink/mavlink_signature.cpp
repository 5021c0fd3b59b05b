#include <algorithm>
#include <cassert>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/io/formats/mavlink/mavlink_signature.hpp>
#include <memory>
#include <openssl/evp.h>
#include <span>

namespace isobath {
namespace {

constexpr std::uint64_t kMinute = 6'000'000;                    // in units of 10 microseconds
constexpr Duration kYear2015 = std::chrono::hours(24) * 16436;  // since 1970
constexpr std::byte kVersion2{0xFD};
constexpr std::size_t kMaxSenders = 1024, kSealBytes = 6;

std::array<std::byte, 32> sha256(std::initializer_list<Bytes> parts) {
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(EVP_MD_CTX_new(), &EVP_MD_CTX_free);
  bool fine = context && EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) == 1;
  for (const Bytes part : parts) fine = fine && EVP_DigestUpdate(context.get(), part.data(), part.size()) == 1;
  std::array<std::byte, 32> digest{};
  fine = fine && EVP_DigestFinal_ex(context.get(), reinterpret_cast<unsigned char*>(digest.data()), nullptr) == 1;
  if (!fine) throw Error("SHA-256 is not available");
  return digest;
}

}  // namespace

MavlinkKey::MavlinkKey(std::string_view passphrase) {
  if (passphrase.size() < kMinPassphrase) {
    throw Error("the passphrase of the MAVLink signatures is too short", {},
                fmt::format("{} characters or more", kMinPassphrase));
  }
  key_ = sha256({std::as_bytes(std::span(passphrase))});
}

std::array<std::byte, 6> MavlinkKey::seal_of(Bytes bytes) const {
  const auto digest = sha256({key_, bytes});
  std::array<std::byte, 6> seal{};
  std::ranges::copy(std::span(digest).first(seal.size()), seal.begin());
  return seal;
}

void MavlinkSigner::sign(std::vector<std::byte>& frame, Time now) {
  const Duration since = now.time_since_epoch() - kYear2015;
  const auto stamp = static_cast<std::uint64_t>(std::max<std::int64_t>(0, since / std::chrono::microseconds(10)));
  last_ = std::max(last_ + 1, stamp);
  frame.push_back(std::byte{link_});
  for (int shift = 0; shift < 48; shift += 8) frame.push_back(static_cast<std::byte>(last_ >> shift));
  const auto seal = key_.seal_of(frame);
  frame.insert(frame.end(), seal.begin(), seal.end());
}

SignatureCheck::Verdict SignatureCheck::judge(Bytes bytes) {
  const bool has_one = bytes[0] == kVersion2 && (bytes[2] & kMavlinkSigned) != std::byte{};
  if (!has_one) return Verdict::kUnsigned;
  if (!std::ranges::equal(key_.seal_of(bytes.first(bytes.size() - kSealBytes)), bytes.last(kSealBytes)))
    return Verdict::kWrong;
  const RecordView head(bytes), signature(bytes.last(kMavlinkSignatureBytes));
  const std::uint64_t time = signature.at<std::uint32_t>(1) | std::uint64_t{signature.at<std::uint16_t>(5)} << 32;
  const Sender who{head.at<std::uint8_t>(5), head.at<std::uint8_t>(6), signature.at<std::uint8_t>(0)};
  const auto [sender, first] = last_.try_emplace(who, time);
  if (first && (time + kMinute < latest_ || last_.size() > kMaxSenders)) {
    last_.erase(sender);
    return Verdict::kRepeated;
  }
  if (!first && time <= sender->second) return Verdict::kRepeated;
  sender->second = time;
  latest_ = std::max(latest_, time);
  return Verdict::kTrusted;
}

const char* to_text(SignatureCheck::Verdict verdict) {
  using Verdict = SignatureCheck::Verdict;
  switch (verdict) {
    case Verdict::kTrusted: return nullptr;
    case Verdict::kUnsigned: return "frame without a signature";
    case Verdict::kWrong: return "frame with a wrong signature";
    case Verdict::kRepeated: return "frame of an old signature";
  }
  return nullptr;
}

}  // namespace isobath
