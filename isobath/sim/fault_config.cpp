#include <charconv>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/base/nearest_name.hpp>
#include <isobath/sim/fault_config.hpp>
#include <utility>

namespace isobath {
namespace {

const std::vector<std::pair<std::string, FaultKind>>& kinds() {
  static const std::vector<std::pair<std::string, FaultKind>> kNames = {
      {"off", FaultKind::kOff},
      {"stuck", FaultKind::kStuck},
      {"garbage", FaultKind::kGarbage},
      {"wrong_scale", FaultKind::kWrongScale},
      {"wrong_gain", FaultKind::kWrongGain},
      {"slow", FaultKind::kSlow},
      {"delayed", FaultKind::kDelayed},
      {"intermittent", FaultKind::kIntermittent},
      {"drifting", FaultKind::kDrifting},
      {"jump", FaultKind::kJump},
      {"blind_side", FaultKind::kBlindSide},
      {"saturated", FaultKind::kSaturated},
      {"leak", FaultKind::kLeak},
      {"battery", FaultKind::kBattery},
      {"thruster_loss", FaultKind::kThrusterLoss},
      {"clock_jump", FaultKind::kClockJump},
  };
  return kNames;
}

enum class SourceKind : std::uint8_t {
  kUnknown,
  kSonar,
  kReading,
  kThruster,
  kVehicle,
  kAgent,
  kPlanner,
  kLink,
  kHost
};

constexpr std::string_view kAgentPrefix = "agent.";

SourceKind kind_of(std::string_view source) {
  if (source.starts_with(kAgentPrefix)) {
    return source.size() > kAgentPrefix.size() ? SourceKind::kAgent : SourceKind::kUnknown;
  }
  if (source == "planner") return SourceKind::kPlanner;
  if (source == "link") return SourceKind::kLink;
  if (source == "health" || source == "disk") return SourceKind::kHost;
  const int number = number_of_source(source);
  const std::string_view name = source.substr(0, source.find('.'));
  if (number < 0) return SourceKind::kUnknown;
  if (name == "sonar") return SourceKind::kSonar;
  if (name == "altimeter") return SourceKind::kReading;
  if (name == "thruster") return SourceKind::kThruster;
  if (number > 0) return SourceKind::kUnknown;
  if (name == "vehicle") return SourceKind::kVehicle;
  for (const char* known : {"compass", "ahrs", "gyro", "dvl", "depth", "gps", "lbl", "navigation"}) {
    if (name == known) return SourceKind::kReading;
  }
  return SourceKind::kUnknown;
}

bool fits(FaultKind kind, SourceKind source) {
  const bool sensor = source == SourceKind::kSonar || source == SourceKind::kReading;
  switch (kind) {
    case FaultKind::kOff:
      return sensor || source == SourceKind::kAgent || source == SourceKind::kLink || source == SourceKind::kHost;
    case FaultKind::kStuck: return sensor || source == SourceKind::kAgent;
    case FaultKind::kWrongScale: return sensor || source == SourceKind::kPlanner;
    case FaultKind::kGarbage:
    case FaultKind::kSlow:
    case FaultKind::kDelayed: return sensor;
    case FaultKind::kIntermittent: return sensor || source == SourceKind::kLink;
    case FaultKind::kDrifting:
    case FaultKind::kJump: return source == SourceKind::kReading;
    case FaultKind::kWrongGain:
    case FaultKind::kBlindSide:
    case FaultKind::kSaturated: return source == SourceKind::kSonar;
    case FaultKind::kThrusterLoss: return source == SourceKind::kThruster;
    case FaultKind::kLeak:
    case FaultKind::kBattery:
    case FaultKind::kClockJump: return source == SourceKind::kVehicle;
  }
  return false;
}

/// The allowed amounts of a kind; empty if `amount` is one of them. Kinds without an amount allow only 0.
std::string wanted_amount(FaultKind kind, double amount) {
  const double size = std::abs(amount);
  switch (kind) {
    case FaultKind::kWrongScale:
    case FaultKind::kWrongGain:
      return amount >= 0.001 && amount <= 1000 && amount != 1 ? "" : "a factor 0.001 .. 1000, not 1";
    case FaultKind::kDelayed: return amount > 0 && amount <= 3600 ? "" : "seconds above 0, up to 3600";
    case FaultKind::kIntermittent:
    case FaultKind::kBattery:
    case FaultKind::kThrusterLoss: return amount > 0 && amount <= 1 ? "" : "a share above 0, up to 1";
    case FaultKind::kDrifting: return size > 0 && size <= 1000 ? "" : "-1000 .. 1000 a second, not 0";
    case FaultKind::kJump: return size > 0 && size <= 1e6 ? "" : "-1e6 .. 1e6, not 0";
    case FaultKind::kBlindSide: return size == 1 ? "" : "-1 (port) or 1 (starboard)";
    case FaultKind::kClockJump: return size > 0 && size <= 1e9 ? "" : "seconds, -1e9 .. 1e9, not 0";
    default: return amount == 0 ? "" : "none with this kind";
  }
}

}  // namespace

int number_of_source(std::string_view source) {
  const auto dot = source.find('.');
  if (dot == std::string_view::npos) return 0;
  const std::string_view digits = source.substr(dot + 1);
  int number = -1;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  const int highest = source.starts_with("thruster") ? FaultConfig::kMaxThrusters : 99;
  return error == std::errc() && end == digits.data() + digits.size() && number >= 1 && number <= highest ? number : -1;
}

void check_fault(const FaultConfig& f) {
  const auto at = [&](const char* key) {
    Place place = f.place;
    place.key = std::string("fault.") + key;
    return place;
  };
  const SourceKind source = kind_of(f.source);
  if (source == SourceKind::kUnknown) {
    throw Error("unknown source \"" + f.source + "\"", at("source"),
                "sonar, sonar.2 .., altimeter, altimeter.2 .., compass, ahrs, gyro, dvl, depth, gps, lbl, navigation, "
                "thruster, thruster.1 .. thruster.16, vehicle, agent.NAME, link, health, disk or planner",
                did_you_mean(f.source, {"sonar", "altimeter", "compass", "ahrs", "gyro", "dvl", "depth", "gps", "lbl",
                                        "navigation", "thruster", "vehicle", "link", "health", "disk", "planner"}));
  }
  const std::string kind = to_text(f.kind);
  if (!fits(f.kind, source)) throw Error(f.source + " cannot have the fault " + kind, at("kind"));
  if (const std::string wanted = wanted_amount(f.kind, f.amount); !wanted.empty()) {
    throw Error("invalid amount for " + kind, at("amount"), wanted);
  }
  const bool may_period =
      (f.kind == FaultKind::kIntermittent && source != SourceKind::kLink) || f.kind == FaultKind::kBattery;
  if (f.kind == FaultKind::kSlow && !(f.period_s > 0)) throw Error("slow needs a period", at("period_s"), "above 0 s");
  if (f.kind != FaultKind::kSlow && !may_period && f.period_s != 0) {
    throw Error(kind + " has no period", at("period_s"), "0");
  }
  const auto time = [](double s) { return s >= 0 && s <= 1e8; };
  if (!time(f.at_s) || !time(f.after_s) || !time(f.for_s) || !time(f.period_s)) {
    throw Error("a time is out of range", at("at_s"), "0 .. 1e8 s");
  }
  if (!f.when.empty() && f.at_s != 0) {
    throw Error("an event and a time are both given", at("at_s"), "", "use after_s to wait after the event");
  }
}

const char* to_text(FaultKind kind) {
  for (const auto& [name, k] : kinds()) {
    if (k == kind) return name.c_str();
  }
  return "";
}

std::vector<Field> fields(FaultConfig& c) {
  return {
      Field::text(
          "source", &c.source,
          "What fails: a sensor (sonar, sonar.2, dvl, ...), thruster.2, vehicle, agent.NAME, link, health, disk or "
          "planner."),
      Field::choice("kind", &c.kind, kinds(), "Kind of fault."),
      Field::real("at_s", &c.at_s, {0, 1e8}, "s", "Start of the fault, from the start of the run."),
      Field::text("when", &c.when, "Name of an event that starts the fault instead of at_s; empty: none."),
      Field::real("after_s", &c.after_s, {0, 1e8}, "s", "Delay after at_s or after the event."),
      Field::real("for_s", &c.for_s, {0, 1e8}, "s", "Duration; 0: to the end of the run."),
      Field::real("amount", &c.amount, {}, "",
                  "Size of the fault: a factor, a share, seconds or a rate, depending on the kind."),
      Field::real("period_s", &c.period_s, {0, 1e8}, "s",
                  "Period of a slow or intermittent fault; duration of a loss of charge."),
  };
}

SectionList section_list(std::vector<FaultConfig>& faults) {
  return {"fault", "A fault: what fails, how and when.", [&faults](const Place& place) {
            FaultConfig& fault = faults.emplace_back();
            fault.place = place;
            return fields(fault);
          }};
}

}  // namespace isobath
