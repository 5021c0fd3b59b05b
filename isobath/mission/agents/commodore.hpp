// Commodore: the group level of a vehicle: shares the lanes of a search area with the other vehicles of the group, over
// an acoustic link that loses and delays packets (Herman 1988, 2, 3.1; ledger S2-02, S2-10, S2-17, S2-25, S2-50,
// S2-51).
//
// Receives MissionOrder, PointReport, MissionReport, Navigation, ObstacleScan, RoutePlanned, FollowOrder,
// WaypointPassed and LinkFrame (from the group). Sends VisitOrder, PassageWait, GroupHazards, GroupObstacles, LinkFrame
// (to the group), LevelPlan and Decision. Does nothing in a mission without a search area or without a group.
//
// Every vehicle has a Commodore; that of the first vehicle in the list that is heard and can sail leads. It divides the
// lanes (lane_sharing.hpp), numbers the plan, and sends it. The others follow the plan of the first vehicle that they
// hear. The first plan needs no packet: all vehicles make it from the places where the mission expects them to start.
//
// Leading: every `replan_s` the leader divides the lanes that no vehicle has sailed or is sailing. The new plan
// replaces the old one if the last vehicle is done earlier by kGain and kGain_s, or if the old one gives a lane to a
// vehicle that is lost or whose mission has ended. While nothing happens, the plan stays (S2-25).
//
// Link: each vehicle has a slot of `slot_s` in turn, by the time of day, and sends one packet in it: its status, or as
// leader, in every other slot while somebody has not confirmed the newest plan, the plan. A vehicle that was not heard
// for `lost_turns` turns of all slots counts as lost, until it is heard again. What was sailed is merged from every
// packet, so lost and repeated packets do no harm.
//
// Each status also tells of obstacles that the own sonar has confirmed near lanes that are still to be sailed, those
// first that were told least often, each at most kTellings times; one that has moved by more than kMoved_m is told
// anew. What others tell goes to the FLS Detector. What lies where a vehicle of the group is may be that vehicle: it is
// neither told nor believed.
//
// Stations that a vehicle told to have visited before it was lost are not visited again: the lane is resumed at the
// last of them.
//
// Where the area has `together_s`, each vehicle goes to its waiting place and says that it is ready. When all are that
// the leader hears, it sets a time kAhead_turns turns ahead at which all begin, so that the others hear of it; each
// vehicle passes it on. After `together_s` from the start of the mission a vehicle waits no longer (S2-19).
//
// Passages: the vehicles of a group go through a [[passage]] of the mission one at a time (passage_turns.hpp). The gate
// keeper, the first vehicle in the list that is heard, gives the turn to the vehicle that asked first; the turn is over
// when the vehicle asks for it no more, or was not heard for half of `passage_wait_s`. A new gate keeper knows from the
// status of each vehicle which ones are in a passage (S2-17).
//
// No way: a lane of which kNoWayPoints stations in a row had no route is given up by this vehicle; after kNoWayLanes
// such lanes in a row it gives all its lanes to the others. Once no vehicle of the group finds a way, the Captain ends
// the mission (S2-17).
//
// A lane is done when its last station is reached, or dropped because of an obstacle. Once all are done, the vehicle
// ends its mission as the plan says; until then one without a lane goes to its waiting place and may get another lane.
#pragma once

#include <isobath/mission/agents/passage_turns.hpp>
#include <isobath/mission/messages/agent.hpp>
#include <isobath/mission/messages/group_words.hpp>
#include <isobath/mission/messages/plan_clock.hpp>
#include <isobath/mission/plan/lane_sharing.hpp>
#include <isobath/mission/plan/timing_table.hpp>
#include <map>
#include <optional>
#include <set>

namespace isobath {

struct CommodoreConfig {
  double slot_s = 5;
  int lost_turns = 6;
  double replan_s = 10;
  double turn_s = 10;      ///< for a turn into the next lane, beyond the way
  int told_obstacles = 3;  ///< at most, in one packet; 0: none
  double passage_wait_s = 300;
};
std::vector<Field> fields(CommodoreConfig& config);

class Commodore final : public Agent {
 public:
  static constexpr double kGain = 0.1, kGain_s = 20;

  static constexpr int kTellings = 8;
  static constexpr double kMoved_m = 1, kAhead_turns = 4;
  static constexpr int kNoWayPoints = 2, kNoWayLanes = 2;

  explicit Commodore(const CommodoreConfig& config, const TimingTable& timing = {})
      : config_(config), plans_(CommandLevel::kGroup, timing.of(CommandLevel::kGroup).replan_s) {}

  void on_message(const Message& message, Time now, Outbox& out) override;
  void tick(Time now, Outbox& out) override;

 private:
  struct Member {
    Time heard;          ///< last; at first the start of the mission
    GroupStatus status;  ///< the last
    bool lost = false;
    Time asked;  ///< when its present ask was first heard
  };
  /// An obstacle that the own sonar has confirmed.
  struct Sighting {
    Eigen::Vector2d centre_W;
    double radius_m = 0;
    int tellings = 0;
  };
  void begin(const MissionOrder& order, Time now, Outbox& out);
  void on(const PointReport& report, Time now, Outbox& out);
  void on(const ObstacleScan& scan);
  [[nodiscard]] std::vector<ObstacleWord> obstacles_to_tell();
  void on_frame(const LinkFrame& frame, Time now, Outbox& out);
  void on(const GroupStatus& status, Time now, Outbox& out);
  void on(const GroupPlan& plan, Time now, Outbox& out);
  void note_heard(std::size_t vehicle, Time now, Outbox& out);
  void watch(Time now, Outbox& out);
  void note_way(const Message& message, Time now);
  void note_no_way(std::size_t point, Time now, Outbox& out);
  void give_up_lane(Time now, Outbox& out);
  void give_up_if_all_do(Time now, Outbox& out);
  [[nodiscard]] bool takes_lanes(std::size_t vehicle) const;
  [[nodiscard]] const std::optional<PassageAsk>& ask_of(std::size_t vehicle) const;
  void pass(Time now, Outbox& out);
  [[nodiscard]] std::size_t gate_keeper() const;
  void give_turns(Time now, Outbox& out);
  void take_turn(Time now, Outbox& out);
  void end_wait(const std::string& why, Outbox& out);
  void hear_turns(const GroupStatus& status, Time now, Outbox& out);
  [[nodiscard]] bool sails(std::size_t vehicle) const;
  /// The first vehicle that is heard and can sail.
  [[nodiscard]] std::optional<std::size_t> leader() const;
  [[nodiscard]] std::optional<std::size_t> lane_of(std::size_t vehicle) const;
  [[nodiscard]] LaneSailor sailor_of(std::size_t vehicle) const;
  [[nodiscard]] double rest_s() const;
  void lead(Time now, Outbox& out);
  void take(const GroupPlan& plan, const std::string& why, Time now, Outbox& out);
  void note_station(std::size_t point);
  void note_stations(const GroupStatus& status);
  void state_stations(GroupStatus& status) const;
  [[nodiscard]] bool is_left(std::size_t point) const;
  [[nodiscard]] std::optional<std::size_t> waiting_place(const Eigen::Vector2d& from_W) const;
  [[nodiscard]] bool is_sailed_by_another(std::size_t lane) const;
  void say_hazards(Outbox& out);
  void meet(Time now, Outbox& out);
  void begin_lanes(const char* what, const std::string& why, Time now, Outbox& out);
  [[nodiscard]] double turn_s() const { return config_.slot_s * static_cast<double>(members_.size()); }
  void order(const std::string& why, Time now, Outbox& out);
  void send(Time now, Outbox& out);
  [[nodiscard]] bool is_done(std::size_t lane) const { return (done_ >> lane & 1U) != 0; }
  [[nodiscard]] bool all_done() const;
  [[nodiscard]] std::string name_of_vehicle(std::size_t vehicle) const { return plan_->group[vehicle].name; }
  static void decide(Time now, const char* what, std::string reason, Outbox& out);

  CommodoreConfig config_;
  std::shared_ptr<const MissionPlan> plan_;  ///< null: nothing to share
  std::vector<Lane> lanes_;
  std::size_t own_ = 0;
  std::vector<Member> members_;
  Eigen::Vector2d here_W_ = Eigen::Vector2d::Zero();
  double sigma_m_ = 0;
  LaneBits done_ = 0;
  std::optional<GroupPlan> shared_;              ///< that is followed
  std::size_t stations_ = 0;                     ///< of a lane
  std::optional<std::size_t> lane_;              ///< that is being sailed
  std::vector<std::size_t> visits_;              ///< points that are ordered and not visited yet
  std::vector<char> visited_;                    ///< by point: whether some vehicle is known to have visited it
  std::vector<Hazard> hazards_;                  ///< as last told
  std::map<std::uint32_t, Sighting> sightings_;  ///< by the id of the remembered obstacle
  PassageTurns passages_{{}, 0};
  bool told_wait_ = false;                              ///< the vehicle waits before a passage
  std::map<std::size_t, PassageTurn> turns_;            ///< by passage, as gate keeper
  Time asked_;                                          ///< its own present ask
  std::uint32_t follow_version_ = 0;                    ///< of the way that is ahead
  std::size_t passed_ = 0;                              ///< way-points of it
  std::set<std::size_t> without_way_;                   ///< stations that it found no way to
  LaneBits given_up_ = 0;                               ///< lanes likewise
  int points_without_way_ = 0, lanes_without_way_ = 0;  ///< in a row
  bool no_way_ = false, told_given_up_ = false;
  PlanClock plans_;
  std::uint32_t orders_ = 0;
  std::uint16_t number_ = 0;
  bool over_ = false, told_done_ = false, plan_last_ = false, at_waiting_place_ = false;
  bool meets_ = false;  ///< it goes to its waiting place, or waits there, until all begin
  bool ready_ = false;
  Time started_;                  ///< the mission
  std::optional<Time> begin_at_;  ///< as agreed
  std::optional<Time> replanned_;
  std::optional<std::int64_t> sent_in_;  ///< number of the turn in which it last sent
};

}  // namespace isobath
