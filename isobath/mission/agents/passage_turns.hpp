// PassageTurns: when a vehicle of a group asks for its turn in a passage, when it waits, and when it has gone
// through (Herman 1988, 3.1; ledger S2-17).
//
// A vehicle asks once its way leads through a passage and it will be there soon, early enough for the answer. If it
// comes within kWait_m before it has its turn, it waits there. It gives its turn back
// once it is through, if its way leads elsewhere, or if it is still farther than kWait_m and has found no way for
// kIdle_s. A vehicle that has waited longer than it may takes the passage for blocked, for the whole mission. The
// Commodore talks about asks and turns with the other vehicles. Frame W, m.
#pragma once

#include <isobath/base/time.hpp>
#include <isobath/mission/messages/group_words.hpp>
#include <optional>
#include <span>
#include <vector>

namespace isobath {

class PassageTurns {
 public:
  static constexpr double kWait_m = 30;    ///< before a passage
  static constexpr double kThrough_m = 3;  ///< a vehicle that is nearer to a passage is in it
  static constexpr double kIdle_s = 30;

  /// `longest_wait_s`: for one turn.
  PassageTurns(std::span<const GroupPassage> passages, double longest_wait_s);

  /// The way-points that are ahead; none: the vehicle holds its position.
  void set_way(std::vector<Eigen::Vector2d> way_W, Time now);
  /// While it waits: this is the way that it would go. The wait is over if it leads elsewhere.
  void offer_way(std::span<const Eigen::Vector2d> way_W);
  /// The first so many way-points are passed.
  void pass(std::size_t waypoints);
  /// The vehicle is here. `ahead_m`: how long before a passage, along its way, it asks.
  void move(const Eigen::Vector2d& here_W, double ahead_m, Time now);
  /// It is the vehicle's turn, for its present ask.
  void take_turn(Time now);
  /// It goes nowhere any more.
  void end();

  [[nodiscard]] const std::optional<PassageAsk>& ask() const { return ask_; }
  /// Whether the vehicle waits for its turn.
  [[nodiscard]] bool waits() const { return held_; }
  /// Whether a passage counts as blocked.
  [[nodiscard]] bool is_blocked(std::size_t passage) const;

 private:
  [[nodiscard]] double distance_m(std::size_t passage) const;
  /// From here along the way to the passage; empty: it does not lead there.
  [[nodiscard]] std::optional<double> along_m(std::span<const Eigen::Vector2d> way_W, std::size_t passage) const;
  void go_on(Time now);

  std::vector<Polygon> passages_;
  std::vector<char> blocked_;  ///< by passage: it has waited there too long
  double longest_wait_s_;
  std::vector<Eigen::Vector2d> way_W_;
  Eigen::Vector2d here_W_ = Eigen::Vector2d::Zero();
  std::optional<PassageAsk> ask_;
  bool held_ = false;  ///< it waits
  std::uint8_t asks_ = 0;
  Time since_;                      ///< it asked, or its turn began
  std::optional<Time> idle_since_;  ///< it has no way
};

}  // namespace isobath
