#include <algorithm>
#include <cmath>
#include <isobath/run/mission_desk.hpp>
#include <nlohmann/json.hpp>
#include <utility>

namespace isobath {
namespace {

using nlohmann::ordered_json;
using Kind = OperatorCommand::Kind;

constexpr std::size_t kMaxOrders = 16;

double centimetres_of(double metres) { return std::round(metres * 100) / 100; }

ordered_json leg_json(const PreviewLeg& leg) {
  ordered_json json{{"why", leg.why}};
  if (leg.way.empty()) return json;
  for (const Eigen::Vector2d& p : leg.way) json["way_m"].push_back({centimetres_of(p.x()), centimetres_of(p.y())});
  json["length_m"] = centimetres_of(leg.length_m);
  json["unknown_m"] = centimetres_of(leg.unknown_m);
  if (std::isfinite(leg.clearance_m)) {
    json["margin_m"] = centimetres_of(leg.clearance_m);
    json["nearest"] = leg.nearest;
  }
  if (leg.may_drop) json["may_drop"] = true;
  return json;
}

/// What is wrong, without the key of a mission file.
std::string problem_text(const Error& error) {
  const std::string text = error.what(), key = error.where().text() + ": ";
  return text.starts_with(key) ? text.substr(key.size()) : text;
}

std::string json_line(const ordered_json& json) {
  return json.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace

MissionDesk::~MissionDesk() {
  stop_ = true;
  if (worker_.valid()) worker_.wait();
}

void MissionDesk::open(const MissionSetup& setup, const MissionConfig& config) {
  in_force_.begin(setup.plan);
  const std::lock_guard lock(mutex_);
  config_ = config;
  vehicle_ = setup.vehicle;
}

void MissionDesk::on_message(const Envelope& envelope) {
  in_force_.on_message(envelope);
  const std::lock_guard lock(mutex_);
  known_.on_message(envelope.message, envelope.time);
}

std::optional<OperatorCommand> MissionDesk::next() {
  const std::lock_guard lock(mutex_);
  if (orders_.empty()) return std::nullopt;
  OperatorCommand order = std::move(orders_.front());
  orders_.pop_front();
  return order;
}

void MissionDesk::close() {
  const std::lock_guard lock(mutex_);
  over_ = true;
}

std::string MissionDesk::order(OperatorCommand command) {
  const std::lock_guard lock(mutex_);
  if (over_) return "the mission is over";
  if (!config_) return "this run takes no commands";
  const auto waits = [](const OperatorCommand& waiting) { return waiting.kind != Kind::kHandOver; };
  if (std::ranges::any_of(orders_, waits)) return "the previous command is still pending";
  orders_.push_back(std::move(command));
  return {};
}

void MissionDesk::hand_over(const std::string& sentence) {
  const std::lock_guard lock(mutex_);
  if (over_ || orders_.size() >= kMaxOrders) return;
  orders_.push_back({Kind::kHandOver, nullptr, sentence});
}

MissionPlan MissionDesk::checked(const MissionDraft& draft) const {
  const MissionInForce::Given given = in_force_.given();
  if (!given.plan) throw Error("the run has no mission");
  if (draft.mission != given.number) throw Error("the mission has changed since this draft was begun; begin again");
  MissionPlan plan = plan_of(draft, *given.plan);
  const std::lock_guard lock(mutex_);
  known_.check_place(plan);
  return plan;
}

std::string MissionDesk::send(const MissionDraft& draft, const std::string& by) {
  try {
    return order({Kind::kNewMission, std::make_shared<const MissionPlan>(checked(draft)), by});
  } catch (const Error& error) {
    return problem_text(error);
  }
}

std::string MissionDesk::preview(const MissionDraft& draft, std::uint64_t page) {
  {
    const std::lock_guard lock(mutex_);
    if (over_) return "the mission is over";
    if (planning_) return "another preview is being planned; ask again";
    planning_ = true;
    page_ = page;
    answer_.reset();
  }
  worker_ = std::async(std::launch::async, [this, draft] {
    std::string answer = planned(draft);
    const std::lock_guard lock(mutex_);
    answer_ = std::move(answer);
    planning_ = false;
  });
  return {};
}

std::string MissionDesk::planned(const MissionDraft& draft) const {
  ordered_json json;
  try {
    const auto plan = std::make_shared<const MissionPlan>(checked(draft));
    std::unique_lock lock(mutex_);
    const MissionKnowledge known = known_;
    const MissionConfig config = config_.value();
    lock.unlock();
    const auto until = std::chrono::steady_clock::now() + kMaxPreview;
    const auto give_up = [&] { return stop_ || std::chrono::steady_clock::now() > until; };
    json["legs"] = ordered_json::array();
    for (const PreviewLeg& leg : preview_of(known, plan, config, vehicle_, give_up)) {
      json["legs"].push_back(leg_json(leg));
    }
    json["clearance_m"] = config.route.clearance_m;
  } catch (const Error& error) {
    json = {{"problem", problem_text(error)}};
  } catch (const std::exception& error) {
    json = {{"problem", error.what()}};
  }
  return json_line(json);
}

std::optional<std::string> MissionDesk::preview_text(std::uint64_t page) {
  const std::lock_guard lock(mutex_);
  return page == page_ ? std::exchange(answer_, std::nullopt) : std::nullopt;
}

}  // namespace isobath
