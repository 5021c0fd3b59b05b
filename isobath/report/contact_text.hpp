// The sounds that a run's passive array heard, in words, as JSON and as GeoJSON (passive_contacts.hpp). Lengths in m
// and directions in degrees clockwise from north, to a thousandth; frequencies in Hz.
#pragma once

#include <isobath/geometry/geodesy.hpp>
#include <isobath/onboard/passive_contacts.hpp>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace isobath {

/// Without the times of the lines.
nlohmann::ordered_json contacts_json(const ContactOutcome& heard);
/// One line of text a sound, each with its end.
std::string contact_lines(const ContactOutcome& heard);
/// The same as one paragraph.
std::string contact_paragraph(const ContactOutcome& heard);
/// For each sound a line from the last listening position: to the obstacle that it is attached to, else in the
/// direction of the sound as far as its place by bearings alone, or kFar_m; and a point at that place.
std::string contacts_geojson(const ContactOutcome& heard, const GeoOrigin& origin);

}  // namespace isobath
