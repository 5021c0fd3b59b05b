#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/io/formats/moos/given_obstacle.hpp>
#include <isobath/links/moos_link.hpp>
#include <map>
#include <utility>

namespace isobath {
namespace {

using Type = MoosMessage::Type;
using Kind = MoosMessage::Kind;

constexpr Duration kHealthInterval = std::chrono::seconds(1), kShowInterval = std::chrono::seconds(1);
constexpr auto kCut = std::chrono::milliseconds(250);   // before a silent database is connected anew
constexpr auto kRefused = std::chrono::seconds(2);      // before one that has refused us
constexpr auto kEndPatience = std::chrono::seconds(1);  // for the last DESIRED_SPEED
constexpr std::size_t kMaxObstacles = 100, kMaxLines = 50, kMaxLine = 400;
constexpr double kObstacleLasts_s = 10, kFarthest = 1e6, kMaxAltitude_m = 200;
constexpr Angle kAltimeterBeam = Angle::degrees(10);
constexpr const char* kSpeedKey = "DESIRED_SPEED";
constexpr const char* kObstacleKey = "GIVEN_OBSTACLE";
constexpr const char* kDecisionKey = "ISOBATH_DECISION";
constexpr const char* kOverrideKeys[] = {"MOOS_MANUAL_OVERRIDE", "MOOS_MANUAL_OVERIDE"};

double seconds_since_1970(Time time) { return to_seconds(time.time_since_epoch()); }

const char* story_of(Authority authority) {
  switch (authority) {
    case Authority::kNoAutopilot: return "no MOOSDB";
    case Authority::kDisarmed: return "waits: no navigation";
    case Authority::kOtherMode: return "hands back: MOOS_MANUAL_OVERRIDE is not false";
    case Authority::kOurs: return "steers: MOOS_MANUAL_OVERRIDE is false";
  }
  return "";
}

std::string lower_case(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return text;
}

}  // namespace

MoosLink::MoosLink(const FrontSeatConfig& config, LinkSource& events)
    : FrontSeat(config, events), origin_(config.origin()) {}

void MoosLink::on_open(Time time) {
  events_.note("autopilot", fmt::format("MOOSDB at {}", config_.link));
  stage_ = Stage::kGreeted;
  frames_ = FrameStream(moos_frame_at);
  outbox_.clear();
  command_.reset();
  readings_ = {};
  stop_ = Stop::kNone;
  {
    const std::lock_guard lock(mutex_);
    connected_ = override_told_ = false;
    ahead_s_.reset();
  }
  link_->send(moos_greeting());
  MoosMessage name;  // a key "asynchronous" would ask for packets that are no answers
  name.type = Type::kData;
  name.kind = Kind::kText;
  name.text = config_.client;
  put(std::move(name));
  send_next(time);
}

void MoosLink::on_closed(Time /*time*/, const std::string& why) {
  events_.note("autopilot", fmt::format("MOOSDB at {}, not connected: {}", config_.link, why));
  stage_ = Stage::kClosed;
  const std::lock_guard lock(mutex_);
  connected_ = false;
}

void MoosLink::on_bytes(Bytes bytes, Time time) {
  frames_.push(bytes, time, offset_);
  offset_ += bytes.size();
  while (const auto found = frames_.next(report_)) {
    if (is_moos_greeting(found->frame)) {
      ++report_.rejected["greeting of another client"];
    } else if (stage_ != Stage::kClosed) {
      on_answer(moos_messages_of(found->frame, report_), time);
    }
  }
  tell_refused(report_);
}

void MoosLink::on_answer(const std::vector<MoosMessage>& messages, Time time) {
  const bool greeted = stage_ == Stage::kGreeted;
  waits_ = false;
  {
    const std::lock_guard lock(mutex_);
    if (stage_ == Stage::kTalking) heard_ = time;
    if (std::exchange(stop_, stop_ == Stop::kSent ? Stop::kNone : stop_) == Stop::kSent) {
      steered_ = false;
      stopped_.notify_all();
    }
  }
  for (const MoosMessage& message : messages) {
    if (stage_ == Stage::kGreeted) {
      on_welcome(message, time);
    } else if (message.type == Type::kNull) {
      on_null(message, time);
    } else if (message.type == Type::kNotify) {
      on_variable(message, time);
    }
  }
  if (stage_ != Stage::kTalking) return;
  if (!greeted) on_state();
  give_fix(time);
  if (!outbox_.empty() || command_) send_next(time);
}

void MoosLink::on_welcome(const MoosMessage& message, Time time) {
  if (message.type == Type::kPoison) {
    events_.note("autopilot", fmt::format("MOOSDB at {} refuses {}: {}", config_.link, config_.client, message.text));
    ++report_.rejected["the MOOSDB refuses the client " + config_.client];
    stage_ = Stage::kClosed;
    link_->cut(kRefused);
    return;
  }
  if (message.type != Type::kWelcome) return;
  stage_ = Stage::kTalking;
  events_.note("autopilot", fmt::format("MOOSDB at {}, community {}", config_.link, message.community));
  for (const char* key : {"NAV_X", "NAV_Y", "NAV_HEADING", "NAV_DEPTH", "NAV_SPEED", "NAV_ALTITUDE", "LAT_ORIGIN",
                          "LONG_ORIGIN", "LON_ORIGIN", kOverrideKeys[0], kOverrideKeys[1]}) {
    MoosMessage wish = moos_number(key, 0, database_s(time));
    wish.type = Type::kRegister;
    put(std::move(wish));
  }
  const std::lock_guard lock(mutex_);
  heard_ = time;
  community_ = message.community;
  if (origin_) events_.locate(*origin_, LinkSource::Locates::kFirst);
}

/// The first answer after the registrations holds the state of what was registered: a pilot may have taken over while
/// the link was lost, and a database that has started anew knows nothing.
void MoosLink::on_state() {
  const std::lock_guard lock(mutex_);
  if (!std::exchange(connected_, true) && !override_told_) override_.reset();
}

void MoosLink::on_null(const MoosMessage& message, Time time) {
  if (!std::isfinite(message.value) || message.value <= 0) return;
  constexpr double kStep_s = 1;
  const double ahead_s = message.value - seconds_since_1970(time);  // what arrives late shows less
  const std::lock_guard lock(mutex_);
  const bool steps = !ahead_s_ || std::abs(ahead_s - *ahead_s_) > kStep_s;
  ahead_s_ = steps ? ahead_s : std::max(*ahead_s_, ahead_s);
}

double MoosLink::database_s(Time time) const {
  const std::lock_guard lock(mutex_);
  return seconds_since_1970(time) + ahead_s_.value_or(0);
}

void MoosLink::on_variable(const MoosMessage& message, Time time) {
  static const std::map<std::string, Value, std::less<>> kNumbers{
      {"NAV_X", kEast},          {"NAV_Y", kNorth},           {"NAV_HEADING", kHeading},
      {"NAV_DEPTH", kDepth},     {"NAV_SPEED", kSpeed},       {"NAV_ALTITUDE", kAltitude},
      {"LAT_ORIGIN", kLatitude}, {"LONG_ORIGIN", kLongitude}, {"LON_ORIGIN", kLongitude}};
  if (std::ranges::find(kOverrideKeys, message.key) != std::end(kOverrideKeys)) return on_override(message);
  const auto found = kNumbers.find(message.key);
  if (found != kNumbers.end()) on_number(found->second, message, time);
}

void MoosLink::on_number(Value value, const MoosMessage& message, Time time) {
  const bool is_origin = value == kLatitude || value == kLongitude;
  const double age_s = database_s(time) - message.time_s;
  if (message.kind != Kind::kNumber || !std::isfinite(message.value) || !std::isfinite(message.time_s) ||
      std::abs(message.value) > kFarthest) {
    ++report_.rejected[message.key + " that is no usable number"];
  } else if (!is_origin && age_s > kMaxAge_s) {
    ++report_.rejected[message.key + " that is old"];
  } else if (!is_origin && age_s < -kMaxAge_s) {
    ++report_.rejected[message.key + " from the future"];
  } else {
    readings_[value] = {message.value, message.time_s, true};
    if (value == kAltitude) give_altitude(readings_[value], time);
    if (is_origin) find_origin();
  }
}

void MoosLink::on_override(const MoosMessage& message) {
  const std::string text = lower_case(message.text);
  if (message.kind != Kind::kText || (text != "true" && text != "false")) {
    ++report_.rejected[message.key + " that is neither true nor false"];
    return;
  }
  const std::lock_guard lock(mutex_);
  override_ = text == "true";
  override_told_ = true;
}

void MoosLink::find_origin() {
  const Reading &latitude = readings_[kLatitude], &longitude = readings_[kLongitude];
  const GeoOrigin heard{latitude.value, longitude.value};
  const std::lock_guard lock(mutex_);
  if (origin_ || !latitude.is_new || !longitude.is_new || !valid(heard) || heard == GeoOrigin{}) return;
  origin_ = heard;
  events_.locate(heard, LinkSource::Locates::kFirst);
}

void MoosLink::give_fix(Time time) {
  const Reading &north = readings_[kNorth], &east = readings_[kEast], &heading = readings_[kHeading];
  const double now_s = database_s(time);
  const auto usable = [now_s](const Reading& r) { return r.time_s > 0 && now_s - r.time_s <= kMaxAge_s; };
  if (!north.is_new || !east.is_new || !heading.is_new || !usable(readings_[kDepth])) return;
  const auto [oldest_s, newest_s] = std::minmax({north.time_s, east.time_s, heading.time_s});
  if (newest_s - oldest_s > kTogether_s) return;
  for (const Value value : {kNorth, kEast, kHeading}) readings_[value].is_new = false;
  Navigation fix;
  fix.time = time - seconds(std::clamp(now_s - newest_s, 0.0, kMaxAge_s));
  const Angle direction = Angle::degrees(heading.value).wrapped();
  fix.X_WB = {Rotation::from_heading(direction), {north.value, east.value, readings_[kDepth].value}};
  if (const Reading& speed = readings_[kSpeed]; usable(speed))
    fix.v_WB = speed.value * Eigen::Vector3d(cos(direction), sin(direction), 0);
  {
    const std::lock_guard lock(mutex_);
    if (fix_ && fix.time <= *fix_) return;
    fix_ = fix.time;
  }
  if (gives_navigation_) events_.give(fix, time);
}

void MoosLink::give_altitude(const Reading& altitude, Time time) {
  RangeReading reading;
  reading.time = time - seconds(std::clamp(database_s(time) - altitude.time_s, 0.0, kMaxAge_s));
  reading.max_range_m = kMaxAltitude_m;
  reading.width = kAltimeterBeam;
  reading.X_BS.rotation = Rotation::from_heading_pitch_roll({}, Angle::degrees(-90), {});
  if (!(altitude.value > 0) || altitude.value >= kMaxAltitude_m) return;  // not measured
  reading.range_m = altitude.value;
  events_.give(reading, time);
}

Authority MoosLink::authority_at(Time now) const {
  if (!heard_ || now - *heard_ > kSilence) return Authority::kNoAutopilot;
  if (!fix_ || now - *fix_ > kSilence) return Authority::kDisarmed;
  return override_.value_or(true) || ended_ ? Authority::kOtherMode : Authority::kOurs;
}

std::string MoosLink::mode() const {
  const std::lock_guard lock(mutex_);
  if (!heard_) return "not heard";
  const char* const value = !override_ ? "not heard" : (*override_ ? "true" : "false");
  return fmt::format("MOOS_MANUAL_OVERRIDE {}", value);
}

std::optional<GeoOrigin> MoosLink::origin() const {
  const std::lock_guard lock(mutex_);
  return origin_;
}

void MoosLink::put(MoosMessage message, bool replaces) {
  if (replaces) std::erase_if(outbox_, [&](const MoosMessage& waiting) { return waiting.key == message.key; });
  message.source = config_.client;
  message.number = number_++;
  outbox_.push_back(std::move(message));
}

void MoosLink::put_setpoint(Time now) {
  if (!command_) return;
  const auto [setpoint, answers] = *std::exchange(command_, std::nullopt);
  if (!releases_setpoint(now, answers)) return;
  {
    const std::lock_guard lock(mutex_);
    steered_ = true;
  }
  stop_ = Stop::kNone;
  const double time_s = database_s(answers);
  put(moos_number("DESIRED_HEADING", setpoint.heading.wrapped_positive().degrees(), time_s));
  put(moos_number(kSpeedKey, std::max(0.0, setpoint.speed), time_s));
  put(moos_number("DESIRED_DEPTH", std::max(0.0, setpoint.depth), time_s));
}

void MoosLink::send_next(Time now) {
  put_setpoint(now);
  if (outbox_.empty()) outbox_.emplace_back();  // the null message only asks for an answer
  if (stop_ == Stop::kWaits) stop_ = Stop::kSent;
  link_->send(moos_packet(outbox_));
  outbox_.clear();
  waits_ = true;
  sent_ = now;
}

void MoosLink::report_health(Time now) {
  health_ = now;
  if (authority() == Authority::kNoAutopilot) return;
  events_.give(Health{.time = now, .source = "vehicle", .battery_share = 1, .note = mode()});
}

void MoosLink::on_tick(Time now) {
  if (now - health_ >= kHealthInterval) report_health(now);
  if (stage_ == Stage::kClosed) return;
  if (waits_ && now - sent_ > kSilence) {
    events_.refuse("autopilot: the MOOSDB did not answer");
    stage_ = Stage::kClosed;
    return link_->cut(kCut);
  }
  if (stage_ != Stage::kTalking) return;
  const Authority held = authority();
  if (std::exchange(told_, held) != held)
    say(held == Authority::kOurs ? 6 : 4, std::string("Isobath ") + story_of(held));
  {
    const std::lock_guard lock(mutex_);
    if (steered_ && held != Authority::kOurs && stop_ == Stop::kNone) stop_ = Stop::kWaits;
  }
  if (stop_ == Stop::kWaits) {
    command_.reset();
    put(moos_number(kSpeedKey, 0, database_s(now)));
  }
  if (!waits_ && (!outbox_.empty() || command_ || now - sent_ >= kPollInterval)) send_next(now);
}

bool MoosLink::command(const Setpoint& setpoint, const VehicleParameters& /*limits*/, Time answers) {
  {
    const std::lock_guard lock(mutex_);
    if (!admits_setpoint(hub_->now(), answers, connected_)) return false;
  }
  hub_->post([this, setpoint, answers] {
    if (stage_ != Stage::kTalking) return;
    command_ = Command{setpoint, answers};
    if (!waits_) send_next(hub_->now());
  });
  return true;
}

void MoosLink::say(int /*severity*/, const std::string& text) {
  hub_->post([this, line = text.substr(0, kMaxLine)] {
    const auto waiting = std::ranges::count(outbox_, kDecisionKey, &MoosMessage::key);
    if (stage_ == Stage::kTalking && waiting < static_cast<std::ptrdiff_t>(kMaxLines))
      put(moos_text(kDecisionKey, line, database_s(hub_->now())), false);
  });
}

void MoosLink::show(const Surroundings& around, const Navigation& /*fix*/, Time now) {
  if (shown_ && now - *shown_ < kShowInterval) return;
  shown_ = now;
  std::map<int, int> pieces;
  std::vector<std::string> texts;
  for (const Surroundings::Outline& obstacle : around.obstacles) {
    if (texts.size() == kMaxObstacles) break;
    const int piece = ++pieces[obstacle.number];
    const std::string label =
        piece == 1 ? fmt::format("isobath_{}", obstacle.number) : fmt::format("isobath_{}_{}", obstacle.number, piece);
    if (auto text = given_obstacle_text({obstacle.outline_W, label, kObstacleLasts_s}))
      texts.push_back(std::move(*text));
  }
  hub_->post([this, texts = std::move(texts)] {
    std::erase_if(outbox_, [](const MoosMessage& waiting) { return waiting.key == kObstacleKey; });
    if (stage_ != Stage::kTalking) return;
    for (const std::string& text : texts) put(moos_text(kObstacleKey, text, database_s(hub_->now())), false);
  });
}

void MoosLink::end() {
  std::unique_lock lock(mutex_);
  ended_ = true;
  stopped_.wait_for(lock, kEndPatience, [this] { return !steered_; });
}

}  // namespace isobath
