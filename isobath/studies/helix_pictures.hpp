// Pictures of an approach by helix (helix_study.hpp), as PNG.
#pragma once

#include <filesystem>
#include <isobath/studies/helix_study.hpp>
#include <string>

namespace isobath {

/// The helix with the unit vectors T, N, B of its Serret-Frenet frame, in parallel projection from astern (ledger
/// S5-56, S5-D08), and the track of a vehicle that follows it.
std::string helix_frames_picture(const EllipticHelix& helix, const Convergence& convergence);
/// Distance from the path and Lyapunov value of the path-following law, by time.
std::string convergence_chart(const HelixStudy& study);
/// Known share of the opening over the distance to it: helix and straight (S5-40, S5-D09).
std::string known_share_chart(const HelixStudy& study);
/// Entropy of the map, bits per voxel (S5-58).
std::string entropy_chart(const HelixStudy& study);
/// Heading off the line and pitch (S5-44, S5-D07).
std::string swing_chart(const HelixStudy& study);
/// The opening's face as seen from the vehicle, shaded by the distance at which each part became known.
std::string opening_picture(const HelixStudy& study, const ApproachLog& log, const std::string& title);
/// Plan view of the track to the opening, and through it or away.
std::string approach_picture(const HelixStudy& study);
/// Share known after one turn against the relative path length (S5-46).
std::string worth_chart(const HelixStudy& study);

/// Writes the pictures, and report.html with all of them; returns the names of the files. Throws Error on failure.
std::vector<std::filesystem::path> write_helix_report(const HelixStudy& study, const std::filesystem::path& folder);

}  // namespace isobath
