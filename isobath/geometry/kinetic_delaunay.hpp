// KineticDelaunay: a Delaunay triangulation of points in linear motion, kept valid from flip to flip (Rodin, Amin c.
// 1988, 2.1; ledger S3-07).
//
// Each edge has a certificate. With four finite corners it is the in-circle determinant, a polynomial of degree 4 in
// time; at the hull it is the turn of three corners, of degree 2. The next time at which a certificate fails is the
// time of the next flip; a priority queue holds these times. Two points that meet (come within 1e-6 of each other) are
// no flip: the triangulation is repaired once they have parted. Roots are found in doubles; at the end of `advance` all
// positions are checked by exact predicates, so that the result is Delaunay whatever the rounding, as if each point had
// been moved by DynamicDelaunay::move. `repairs` counts what the flips alone did not achieve.
//
// Units: m, s, m/s, or others that fit each other. Times rise. Cost: 27 us a flip (one core of 2.0 GHz).
// Memory: as DynamicDelaunay, and a queue of at most 16 entries a point. Errors: Error for a motion or a time that is
// not finite (velocities up to 1e6), and where a point would leave the 1e9 of DynamicDelaunay.
#pragma once

#include <array>
#include <cstdint>
#include <Eigen/Core>
#include <isobath/geometry/dynamic_delaunay.hpp>
#include <span>
#include <vector>

namespace isobath {

/// The edge between a and b gave way to that between c and d; one of them may be DynamicDelaunay::kNone, at infinity.
struct DelaunayFlip {
  double time_s = 0;
  int a = 0, b = 0, c = 0, d = 0;
};

class KineticDelaunay {
 public:
  explicit KineticDelaunay(int max_points);

  /// A point that is at `at` now.
  int insert(const Eigen::Vector2d& at, const Eigen::Vector2d& velocity, int label);
  void remove(int point);
  /// A point that is at `at` now and moves with `velocity` from now on.
  void set_motion(int point, const Eigen::Vector2d& at, const Eigen::Vector2d& velocity);
  void advance(double to_s);

  [[nodiscard]] double now_s() const { return now_s_; }
  [[nodiscard]] const DynamicDelaunay& triangulation() const { return delaunay_; }
  /// The flips of the last advance, in order of time.
  [[nodiscard]] std::span<const DelaunayFlip> flips() const { return flips_; }
  /// How often everything was inserted again, because points met or because of rounding.
  [[nodiscard]] std::int64_t repairs() const { return repairs_; }

 private:
  struct Motion {
    Eigen::Vector2d origin{0, 0}, velocity{0, 0};
    double since_s = 0;
  };
  struct Event {
    double time_s = 0;
    int triangle = 0, slot = 0;
    std::uint32_t stamp = 0, other_stamp = 0;  ///< of both triangles, when it was made
    bool meeting = false;
    double until_s = 0;  ///< when points that meet have parted
  };
  static bool later(const Event& a, const Event& b) { return a.time_s > b.time_s; }

  [[nodiscard]] Eigen::Vector2d place(int point, double time_s) const;
  void check(const Eigen::Vector2d& velocity) const;
  void certify(int triangle, int slot);
  void certify_meeting(int triangle, int slot, int other);
  void certify_changed();
  void certify_all();
  void push(const Event& event);
  [[nodiscard]] bool is_current(const Event& event) const;
  void flip(const Event& event);
  void settle(double time_s);

  DynamicDelaunay delaunay_;
  double now_s_ = 0;
  std::vector<Motion> motions_;
  std::vector<std::uint32_t> stamps_;  ///< by triangle, raised with each change
  std::vector<Event> queue_;           ///< a heap, the next event first; some have been overtaken
  std::size_t queue_limit_;
  std::vector<DelaunayFlip> flips_;
  std::vector<Eigen::Vector2d> places_;
  std::vector<int> todo_;
  std::int64_t repairs_ = 0;
};

}  // namespace isobath
