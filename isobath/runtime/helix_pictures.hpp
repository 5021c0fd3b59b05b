// What an approach by helix looks like (helix_study.hpp), as PNG.
#pragma once

#include <filesystem>
#include <isobath/runtime/helix_study.hpp>
#include <string>

namespace isobath {

/// The helix with the unit vectors T, N, B of its Serret-Frenet frame, in parallel projection from abaft (ledger S5-56,
/// S5-D08), and where a vehicle that follows it is.
std::string helix_frames_picture(const EllipticHelix& helix, const Convergence& convergence);
/// Distance from the path and Lyapunov value of the path-following law, by time.
std::string convergence_chart(const HelixStudy& study);
/// Known share of the opening by the distance before it: helix and straight (S5-40, S5-D09).
std::string known_share_chart(const HelixStudy& study);
/// Bits a voxel that the map does not know yet (S5-58).
std::string entropy_chart(const HelixStudy& study);
/// Heading off the line and pitch (S5-44, S5-D07).
std::string swing_chart(const HelixStudy& study);
/// The opening's face seen from the vehicle, by the distance from where each part was known.
std::string opening_picture(const HelixStudy& study, const ApproachLog& log, const std::string& title);
/// The way flown from above, to the opening and through it or away.
std::string approach_picture(const HelixStudy& study);
/// Share known after one turn against the stretch of the way (S5-46).
std::string worth_chart(const HelixStudy& study);

/// The pictures and report.html with all of them; returns the names of the files. Throws Error where it cannot write.
std::vector<std::filesystem::path> write_helix_report(const HelixStudy& study, const std::filesystem::path& folder);

}  // namespace isobath
