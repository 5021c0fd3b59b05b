// Turning: whether a vehicle with a turning radius can follow a path of straight legs, and how it gets onto the first
// leg (ledger S6-52).
//
// Such a vehicle rounds a corner of angle phi on the circle of radius R that touches both legs, R tan(phi / 2) before
// and behind the corner. It can follow a path where these stretches do not overlap on any leg. From a heading to a
// place aside or behind, it takes an arc of that circle and then its tangent. The arc is given as legs round it whose
// corners, rounded with R, are the arc again, so that a path with its start turn is a path like any other.
//
// Frame: any level one; headings from x towards y, rad. Sides: +1 turns from x towards y, -1 the other way.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

namespace isobath {

/// Distance from the corner b of a -> b -> c to where the circle touches; infinite where the path turns back.
double tangent_length(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c, double radius);

/// Whether all corners have room on their legs. The ends need none.
bool corners_fit(std::span<const Eigen::Vector2d> way, double radius);

/// The arc at corner b as points on it; the arc is nowhere farther than `sag_m` from the chords between them.
std::vector<Eigen::Vector2d> rounded_corner(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                                            const Eigen::Vector2d& c, double radius, double sag_m);

/// Corners (at most 30 degrees each) of the turn from `start` with `heading` until `target` lies straight ahead; none
/// where it already does, to within `off_m` of side-step. Empty where the target lies within the turning circle of that
/// side.
std::optional<std::vector<Eigen::Vector2d>> turn_towards(const Eigen::Vector2d& start, double heading, double radius,
                                                         int side, const Eigen::Vector2d& target, double off_m);

}  // namespace isobath
