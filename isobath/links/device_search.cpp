#include <algorithm>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/io/formats/oculus/oculus_status.hpp>
#include <isobath/io/formats/ping/ping_discovery.hpp>
#include <isobath/links/device_search.hpp>
#include <thread>

namespace isobath {
namespace {

constexpr std::chrono::milliseconds kPoll{20};

/// The same device, bridged by this machine, may answer at its address on the vehicle's network, too.
constexpr std::string_view kHere = "udp:127.0.0.1:", kVehicle = "udp:192.168.2.2:";

bool answers_here(const Speaker& speaker, const std::vector<Speaker>& all) {
  if (!speaker.link.starts_with(kVehicle)) return false;
  const std::string here = std::string(kHere) + speaker.link.substr(kVehicle.size());
  return std::ranges::any_of(all, [&](const Speaker& s) { return s.device == speaker.device && s.link == here; });
}

}  // namespace

std::vector<std::string> usual_links() {
  return {"udp-server:14550",
          "udp-server:14551",
          fmt::format("udp-server:0.0.0.0:{}", kOculusStatusPort),
          "udp-server:10110",
          fmt::format("udp:255.255.255.255:{}", kPing360DiscoveryPort),
          fmt::format("udp:127.255.255.255:{}", kPing360DiscoveryPort),
          std::string(kHere) + "9092",
          std::string(kVehicle) + "9092",
          std::string(kHere) + "9090",
          std::string(kVehicle) + "9090",
          "tcp:127.0.0.1:16171",
          "tcp:192.168.194.95:16171"};
}

SearchResult search_devices(const std::vector<std::string>& links, double search_s, double speed) {
  SearchResult result;
  std::vector<std::unique_ptr<LinkProbe>> probes;  // outlive the hub
  LinkHub hub(speed);
  for (const std::string& link : links) {
    const LinkAddress address = link_address_of(link, "--try");
    auto& probe = *probes.emplace_back(std::make_unique<LinkProbe>(address));
    try {
      probe.use(hub.add(address, probe));
    } catch (const Error& problem) {
      result.problems.emplace_back(problem.what());
      probes.pop_back();
    }
  }
  hub.start();
  const Time end = hub.now() + seconds(search_s);
  while (hub.now() < end) std::this_thread::sleep_for(kPoll);
  hub.stop();
  std::vector<Speaker> all;
  for (const auto& probe : probes) {
    if (auto speaker = probe->speaker()) all.push_back(std::move(*speaker));
  }
  std::stable_partition(all.begin(), all.end(), [](const Speaker& s) { return !s.device; });
  for (const Speaker& speaker : all) {
    if (!answers_here(speaker, all)) result.speakers.push_back(speaker);
  }
  return result;
}

DeviceTrial::DeviceTrial(const DeviceConfig& config, double speed)
    : config_(config),
      hub_(speed),
      source_([this] { return hub_.now(); }),
      device_(make_device_link(config_, source_)),
      began_(hub_.now()) {
  device_->use(hub_, hub_.add(link_address_of(config_.link, "link"), *device_));
  hub_.start();
}

double DeviceTrial::age_s() const { return to_seconds(hub_.now() - began_); }

std::optional<Event> DeviceTrial::next() {
  auto event = source_.next();
  if (!event || std::holds_alternative<Health>(*event)) return std::nullopt;
  if (const auto* ping = std::get_if<Ping>(&*event)) {
    ++pings_.count;
    pings_.detail = fmt::format("range {:.1f} m", ping->window.end_m());
  } else if (const auto* reading = std::get_if<RangeReading>(&*event)) {
    ++ranges_.count;
    ranges_.detail = reading->range_m ? fmt::format("the last {:.2f} m", *reading->range_m) : "the last without echo";
  } else if (const auto* fix = std::get_if<Navigation>(&*event)) {
    ++fixes_.count;
    const Eigen::Vector3d& p = fix->X_WB.translation;
    fixes_.detail = fmt::format("the last {:.1f} m north, {:.1f} m east, heading {:.0f} degrees", p.x(), p.y(),
                                fix->X_WB.rotation.heading().wrapped_positive().degrees());
  }
  last_ = source_.arrival();
  return event;
}

std::string DeviceTrial::summary() const {
  if (!last_) return "nothing came";
  std::string text;
  const auto say = [&](const Count& count, const char* name) {
    if (count.count == 0) return;
    text +=
        fmt::format("{}{:.1f} {} a second, {}", text.empty() ? "" : "; ", count.count / age_s(), name, count.detail);
  };
  say(pings_, "pings");
  say(ranges_, "ranges");
  say(fixes_, "positions");
  std::uint64_t refused = 0;
  for (const auto& [reason, count] : source_.report().rejected) refused += count;
  if (refused > 0) text += fmt::format("; {} messages refused", refused);
  return text + fmt::format("; {:.1f} s old", to_seconds(hub_.now() - *last_));
}

}  // namespace isobath
