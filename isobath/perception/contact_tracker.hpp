// ContactTracker: follows each frequency line that a passive array hears, and says which known obstacle it comes from,
// if any (Auran, Silven 1995, 3.1, who leave it out; ledger S4-54).
//
// A bearing belongs to the line whose frequency is nearest, within `gate_cells` frequency cells of the array, and whose
// last bearing it can follow: it lies within five standard deviations, and within what the vehicle's way since then can
// have turned it if the sound is at least kNearest_m away. The frequency of a line follows slowly, so that Doppler
// shift and a machine that changes its speed do not break it. Two machines at one frequency are two lines if their
// directions differ.
//
// Bearings that were taken within `move_m` of each other become one: their own errors average out, to no less than a
// tenth; the share `bias_share` of the stated deviation counts as a bias of the array that all bearings have in common,
// and so does the error of the heading. Bearings are therefore not independent while the vehicle stays where it is
// (bearing_posterior.hpp). A line keeps at most kPlaces such places; where there are more, the two nearest neighbours
// join. The position of a place relative to the obstacles is as uncertain as the navigation's variance has changed
// since, or by `drift_share` of the way where it states none.
//
// A priori a sound comes from no known obstacle with the probability `prior_none`, and from each of the known ones with
// an equal share of the rest. The contact is attached to an obstacle, or to none, while the posterior is at least
// `level`; below it, it is detached. The place of the sound by its bearings alone is given if its standard deviation
// along the longer axis is at most kPlaced of its distance; else it is unknown.
//
// At most kLines lines; bearings of further ones are counted. A line of less than `min_bearings` that has been silent
// for kSilent_s makes room. Frame W, m. Deterministic. One thread. hear() allocates nothing; update() does. Cost of
// update(): 11 ms a line on one core, at most once in `interval_s`. Sounds that move are not followed. Two machines at
// one frequency whose directions differ by less than about 20 degrees become one line.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <isobath/base/config.hpp>
#include <isobath/base/time.hpp>
#include <isobath/map/occupancy/obstacle_memory.hpp>
#include <isobath/perception/bearing_posterior.hpp>
#include <isobath/sonar/passive_bearing.hpp>
#include <optional>
#include <span>
#include <vector>

namespace isobath {

struct ContactConfig {
  bool on = true;
  double gate_cells = 4;
  double move_m = 1;
  int min_bearings = 5;
  double bias_share = 0.5;
  double max_range_m = 300;
  double beyond_m = 6;
  double prior_none = 0.5;
  double level = 0.95;
  double interval_s = 2;
  double drift_share = 0.02;
};
std::vector<Field> fields(ContactConfig& config);

/// The pose at which a bearing was taken, with its uncertainty as the navigation states it.
struct ListeningPose {
  Pose X_WB;
  double sigma_m = 0;        ///< of the position in the plane; 0: not stated
  double heading_sigma = 0;  ///< rad; 0: not stated
};

/// One frequency line.
struct Contact {
  enum class Origin : std::uint8_t { kUnknown, kObstacle, kNone };

  int number = 0;  ///< from 1, in the order in which lines were first heard
  double frequency_hz = 0;
  double snr_db = 0;           ///< of the last bearing
  std::uint64_t bearings = 0;  ///< heard so far
  Time first, last;
  Eigen::Vector2d p_W = Eigen::Vector2d::Zero();  ///< of the array at the last bearing
  Angle bearing;                                  ///< in W, mean of the bearings at the last place
  Angle sigma;                                    ///< of that mean, bias included
  double none = 1;                                ///< probability that it comes from no known obstacle
  int likeliest = 0;                              ///< number of the likeliest obstacle; 0: none is likely
  double probability = 0;                         ///< that it comes from that one
  Origin origin = Origin::kUnknown;
  int obstacle = 0;                      ///< that it is attached to; 0: none
  Eigen::Vector2d nearest = p_W;         ///< point of the likeliest obstacle nearest to p_W
  std::uint64_t attached_after = 0;      ///< bearings at the first attachment to an obstacle; 0: never attached
  std::uint64_t changes = 0;             ///< of origin or obstacle
  std::optional<SoundPlace> place = {};  ///< by the bearings alone; empty: unknown
};

/// "unknown", "obstacle", "none".
const char* to_text(Contact::Origin origin);

class ContactTracker {
 public:
  static constexpr std::size_t kLines = 16, kPlaces = 32;
  static constexpr double kNearest_m = 5, kSilent_s = 30, kPlaced = 0.25;

  explicit ContactTracker(const ContactConfig& config);

  /// In order of time.
  void hear(const PassiveBearing& heard, const ListeningPose& pose);
  /// The estimated position jumped: what was heard from moves along, m in W.
  void move(const Eigen::Vector2d& by_W);
  /// Whether bearings came since the last update and `interval_s` has passed.
  [[nodiscard]] bool is_due(Time now) const;
  /// Judges every line anew by the obstacles as they are known now.
  void update(Time now, std::span<const RememberedObstacle> known);

  /// Lines with at least min_bearings bearings, by number. Valid until the next call.
  [[nodiscard]] std::span<const Contact> contacts() const { return contacts_; }
  [[nodiscard]] std::uint64_t bearings() const { return bearings_; }
  /// Bearings that found no line and no room for one, or came from straight above or below.
  [[nodiscard]] std::uint64_t left_out() const { return left_out_; }

 private:
  struct Heard {  ///< the bearings of one place
    Eigen::Vector2d p_W;
    double bearing, weight;  ///< weight: inverse variance of their own errors
    double least_variance;
    double variance_m2, way_m;  ///< of the position, and the way without a stated variance, at that time
  };
  struct Line {
    Contact contact;  ///< number 0: this line is not in use
    double last_bearing = 0, last_sigma = 0;
    double sigma = 0;           ///< stated by the array, the largest
    std::vector<Heard> places;  ///< the last one is where the vehicle was last
  };
  /// An obstacle: the convex pieces that share its number.
  struct Known {
    int number;
    std::vector<const Polygon*> pieces;
    double margin_m;
  };
  [[nodiscard]] Line* line_of(const PassiveBearing& heard, double bearing, const Eigen::Vector2d& p_W);
  Line* new_line(const PassiveBearing& heard);
  void add_place(Line& line, const Heard& heard) const;
  static void join(Heard& into, const Heard& other);
  void gather(std::span<const RememberedObstacle> known);
  [[nodiscard]] double place_bearings(const Line& line);
  void judge(Line& line);
  [[nodiscard]] static Eigen::Vector2d nearest_of(const Known& obstacle, const Eigen::Vector2d& p_W);
  void decide(Contact& contact) const;

  ContactConfig config_;
  std::vector<Line> lines_;  ///< kLines
  std::vector<Contact> contacts_;
  std::vector<Known> known_;  ///< by number
  std::vector<BearingFrom> from_;
  std::vector<double> evidence_;
  std::optional<Eigen::Vector2d> place_;
  double variance_m2_ = 0, way_m_ = 0, heading_sigma_ = 0;
  int last_number_ = 0;
  std::uint64_t bearings_ = 0, left_out_ = 0, judged_ = 0;
  std::optional<Time> updated_;
};

}  // namespace isobath
