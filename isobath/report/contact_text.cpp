#include <cctype>
#include <cmath>
#include <fmt/format.h>
#include <isobath/io/exports/geojson.hpp>
#include <isobath/report/contact_text.hpp>
#include <nlohmann/json.hpp>

namespace isobath {

using nlohmann::ordered_json;

namespace {

constexpr double kFar_m = 100;  // length of a line of bearing to a sound of unknown distance

double thousandths(double value) { return std::round(value * 1e3) / 1e3; }

/// Standard deviation along the longer axis of the ellipse.
double longer_sigma(const SoundPlace& place) {
  const double half = 0.5 * place.covariance.trace();
  return std::sqrt(half + std::sqrt(std::max(0.0, half * half - place.covariance.determinant())));
}

std::string contact_words(const Contact& contact) {
  std::string text = origin_text(contact);
  if (!contact.place || contact.origin == Contact::Origin::kObstacle) return text;
  return text + fmt::format("; its bearings cross at north {:.1f}, east {:.1f} m, to {:.1f} m", contact.place->mean.x(),
                            contact.place->mean.y(), longer_sigma(*contact.place));
}

ordered_json line_json(const Contact& c) {
  ordered_json json{{"number", c.number},
                    {"frequency_hz", thousandths(c.frequency_hz)},
                    {"snr_db", thousandths(c.snr_db)},
                    {"bearings", c.bearings},
                    {"bearing_deg", thousandths(c.bearing.degrees())},
                    {"bearing_sigma_deg", thousandths(c.sigma.degrees())},
                    {"from_north_m", thousandths(c.p_W.x())},
                    {"from_east_m", thousandths(c.p_W.y())},
                    {"origin", to_text(c.origin)},
                    {"obstacle", c.obstacle > 0 ? ordered_json(c.obstacle) : ordered_json()},
                    {"likeliest", c.likeliest > 0 ? ordered_json(c.likeliest) : ordered_json()},
                    {"probability", c.probability},
                    {"none_probability", c.none},
                    {"attached_after", c.attached_after > 0 ? ordered_json(c.attached_after) : ordered_json()},
                    {"changes", c.changes},
                    {"nearest", nullptr},
                    {"crossing", nullptr}};
  if (c.likeliest > 0) {
    json["nearest"] = {{"north_m", thousandths(c.nearest.x())},
                       {"east_m", thousandths(c.nearest.y())},
                       {"range_m", thousandths((c.nearest - c.p_W).norm())}};
  }
  if (c.place) {
    json["crossing"] = {{"north_m", thousandths(c.place->mean.x())},
                        {"east_m", thousandths(c.place->mean.y())},
                        {"north_sigma_m", thousandths(std::sqrt(c.place->covariance(0, 0)))},
                        {"east_sigma_m", thousandths(std::sqrt(c.place->covariance(1, 1)))},
                        {"covariance_m2", thousandths(c.place->covariance(0, 1))}};
  }
  return json;
}

}  // namespace

ordered_json contacts_json(const ContactOutcome& heard) {
  ordered_json json{{"bearings", heard.bearings}, {"left_out", heard.left_out}, {"lines", ordered_json::array()}};
  for (const Contact& contact : heard.contacts) json["lines"].push_back(line_json(contact));
  return json;
}

std::string contact_lines(const ContactOutcome& heard) {
  std::string text;
  for (const Contact& contact : heard.contacts) text += contact_words(contact) + "\n";
  if (heard.contacts.empty()) text = fmt::format("{} passive bearings, too few of any sound\n", heard.bearings);
  if (heard.left_out > 0) text += fmt::format("{} passive bearings left out: too many sounds\n", heard.left_out);
  return text;
}

std::string contact_paragraph(const ContactOutcome& heard) {
  std::string text = "Passive array: ";
  for (const char c : contact_lines(heard)) text += c == '\n' ? std::string(". ") : std::string(1, c);
  text.pop_back();
  return text;
}

std::string contacts_geojson(const ContactOutcome& heard, const GeoOrigin& origin) {
  std::vector<GeoFeature> features;
  for (const Contact& c : heard.contacts) {
    Eigen::Vector2d to = c.p_W + kFar_m * Eigen::Vector2d(cos(c.bearing), sin(c.bearing));
    if (c.place) to = c.place->mean;
    if (c.obstacle > 0) to = c.nearest;
    GeoFeature line{{c.p_W, to}, {}, GeoShape::kLine};
    line.properties = {{"kind", std::string("bearing")},
                       {"number", std::int64_t{c.number}},
                       {"frequency_hz", thousandths(c.frequency_hz)},
                       {"bearings", static_cast<std::int64_t>(c.bearings)},
                       {"origin", std::string(to_text(c.origin))},
                       {"obstacle", std::int64_t{c.obstacle}},
                       {"probability", thousandths(c.probability)},
                       {"none_probability", thousandths(c.none)}};
    features.push_back(std::move(line));
    if (!c.place) continue;
    GeoFeature crossing{{c.place->mean}, {}, GeoShape::kPoint};
    crossing.properties = {{"kind", std::string("crossing")},
                           {"number", std::int64_t{c.number}},
                           {"frequency_hz", thousandths(c.frequency_hz)},
                           {"sigma_m", thousandths(longer_sigma(*c.place))}};
    features.push_back(std::move(crossing));
  }
  return geojson_text(features, origin);
}

}  // namespace isobath
