#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <isobath/io/bytes/log_source.hpp>
#include <isobath/io/bytes/text_lines.hpp>
#include <isobath/io/formats/nmea_decoder.hpp>
#include <isobath/io/input/survey_input.hpp>

namespace isobath {
namespace {

constexpr std::size_t kMaxFields = 40;
constexpr std::size_t kMaxSentence = 256;
constexpr double kKnot = 1852.0 / 3600;  // m/s
constexpr double kMoving = 0.5;          // m/s: at lower speeds, the course is noise of the receiver
constexpr Duration kHeadingAge = std::chrono::seconds(5);
constexpr Angle kBeamWidth = Angle::degrees(7);

/// The fields of a sentence; field 0 is talker and type.
class Fields {
 public:
  explicit Fields(std::string_view body) {
    for (TextRow row(body, ','); count_ < kMaxFields && row.next(field_[count_]);) ++count_;
  }
  [[nodiscard]] std::string_view operator[](std::size_t i) const { return i < count_ ? field_[i] : std::string_view(); }
  [[nodiscard]] std::optional<double> number(std::size_t i) const {
    double value = 0;
    std::string_view text = trimmed((*this)[i]);
    if (text.starts_with('+')) text.remove_prefix(1);
    return parse_number(text, value) ? std::optional(value) : std::nullopt;
  }
  [[nodiscard]] std::string_view name() const { return field_[0]; }
  [[nodiscard]] std::string_view type() const { return field_[0].size() == 5 ? field_[0].substr(2) : field_[0]; }

 private:
  std::array<std::string_view, kMaxFields> field_;
  std::size_t count_ = 0;
};

std::optional<int> digits(std::string_view text, std::size_t at) {
  int value = 0;
  return at + 2 <= text.size() && parse_number(text.substr(at, 2), value) && value >= 0 ? std::optional(value)
                                                                                        : std::nullopt;
}

/// Time since midnight from "092211.00". 60 seconds are allowed (leap second), 24 hours are not.
std::optional<Duration> time_of_day(std::string_view text) {
  text = trimmed(text);
  const auto h = digits(text, 0), m = digits(text, 2);
  double s = 0;
  if (!h || !m || *h > 23 || *m > 59 || !parse_number(text.substr(4), s) || s < 0 || s >= 61) return std::nullopt;
  return std::chrono::hours(*h) + std::chrono::minutes(*m) + seconds(s);
}

std::optional<std::chrono::sys_days> date_of(int year, int month, int day) {
  using namespace std::chrono;
  if (year < 1980 || year > 2200 || month < 1 || day < 1 || month > 12 || day > 31) return std::nullopt;
  const year_month_day date(std::chrono::year(year), std::chrono::month(static_cast<unsigned>(month)),
                            std::chrono::day(static_cast<unsigned>(day)));
  return date.ok() ? std::optional(sys_days(date)) : std::nullopt;
}

/// The date of RMC, such as "200715".
std::optional<std::chrono::sys_days> date_of_rmc(std::string_view text) {
  text = trimmed(text);
  const auto d = digits(text, 0), m = digits(text, 2), y = digits(text, 4);
  if (text.size() != 6 || !d || !m || !y) return std::nullopt;
  return date_of(*y + (*y < 80 ? 2000 : 1900), *m, *d);
}

std::optional<std::chrono::sys_days> date_of_zda(const Fields& f) {
  const auto d = f.number(2), m = f.number(3), y = f.number(4);
  const auto whole = [](double x) { return x >= 0 && x < 3000 && x == std::floor(x); };
  if (!d || !m || !y || !whole(*d) || !whole(*m) || !whole(*y)) return std::nullopt;
  return date_of(static_cast<int>(*y), static_cast<int>(*m), static_cast<int>(*d));
}

/// Degrees from degrees and minutes with a hemisphere, such as "5759.097", "N".
std::optional<double> degrees_of(std::string_view text, std::string_view hemisphere, std::string_view both) {
  double value = 0;
  hemisphere = trimmed(hemisphere);
  if (!parse_number(text, value) || value < 0 || value > 18000 || hemisphere.size() != 1) return std::nullopt;
  const auto side = both.find(hemisphere.front());
  const double degrees = std::floor(value / 100), minutes = value - degrees * 100;
  if (side == std::string_view::npos || minutes >= 60) return std::nullopt;
  return (side == 0 ? 1 : -1) * (degrees + minutes / 60);
}

std::optional<GeoPoint> point_of(const Fields& f, std::size_t at) {
  const auto latitude = degrees_of(f[at], f[at + 1], "NS"), longitude = degrees_of(f[at + 2], f[at + 3], "EW");
  return latitude && longitude ? std::optional(GeoPoint{*latitude, *longitude}) : std::nullopt;
}

/// Converts times of day to times of the log.
class NmeaClock {
 public:
  explicit NmeaClock(bool dated) : dated_(dated) {}

  void set_date(std::chrono::sys_days date, Duration time_of_day) {
    date_ = date;
    at_date_ = time_of_day;
  }
  /// Empty while no date is known in a log that has dates.
  std::optional<Time> at(Duration time_of_day) {
    if (!dated_) return days_.at(time_of_day);
    if (!date_) return std::nullopt;
    constexpr Duration kHalfDay = std::chrono::hours(12);
    int days = 0;  // from the stated date to this time
    if (time_of_day < at_date_ - kHalfDay) days = 1;
    if (time_of_day > at_date_ + kHalfDay) days = -1;
    return Time{date_->time_since_epoch() + std::chrono::days(days) + time_of_day};
  }

 private:
  bool dated_;
  std::optional<std::chrono::sys_days> date_;
  Duration at_date_{};
  DayClock days_;
};

int checksum_of(std::string_view body) {
  int sum = 0;
  for (const char c : body) sum ^= static_cast<unsigned char>(c);
  return sum;
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

/// Headings of several kinds, the best first, each with the time of its last value.
class HeadingChoice {
 public:
  enum Kind : std::uint8_t { kTrue, kMagnetic, kCourse, kKinds };
  void set(Kind kind, Angle heading, Time time) { last_[kind] = {heading, time}; }
  [[nodiscard]] Angle at(Time time) const {
    for (const auto& last : last_) {
      if (last && time - last->second <= kHeadingAge) return last->first;
    }
    return last_[kCourse] ? last_[kCourse]->first : Angle();
  }

 private:
  std::array<std::optional<std::pair<Angle, Time>>, kKinds> last_;
};

}  // namespace

struct NmeaDecoder::State {
 public:
  State(const InputConfig& config, SourceReport& report, Times times)
      : report_(report),
        survey_(config.survey),
        fixes_(survey_, report_),
        times_(times),
        clock_(times == Times::kDated),
        width_(config.beam_width.radians() > 0 ? config.beam_width : kBeamWidth) {
    report_.details["sonar"] = fmt::format("echo sounder, beam assumed {:g} degrees wide", width_.degrees());
  }

  std::optional<Event> event(const NmeaSentence& sentence, Time arrival);
  void count_unused() { report_.details["other sentences"] = fmt::format("{}, and {} of AIS", unused_, encapsulated_); }

 private:
  std::optional<Event> parse(const Fields& f);
  std::optional<Event> position(const Fields& f, std::size_t time, std::size_t point, bool valid);
  std::optional<Event> depth(const Fields& f);
  bool clock_was_wrong(Time older);
  void heading(const Fields& f);
  void ground_course(std::optional<double> course_deg, std::optional<double> knots);
  void accuracy(const Fields& f);
  void compare_clocks(Duration time_of_day);
  /// The time of an event now; empty: not known yet.
  [[nodiscard]] std::optional<Time> time() const { return times_ == Times::kHost ? std::optional(arrival_) : now_; }

  SourceReport& report_;
  SurveyInput survey_;
  BoatFixes fixes_;
  Times times_;
  NmeaClock clock_;
  Angle width_;
  HeadingChoice headings_;
  Time arrival_{};
  std::optional<Time> now_, last_fix_;  ///< by the sentences
  std::optional<Eigen::Vector3d> v_WB_;
  std::optional<Eigen::Vector2d> position_variance_;
  int far_older_ = 0;    ///< positions in a row that are much older than the clock
  std::string sounder_;  ///< talker and type of the depth sentences in use
  std::uint64_t unused_ = 0, encapsulated_ = 0;
};

std::optional<Event> NmeaDecoder::State::event(const NmeaSentence& sentence, Time arrival) {
  using Kind = NmeaSentence::State;
  arrival_ = arrival;
  if (sentence.state == Kind::kNoChecksum) ++report_.rejected["sentence without a checksum"];
  if (sentence.state == Kind::kWrongChecksum) ++report_.rejected["sentence with a wrong checksum"];
  if (sentence.state == Kind::kOther) ++encapsulated_;
  if (sentence.state != Kind::kGood) return std::nullopt;
  return parse(Fields(sentence.body));
}

std::optional<Event> NmeaDecoder::State::parse(const Fields& f) {
  const std::string_view type = f.type();
  if (type == "RMC" || type == "ZDA") {
    const auto date = type == "RMC" ? date_of_rmc(f[9]) : date_of_zda(f);
    const auto time = time_of_day(f[1]);
    if (date && time) clock_.set_date(*date, *time);
  }
  if (type == "RMC") {
    const bool valid = f[2] == "A";
    if (valid) ground_course(f.number(8), f.number(7));
    return position(f, 1, 3, valid);
  }
  if (type == "GGA" || type == "GNS") {
    const std::string_view quality = f[6];
    const bool none = quality.empty() || quality == "0" || quality == "7" || quality == "8";
    return position(f, 1, 2, type == "GNS" ? quality.find_first_not_of('N') != std::string_view::npos : !none);
  }
  if (type == "GLL") return position(f, 5, 1, f[6] == "A");
  if (type == "DPT" || type == "DBT" || type == "DBS") return depth(f);
  if (type == "ZDA") {
    const auto time = time_of_day(f[1]);
    const auto at = time ? clock_.at(*time) : std::nullopt;
    if (at && (!now_ || *at > *now_)) now_ = at;
  } else if (type == "VTG") {
    const bool lettered = f[2] == "T";
    ground_course(f.number(1), f.number(lettered ? 5 : 3));
  } else if (type == "GST") {
    accuracy(f);
  } else if (type == "HDT" || type == "THS" || type == "VHW" || type == "HDG" || type == "HDM") {
    heading(f);
  } else {
    ++unused_;
  }
  return std::nullopt;
}

std::optional<Event> NmeaDecoder::State::position(const Fields& f, std::size_t time, std::size_t point, bool valid) {
  const auto of_day = time_of_day(f[time]);
  const auto at = of_day ? clock_.at(*of_day) : std::nullopt;
  const auto where = point_of(f, point);
  const auto refused = [&](const char* reason) {
    ++report_.rejected[reason];
    return std::nullopt;
  };
  if (!valid || !where) return refused("invalid position");
  if (!at) return refused("position without a time");
  if (now_ && *at < *now_ && !clock_was_wrong(*at)) return refused("position older than the clock");
  if (last_fix_ && *at == *last_fix_) return refused("repeat of a position");
  const Time stamp = times_ == Times::kHost ? arrival_ : *at;
  auto fix = fixes_.fix(stamp, *where, Rotation::from_heading(headings_.at(stamp)));
  if (!fix) return refused("invalid position");
  now_ = last_fix_ = at;
  if (times_ == Times::kHost) compare_clocks(*of_day);
  far_older_ = 0;
  fix->v_WB = v_WB_;
  if (position_variance_) fix->covariance->diagonal().head<2>() = *position_variance_;
  return *fix;
}

/// True after many positions in a row that are much older: then a wrong date has set the clock ahead.
bool NmeaDecoder::State::clock_was_wrong(Time older) {
  constexpr int kEnough = 20;
  if (*now_ - older > std::chrono::minutes(1)) ++far_older_;
  return far_older_ > kEnough;
}

std::optional<Event> NmeaDecoder::State::depth(const Fields& f) {
  const bool dpt = f.type() == "DPT";
  const auto value = f.number(dpt ? 1 : 3);
  const auto refused = [&](const char* reason) {
    ++report_.rejected[reason];
    return std::nullopt;
  };
  if (!sounder_.empty() && f.name() != sounder_) return refused("depth of another sentence or talker");
  if (!value || !(*value > 0) || *value >= kAnyDepth) return refused("no bottom");
  if (sounder_.empty()) {
    sounder_ = f.name();
    report_.details["depths"] = sounder_;
  }
  if (!time()) return refused("depth before the first time");
  const double offset = dpt ? f.number(2).value_or(0) : 0;
  double transducer = survey_.transducer_depth_m;
  if (transducer == 0) transducer = offset > 0 && offset < 100 ? offset : 0;
  RangeReading reading;
  reading.time = *time();
  reading.range_m = f.type() == "DBS" ? *value - transducer : *value;
  if (*reading.range_m <= 0) return refused("depth above the transducer");
  report_.note_setting("transducer", fmt::format("{:g} m below the water", transducer));
  reading.max_range_m = kAnyDepth;
  reading.width = width_;
  reading.X_BS = looking_down(transducer);
  return reading;
}

void NmeaDecoder::State::heading(const Fields& f) {
  const std::string_view type = f.type();
  const auto value = f.number(1);
  if (!time() || !value || std::abs(*value) > 360 || (type == "THS" && f[2] == "V")) return;
  double degrees = *value;
  const bool magnetic = type == "HDG" || type == "HDM";
  if (type == "HDG") {
    const auto signed_part = [&](std::size_t at) { return f.number(at).value_or(0) * (f[at + 1] == "W" ? -1 : 1); };
    degrees += signed_part(2) + (survey_.declination == Angle() ? signed_part(4) : 0);
  }
  if (magnetic) degrees += survey_.declination.degrees();
  headings_.set(magnetic ? HeadingChoice::kMagnetic : HeadingChoice::kTrue, Angle::degrees(degrees), *time());
}

void NmeaDecoder::State::ground_course(std::optional<double> course_deg, std::optional<double> knots) {
  if (!course_deg || !knots || std::abs(*course_deg) > 360 || !(*knots >= 0 && *knots < 200)) return;
  const Angle course = Angle::degrees(*course_deg);
  const double speed = *knots * kKnot;
  v_WB_ = Eigen::Vector3d(speed * cos(course), speed * sin(course), 0);
  if (speed > kMoving) headings_.set(HeadingChoice::kCourse, course, time().value_or(Time{}));
}

void NmeaDecoder::State::compare_clocks(Duration time_of_day) {
  constexpr Duration kDay = std::chrono::hours(24);
  Duration behind = arrival_.time_since_epoch() % kDay - time_of_day;
  if (behind > kDay / 2) behind -= kDay;
  if (behind < -kDay / 2) behind += kDay;
  report_.details["clock"] = fmt::format("{:.1f} s behind the host's", to_seconds(behind));
}

void NmeaDecoder::State::accuracy(const Fields& f) {
  const auto north = f.number(6), east = f.number(7);
  if (north && east && *north > 0 && *east > 0 && *north < 1e5 && *east < 1e5) {
    position_variance_ = Eigen::Vector2d(*north * *north, *east * *east);
  }
}

NmeaSentence sentence_of(std::string_view line) {
  using State = NmeaSentence::State;
  line = trimmed(line);
  const std::size_t begin = line.find_last_of("$!");
  if (begin == std::string_view::npos || line.size() - begin > kMaxSentence) return {};
  const bool encapsulated = line[begin] == '!';
  line.remove_prefix(begin + 1);
  if (line.size() < 5) return {};
  const std::size_t star = line.rfind('*');
  if (star == std::string_view::npos) return {State::kNoChecksum, {}};
  if (star + 3 != line.size()) return {State::kWrongChecksum, {}};
  const std::string_view body = line.substr(0, star);
  const int sum = checksum_of(body);
  const int high = hex_digit(line[star + 1]), low = hex_digit(line[star + 2]);
  if (high < 0 || low < 0 || sum != high * 16 + low) return {State::kWrongChecksum, {}};
  return {encapsulated ? State::kOther : State::kGood, body};
}

bool states_date(const NmeaSentence& sentence) {
  if (sentence.state != NmeaSentence::State::kGood) return false;
  const Fields f(sentence.body);
  return (f.type() == "RMC" && date_of_rmc(f[9])) || (f.type() == "ZDA" && date_of_zda(f));
}

std::string nmea_line(std::string_view body) { return fmt::format("${}*{:02X}\r\n", body, checksum_of(body)); }

NmeaDecoder::NmeaDecoder(const InputConfig& config, SourceReport& report, Times times)
    : state_(std::make_unique<State>(config, report, times)) {}

NmeaDecoder::~NmeaDecoder() = default;

std::optional<Event> NmeaDecoder::event(const NmeaSentence& sentence, Time arrival) {
  return state_->event(sentence, arrival);
}

void NmeaDecoder::count_unused() { state_->count_unused(); }

}  // namespace isobath
