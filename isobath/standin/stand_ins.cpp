#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/standin/stand_ins.hpp>
#include <limits>
#include <thread>

namespace isobath {
namespace {

constexpr std::uint16_t kWaypoint = 16, kChangeSpeed = 178, kPolygonIn = 5001;

std::int32_t to_e7(double degrees) { return static_cast<std::int32_t>(std::lround(degrees * 1e7)); }

/// With the speed of the cables and the usual link.
StandInRequest completed(StandInRequest request) {
  request.unplug.speed = request.speed;
  const bool moos = request.front_seat == FrontSeatKind::kMoos;
  if (request.autopilot.empty()) request.autopilot = moos ? "tcp-server:9000" : "udp:127.0.0.1:14550";
  return request;
}

GeoOrigin known_origin(const Scenario& scenario) {
  const auto origin = scenario.scene.origin();
  if (!origin)
    throw Error("the scene has no place on the globe", scenario.mission.place, "latitude_deg, longitude_deg");
  if (scenario.mission.points.empty()) throw Error("the scene has no mission", scenario.mission.place);
  return *origin;
}

std::unique_ptr<FrontSeatStandIn> make_front_seat_stand_in(const Scenario& scenario, const StandInRequest& request) {
  const GeoOrigin origin = known_origin(scenario);
  if (request.front_seat == FrontSeatKind::kMoos)
    return std::make_unique<MoosStandIn>(request.guided_after_s, request.turns, request.unplug);
  auto autopilot = std::make_unique<AutopilotStandIn>(autopilot_plan(scenario.mission, origin), origin,
                                                      request.guided_after_s, request.turns, request.unplug);
  if (request.key) autopilot->sign_with(*request.key);
  return autopilot;
}

}  // namespace

AutopilotPlan autopilot_plan(const MissionPlan& plan, const GeoOrigin& origin) {
  const LocalPlane plane(origin);
  const auto placed = [&](std::uint16_t command, const Eigen::Vector2d& north_east, double depth_m) {
    const GeoPoint point = plane.to_geo(north_east);
    mavlink::MissionItem item;
    item.command = command;
    item.x = to_e7(point.latitude_deg);
    item.y = to_e7(point.longitude_deg);
    item.z = static_cast<float>(-depth_m);
    return item;
  };
  AutopilotPlan out;
  out.mission.push_back(placed(kWaypoint, Eigen::Vector2d::Zero(), 0));  // home
  mavlink::MissionItem speed;
  speed.command = kChangeSpeed;
  speed.params = {1, static_cast<float>(plan.speed), -1, 0};
  out.mission.push_back(speed);
  for (const MissionPoint& point : plan.points) {
    mavlink::MissionItem item = placed(kWaypoint, point.north_east, point.depth_m);
    item.params = {static_cast<float>(point.hold_s), static_cast<float>(point.radius_m), 0,
                   std::numeric_limits<float>::quiet_NaN()};
    out.mission.push_back(item);
  }
  for (const Eigen::Vector2d& corner : plan.fence) {
    mavlink::MissionItem item = placed(kPolygonIn, corner, 0);
    item.params[0] = static_cast<float>(plan.fence.size());
    out.fence.push_back(item);
  }
  for (auto* list : {&out.mission, &out.fence}) {
    for (std::size_t i = 0; i < list->size(); ++i) (*list)[i].sequence = static_cast<std::uint16_t>(i);
  }
  return out;
}

StandIns::StandIns(const Scenario& scenario, const StandInRequest& request)
    : request_(completed(request)),
      source_(scenario.scene, request.simulation),
      truth_(source_.simulator()),
      hub_(request.speed),
      autopilot_(make_front_seat_stand_in(scenario, request_)) {
  source_.tell_truth_to(truth_);
  autopilot_->use(hub_, hub_.add(link_address_of(request_.autopilot, "--autopilot"), *autopilot_));
  std::uint64_t stream = 1;
  for (const StandInRequest::Device& device : request.devices) {
    auto& made =
        *devices_.emplace_back(make_device_stand_in(device.kind, request_.unplug, stream++, known_origin(scenario)));
    made.use(hub_, hub_.add(link_address_of(device.link, "--device"), made));
    announce(device);
  }
  hub_.start();
  began_ = std::chrono::steady_clock::now();
}

/// How the device lets itself be found, if it does.
void StandIns::announce(const StandInRequest::Device& device) {
  const LinkAddress address = link_address_of(device.link, "--device");
  if (device.kind == DeviceKind::kOculus) {
    auto& beacon = *beacons_.emplace_back(std::make_unique<OculusBeacon>(address));
    beacon.use(hub_.add(link_address_of(request_.oculus_status, "--oculus-status"), beacon));
  }
  if (device.kind == DeviceKind::kPing360 && !request_.ping360_discovery.empty()) {
    auto& finder = *finders_.emplace_back(std::make_unique<Ping360Finder>(address));
    finder.use(hub_.add(link_address_of(request_.ping360_discovery, "--ping360-discovery"), finder));
  }
}

bool StandIns::step() {
  if (!request_.stays && autopilot_->deserted()) return false;
  Simulator& simulator = source_.simulator();
  for (const auto& device : devices_) {
    if (const auto command = device->take_command()) simulator.command_scanning(*command);
  }
  simulator.command(autopilot_->setpoint(simulator.now_s() - steered_s_));
  steered_s_ = simulator.now_s();
  const auto event = source_.next();
  if (!event) return false;
  std::this_thread::sleep_until(began_ + std::chrono::duration<double>(to_seconds(time_of(*event)) / request_.speed));
  const Time now = hub_.now();
  if (const auto* fix = std::get_if<Navigation>(&*event)) autopilot_->on_fix(*fix, now);
  if (const auto* health = std::get_if<Health>(&*event); health && health->source == "vehicle")
    autopilot_->on_battery(health->battery_share);
  for (const auto& device : devices_) device->on_event(*event, now);
  return true;
}

}  // namespace isobath
