#include <algorithm>
#include <cmath>
#include <isobath/mission/messages/group_words.hpp>

namespace isobath {
namespace {

using Bytes = std::span<const std::uint8_t>;

enum : std::uint8_t { kStatus = 1, kPlan = 2 };
constexpr std::size_t kGroupHead = 5, kStatusHead = 20, kPlanHead = 9, kCheck = 2;
constexpr std::uint8_t kNobody = 15, kNone = 255;
constexpr std::size_t kObstacle = 7, kTurn = 2, kPassages = 3;
constexpr double kPlaceStep_m = 0.5, kSizeStep_m = 0.25;

std::size_t bytes_of(std::size_t lanes) { return (lanes + 7) / 8; }

FrameBytes begun(std::uint8_t kind, std::uint8_t from) { return {'I', 'G', 3, kind, from}; }

FrameBytes checked(FrameBytes out) {
  put(out, crc32(out) & 0xffffU, kCheck);
  return out;
}

std::uint64_t place_word(double metres) {
  const double steps = std::clamp(std::round(metres / kPlaceStep_m), -32768.0, 32767.0);
  return static_cast<std::uint16_t>(static_cast<std::int16_t>(steps));
}

double place_at(Bytes bytes, std::size_t at) {
  return kPlaceStep_m * static_cast<std::int16_t>(static_cast<std::uint16_t>(number_at(bytes, at, 2)));
}

/// Rounded up.
std::uint8_t size_word(double metres) {
  return static_cast<std::uint8_t>(std::clamp(std::ceil(metres / kSizeStep_m), 0.0, 255.0));
}

ObstacleWord obstacle_at(Bytes b, std::size_t at) {
  return {b[at], {place_at(b, at + 1), place_at(b, at + 3)}, kSizeStep_m * b[at + 5], kSizeStep_m * b[at + 6]};
}

std::optional<std::uint8_t> unless_none(std::uint64_t value) {
  if (value == kNone) return std::nullopt;
  return static_cast<std::uint8_t>(value);
}

/// The bits of lanes that there are.
LaneBits done_at(Bytes bytes, std::size_t at, std::size_t lanes) {
  const LaneBits all = lanes >= 64 ? ~LaneBits{0} : (LaneBits{1} << lanes) - 1;
  return number_at(bytes, at, bytes_of(lanes)) & all;
}

/// Whether the bytes are all of a status about passages.
bool passages_in(Bytes b, GroupStatus& s) {
  if (b.size() < kPassages || b[2] > kMaxPassages || b.size() != kPassages + kTurn * b[2]) return false;
  if (const auto passage = unless_none(b[0])) s.ask = PassageAsk{*passage, b[1], false};
  for (std::size_t at = kPassages; at < b.size(); at += kTurn) {
    s.turns.push_back({static_cast<std::uint8_t>(b[at] & 15U), static_cast<std::uint8_t>(b[at] >> 4), b[at + 1]});
  }
  return true;
}

std::optional<GroupStatus> status_in(Bytes b) {
  if (b.size() < kStatusHead || b[kStatusHead - 1] > kMaxLanes) return std::nullopt;
  const std::size_t told = kStatusHead + bytes_of(b[kStatusHead - 1]);
  if (b.size() <= told || b[told] > kMostTold) return std::nullopt;
  const std::size_t end = told + 1 + kObstacle * b[told];
  const bool has_passages = (b[16] & 64U) != 0;
  if (b.size() < end || (!has_passages && b.size() != end)) return std::nullopt;
  GroupStatus s;
  s.from = b[4];
  s.number = static_cast<std::uint16_t>(number_at(b, 5, 2));
  s.place_W = {place_at(b, 7), place_at(b, 9)};
  s.lane = unless_none(b[11]);
  s.stations = b[12];
  s.leader = unless_none(b[13]);
  s.version = static_cast<std::uint16_t>(number_at(b, 14, 2));
  s.over = (b[16] & 1U) != 0;
  s.backwards = (b[16] & 2U) != 0;
  s.ready = (b[16] & 4U) != 0;
  if ((b[16] & 8U) != 0) s.begin_s = static_cast<std::uint16_t>(number_at(b, 17, 2));
  s.no_way = (b[16] & 16U) != 0;
  s.lanes = b[19];
  s.done = done_at(b, kStatusHead, s.lanes);
  for (std::size_t i = 0; i < b[told]; ++i) s.obstacles.push_back(obstacle_at(b, told + 1 + kObstacle * i));
  if (has_passages && !passages_in(b.subspan(end), s)) return std::nullopt;
  if (s.ask) s.ask->passing = (b[16] & 32U) != 0;
  return s;
}

std::optional<GroupPlan> plan_in(Bytes b) {
  if (b.size() < kPlanHead || b[8] > kMaxLanes) return std::nullopt;
  const std::size_t lanes = b[8], owners = kPlanHead + bytes_of(lanes);
  if (b.size() != owners + (lanes + 1) / 2) return std::nullopt;
  GroupPlan p;
  p.from = b[4];
  p.version = static_cast<std::uint16_t>(number_at(b, 5, 2));
  p.ascending = (b[7] & 1U) != 0;
  p.done = done_at(b, kPlanHead, lanes);
  for (std::size_t k = 0; k < lanes; ++k) {
    const std::uint8_t owner = (b[owners + k / 2] >> (k % 2 == 0 ? 0 : 4)) & 15U;
    p.owner.push_back(owner == kNobody ? std::nullopt : std::optional(owner));
  }
  return p;
}

}  // namespace

FrameBytes to_bytes(const GroupStatus& s) {
  const bool has_passages = s.ask || !s.turns.empty();
  const bool flags[] = {s.over,      s.backwards, s.ready, s.begin_s.has_value(), s.no_way, s.ask && s.ask->passing,
                        has_passages};
  unsigned flag_bits = 0;
  for (std::size_t i = 0; i < std::size(flags); ++i) flag_bits |= static_cast<unsigned>(flags[i]) << i;
  FrameBytes out = begun(kStatus, s.from);
  put(out, s.number, 2);
  put(out, place_word(s.place_W.x()), 2);
  put(out, place_word(s.place_W.y()), 2);
  out.push_back(s.lane.value_or(kNone));
  out.push_back(s.stations);
  out.push_back(s.leader.value_or(kNone));
  put(out, s.version, 2);
  out.push_back(static_cast<std::uint8_t>(flag_bits));
  put(out, s.begin_s.value_or(0), 2);
  out.push_back(s.lanes);
  put(out, s.done, static_cast<int>(bytes_of(s.lanes)));
  const std::size_t told = std::min(s.obstacles.size(), kMostTold);
  out.push_back(static_cast<std::uint8_t>(told));
  for (const ObstacleWord& o : std::span(s.obstacles).first(told)) {
    out.push_back(o.key);
    put(out, place_word(o.centre_W.x()), 2);
    put(out, place_word(o.centre_W.y()), 2);
    out.push_back(size_word(o.radius_m));
    out.push_back(size_word(o.sigma_m));
  }
  if (!has_passages) return checked(std::move(out));
  const std::size_t turns = std::min(s.turns.size(), kMaxPassages);
  out.push_back(s.ask ? s.ask->passage : kNone);
  out.push_back(s.ask ? s.ask->number : 0);
  out.push_back(static_cast<std::uint8_t>(turns));
  for (const PassageTurn& turn : std::span(s.turns).first(turns)) {
    out.push_back(static_cast<std::uint8_t>((turn.passage & 15U) | (static_cast<unsigned>(turn.vehicle) << 4)));
    out.push_back(turn.number);
  }
  return checked(std::move(out));
}

FrameBytes to_bytes(const GroupPlan& p) {
  FrameBytes out = begun(kPlan, p.from);
  put(out, p.version, 2);
  out.push_back(p.ascending ? 1 : 0);
  out.push_back(static_cast<std::uint8_t>(p.owner.size()));
  put(out, p.done, static_cast<int>(bytes_of(p.owner.size())));
  for (std::size_t k = 0; k < p.owner.size(); k += 2) {
    const unsigned low = p.owner[k].value_or(kNobody);
    const unsigned high = k + 1 < p.owner.size() ? p.owner[k + 1].value_or(kNobody) : kNobody;
    out.push_back(static_cast<std::uint8_t>(low | (high << 4)));
  }
  return checked(std::move(out));
}

bool is_of_group(Bytes bytes) { return bytes.size() >= 2 && bytes[0] == 'I' && bytes[1] == 'G'; }

std::optional<std::variant<GroupStatus, GroupPlan>> group_word_of(Bytes bytes) {
  if (!is_of_group(bytes) || bytes.size() < kGroupHead + kCheck || bytes[2] != 3) return std::nullopt;
  const Bytes all = bytes.first(bytes.size() - kCheck);
  if (number_at(bytes, all.size(), kCheck) != (crc32(all) & 0xffffU)) return std::nullopt;
  if (bytes[3] == kStatus) {
    if (auto status = status_in(all)) return *status;
  }
  if (bytes[3] == kPlan) {
    if (auto plan = plan_in(all)) return *std::move(plan);
  }
  return std::nullopt;
}

}  // namespace isobath
