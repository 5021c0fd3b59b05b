// PassiveContacts: which obstacle of a run each sound comes from that its passive array hears (ledger S4-54).
//
// The obstacles are those that the body grid has confirmed, kept in the world by a memory of its own
// (obstacle_memory.hpp, with the settings of [memory]), because an obstacle that has left the grid still sounds. Their
// numbers are those of every other output. Obstacles within 2 m of each other count as one for a sound, because scans
// show a hull in parts: they get the number that a sound is attached to, else that of the part seen last. The memory
// begins with the first bearing: a run without a passive array keeps none. Frame W, m. One thread: the mapping thread.
#pragma once

#include <isobath/map/occupancy/obstacle_memory.hpp>
#include <isobath/mission/messages/messages.hpp>
#include <isobath/perception/contact_tracker.hpp>
#include <isobath/world/result_sinks.hpp>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace isobath {

/// What a run heard.
struct ContactOutcome {
  std::uint64_t bearings = 0;  ///< heard with a position
  std::uint64_t left_out = 0;  ///< of these, without a line (contact_tracker.hpp)
  std::vector<Contact> contacts;
};

/// "the sound at 120 Hz comes from obstacle 7, 31 m off at 043 degrees; probability 0.99".
std::string origin_text(const Contact& contact);

class PassiveContacts {
 public:
  PassiveContacts(const ContactConfig& config, const ObstacleMemoryConfig& memory);

  void on_bearing(const PassiveBearing& heard, const ListeningPose& pose);
  /// `sigma_m`: of the position; 0: not stated.
  void on_scan(const ScanResult& scan, double sigma_m);
  void on_jump(const Eigen::Vector2d& by_W);
  /// Judges the sounds by all obstacles known, if it is due, or at the end of a run. Returns whether it has.
  bool update(Time now, bool at_the_end = false);

  [[nodiscard]] std::span<const Contact> contacts() const { return tracker_.contacts(); }
  /// One decision for each sound whose origin changed in the last update.
  [[nodiscard]] const std::vector<Decision>& news() const { return news_; }
  /// Empty if no bearing was heard.
  [[nodiscard]] std::optional<ContactOutcome> outcome() const;

 private:
  ContactConfig config_;
  ObstacleMemory memory_;
  ContactTracker tracker_;
  Eigen::Vector2d jumped_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d here_ = Eigen::Vector2d::Zero();
  std::map<int, std::uint64_t> told_;  ///< changes of each contact that were told
  std::vector<Decision> news_;
};

}  // namespace isobath
