#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/pending_file.hpp>
#include <isobath/report/html_report.hpp>
#include <isobath/report/plot/picture.hpp>
#include <isobath/studies/helix_pictures.hpp>
#include <limits>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr Colour kHelix = palette::kTrack, kStraightWay = palette::kObstacle;
constexpr Colour kTangent{0.0, 0.45, 0.7, 1}, kNormal{0.84, 0.37, 0.0, 1}, kBinormal{0.0, 0.62, 0.45, 1};
constexpr int kChartWidth = 760, kChartHeight = 420;

/// A scene in parallel projection, seen from astern, starboard and above; x ahead, y to starboard, z down.
class SpacePicture : public Canvas {
 public:
  SpacePicture(const Eigen::AlignedBox3d& box, int width_px, const std::string& title)
      : Canvas(width_px, height_of(box, width_px)), box_(box) {
    const Eigen::AlignedBox2d flat = flat_box(box);
    scale_ = (width_px - 2 * kMargin) / flat.sizes().x();
    corner_ = Vector2d(flat.min().x(), flat.max().y());
    text(kMargin, 24, title, 14, palette::kInk);
  }

  void path(const std::vector<Vector3d>& points, const Stroke& stroke) const {
    for (std::size_t i = 1; i < points.size(); ++i) segment(points[i - 1], points[i], stroke);
  }
  void segment(const Vector3d& a, const Vector3d& b, const Stroke& stroke) const {
    const Vector2d p = px(a), q = px(b);
    line(p.x(), p.y(), q.x(), q.y(), stroke);
  }
  void arrow(const Vector3d& from, const Vector3d& along, Colour colour) const {
    const Vector2d p = px(from), q = px(from + along);
    line(p.x(), p.y(), q.x(), q.y(), {colour, 2, false});
    const double length = (q - p).norm();
    if (length < 9) return;
    const Vector2d back = (p - q) / length, side(-back.y(), back.x());
    for (const double s : {-1.0, 1.0}) {
      const Vector2d barb = q + 7 * back + 3.2 * s * side;
      line(q.x(), q.y(), barb.x(), barb.y(), {colour, 2, false});
    }
  }
  void word(const Vector3d& at, const std::string& word, double dx, double dy, double align, Colour colour) const {
    const Vector2d p = px(at);
    text(p.x() + dx, p.y() + dy, word, 11, colour, align, true);
  }
  /// Draws the floor with a grid in metres, and the heights at the far left.
  void room(double step_m) const {
    const Vector3d a = box_.min(), b = box_.max();
    const Stroke faint{palette::kFaint, 0.6, false};
    for (double x = step_m * std::ceil(a.x() / step_m - 1e-9); x <= b.x() + 1e-9; x += step_m) {
      segment({x, a.y(), b.z()}, {x, b.y(), b.z()}, faint);
      word({x, b.y(), b.z()}, fmt::format("{:.0f}", x == 0 ? 0.0 : x), 4, 14, 0, palette::kInk);
    }
    for (double y = step_m * std::ceil(a.y() / step_m - 1e-9); y <= b.y() + 1e-9; y += step_m) {
      segment({a.x(), y, b.z()}, {b.x(), y, b.z()}, faint);
      word({a.x(), y, b.z()}, fmt::format("{:.6g}", y), -6, 8, 1, palette::kInk);
    }
    for (double z = 2 * std::ceil(a.z() / 2); z <= b.z() + 1e-9; z += 2) {
      segment({a.x(), a.y(), z}, {b.x(), a.y(), z}, faint);
      word({a.x(), a.y(), z}, fmt::format("{:.6g}", z == 0 ? 0.0 : -z), -8, 4, 1, palette::kInk);
    }
    segment({a.x(), a.y(), a.z()}, {a.x(), a.y(), b.z()}, faint);
    word({0.5 * (a.x() + b.x()), b.y(), b.z()}, "ahead (m)", 24, 34, 0, palette::kInk);
    word({a.x(), 0.5 * (a.y() + b.y()), b.z()}, "starboard (m)", -26, 30, 1, palette::kInk);
    word({a.x(), a.y(), a.z()}, "height (m)", 0, -12, 0.5, palette::kInk);
  }
  void legend(const std::vector<std::pair<Stroke, std::string>>& entries) const {
    double y = height_ - 14.0 - 18.0 * static_cast<double>(entries.size() - 1);
    for (const auto& [stroke, words] : entries) {
      line(kMargin, y - 4, kMargin + 26, y - 4, stroke);
      text(kMargin + 34, y, words, 11, palette::kInk);
      y += 18;
    }
  }

 private:
  static constexpr double kMargin = 64;
  static Vector2d flat(const Vector3d& p) {
    static const Angle turn = Angle::degrees(28), tilt = Angle::degrees(24);
    const double right = cos(turn) * p.x() + sin(turn) * p.y();
    const double away = cos(turn) * p.y() - sin(turn) * p.x();
    return {right, sin(tilt) * away + cos(tilt) * p.z()};  // down the page
  }
  static Eigen::AlignedBox2d flat_box(const Eigen::AlignedBox3d& box) {
    Eigen::AlignedBox2d flat_one;
    for (int i = 0; i < 8; ++i) {
      flat_one.extend(flat(box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i))));
    }
    return flat_one;
  }
  static int height_of(const Eigen::AlignedBox3d& box, int width_px) {
    const Vector2d size = flat_box(box).sizes();
    return static_cast<int>((width_px - 2 * kMargin) * size.y() / size.x()) + 190;
  }
  [[nodiscard]] Vector2d px(const Vector3d& p) const {
    const Vector2d at = flat(p);
    return {kMargin + scale_ * (at.x() - corner_.x()), height_ - 130 + scale_ * (at.y() - corner_.y())};
  }

  Eigen::AlignedBox3d box_;
  double scale_ = 1;
  Vector2d corner_ = Vector2d::Zero();
};

struct Series {
  std::vector<double> before, value;
};

/// The samples before the opening.
template <class Value>
Series series_of(const ApproachLog& log, const Value& value) {
  Series s;
  for (const ApproachSample& x : log.samples) {
    if (x.distance_m < 0) break;
    s.before.push_back(x.distance_m);
    s.value.push_back(value(x));
  }
  return s;
}

double start_of(const HelixStudy& study) { return study.helix.samples.front().distance_m; }

void mark_leaving(ChartPicture& chart, const HelixStudy& study) {
  if (study.helix.leave_m > 0) chart.mark(study.helix.leave_m, "helix left", palette::kInk);
}

}  // namespace

std::string helix_frames_picture(const EllipticHelix& helix, const Convergence& convergence) {
  constexpr double kTurns = 1.5, kArrow = 2.6;
  const double end = 2 * std::numbers::pi * kTurns;
  const double y = helix.lateral_m + kArrow, z = helix.vertical_m + kArrow;
  SpacePicture picture(Eigen::AlignedBox3d(Vector3d(-5, -y, -z), Vector3d(end * helix.advance_m, y, z)), 980,
                       fmt::format("Helix with A = {:g}, B = {:g}, C = {:g} m and its unit vectors T, N, B",
                                   helix.advance_m, helix.lateral_m, helix.vertical_m));
  picture.room(5);
  std::vector<Vector3d> way, shadow;
  for (int i = 0; i <= 400; ++i) {
    const Vector3d p = helix.at(end * i / 400).p;
    way.push_back(p);
    shadow.emplace_back(p.x(), p.y(), z);
  }
  picture.path(shadow, {{0.6, 0.62, 0.65, 0.8}, 2, false});
  std::vector<Vector3d> flown;
  for (const Vector3d& p : convergence.way) {
    if (p.x() <= end * helix.advance_m) flown.push_back(p);
  }
  picture.path(way, {palette::kInk, 2.4, false});
  picture.path(flown, {{0.8, 0.3, 0.6, 1}, 2, false});
  constexpr int kFrames = 19;
  for (int i = 0; i < kFrames; ++i) {
    const PathFrame frame = helix.frame(end * i / (kFrames - 1));
    picture.arrow(frame.p_W, kArrow * frame.R_WF.col(0), kTangent);
    picture.arrow(frame.p_W, kArrow * frame.R_WF.col(1), kNormal);
    picture.arrow(frame.p_W, kArrow * frame.R_WF.col(2), kBinormal);
  }
  picture.legend({{{kTangent, 3, false}, "T: along the path"},
                  {{kNormal, 3, false}, "N: towards the centre of curvature"},
                  {{kBinormal, 3, false}, "B: normal to both"},
                  {{{0.8, 0.3, 0.6, 1}, 2, false}, "a vehicle that starts off the helix and converges to it"},
                  {{{0.6, 0.62, 0.65, 0.8}, 2, false}, "projection of the helix onto the floor"}});
  return picture.png();
}

std::string convergence_chart(const HelixStudy& study) {
  ChartPicture chart(kChartWidth, kChartHeight, "Path following: distance (m, solid) and Lyapunov value (dashed)",
                     {"time (s)", 0, 45}, {"metres; Lyapunov value", 1e-12, 1e2, true});
  const std::vector<Colour> colours{kHelix, kStraightWay};
  for (std::size_t i = 0; i < study.convergence.size(); ++i) {
    const Convergence& c = study.convergence[i];
    const Vector3d& p = c.start_F;
    chart.curve(c.time_s, c.off_m, {colours[i % 2], 2.5, false},
                fmt::format("from ({:g}, {:g}, {:g}) m", p.x(), p.y(), p.z()));
    std::vector<double> lyapunov = c.lyapunov;  // down to where rounding begins
    for (double& v : lyapunov) v = v < 1e-12 ? std::numeric_limits<double>::quiet_NaN() : v;
    chart.curve(c.time_s, lyapunov, {colours[i % 2], 1.4, true}, "");
  }
  chart.finish();
  return chart.png();
}

std::string known_share_chart(const HelixStudy& study) {
  ChartPicture chart(kChartWidth, kChartHeight, "Share of the opening that both fans have seen",
                     {"distance before the opening (m)", start_of(study), 0}, {"share of its face (%)", 0, 104});
  const auto percent = [](const ApproachSample& s) { return 100 * s.known_share; };
  const Series helix = series_of(study.helix, percent), straight = series_of(study.straight, percent);
  const std::vector<double> ends{start_of(study), 0}, bar{90, 90};
  chart.curve(ends, bar, {palette::kFaint, 1.2, true}, "90 %");
  chart.curve(straight.before, straight.value, {kStraightWay, 2.5, false}, "straight");
  chart.curve(helix.before, helix.value, {kHelix, 2.5, false}, "helix");
  mark_leaving(chart, study);
  chart.finish();
  return chart.png();
}

std::string entropy_chart(const HelixStudy& study) {
  ChartPicture chart(kChartWidth, kChartHeight, "Entropy of the map of the water up to the opening",
                     {"distance before the opening (m)", start_of(study), 0}, {"entropy (bits per voxel)", 0, 1.04});
  const auto bits = [](const ApproachSample& s) { return s.bits_a_voxel; };
  const Series helix = series_of(study.helix, bits), straight = series_of(study.straight, bits);
  chart.curve(straight.before, straight.value, {kStraightWay, 2.5, false}, "straight");
  chart.curve(helix.before, helix.value, {kHelix, 2.5, false}, "helix");
  mark_leaving(chart, study);
  chart.finish();
  return chart.png();
}

std::string swing_chart(const HelixStudy& study) {
  ChartPicture chart(kChartWidth, kChartHeight, "Heading and pitch on the approach",
                     {"distance before the opening (m)", start_of(study), 0},
                     {"off the line, to starboard and up (deg)", -30, 30});
  const Series heading = series_of(study.helix, [](const ApproachSample& s) { return s.heading.degrees(); });
  const Series pitch = series_of(study.helix, [](const ApproachSample& s) { return s.pitch.degrees(); });
  chart.curve(heading.before, heading.value, {kHelix, 2.5, false}, "heading");
  chart.curve(pitch.before, pitch.value, {kStraightWay, 2.5, false}, "pitch");
  mark_leaving(chart, study);
  chart.finish();
  return chart.png();
}

std::string opening_picture(const HelixStudy& study, const ApproachLog& log, const std::string& title) {
  const Opening& o = study.opening;
  PlanPicture picture({-0.5 * o.height_m, 0.5 * o.height_m, -0.5 * o.width_m, 0.5 * o.width_m}, 620,
                      {title, "height (m)", "starboard of the middle (m)"});
  const OpeningView& view = log.view;
  const double from = start_of(study);
  const auto shade = [from](double distance) { return intensity_colour(std::clamp(distance / from, 0.0, 1.0)); };
  picture.raster([&](double x, double y) -> Colour {
    const int row = static_cast<int>((0.5 * o.height_m - x) / o.height_m * view.rows());
    const int column = static_cast<int>((y + 0.5 * o.width_m) / o.width_m * view.columns());
    const int since = view.known_since(std::clamp(row, 0, view.rows() - 1), std::clamp(column, 0, view.columns() - 1));
    if (since == 0) return {0.84, 0.84, 0.84, 1};
    return shade(log.look_distance_m[static_cast<std::size_t>(since - 1)]);
  });
  picture.finish({{shade(from), fmt::format("known to be free from {:.0f} m", from)},
                  {shade(0.66 * from), fmt::format("{:.0f} m", 0.66 * from)},
                  {shade(0.33 * from), fmt::format("{:.0f} m", 0.33 * from)},
                  {{0.84, 0.84, 0.84, 1}, "not known"}});
  return picture.png();
}

std::string approach_picture(const HelixStudy& study) {
  const double half = std::max(0.75 * study.opening.width_m, 12.0), from = start_of(study);
  PlanPicture picture({-from - 2, 12, -half, half}, 760,
                      {"The approach from above", "ahead of the opening (m)", "starboard of the line (m)"});
  const std::vector<Vector2d> line{{-from, 0}, {12, 0}};
  picture.polyline(line, {palette::kFaint, 1, true});
  for (const double side : {-1.0, 1.0}) {
    const double pylon = side * 0.5 * study.opening.width_m;
    const std::vector<Vector2d> block{{-1, pylon}, {-1, pylon + 3 * side}, {1, pylon + 3 * side}, {1, pylon}};
    picture.polygon(block, {palette::kInk, 1.5, false}, {0.3, 0.25, 0.2, 0.8});
  }
  std::vector<Vector2d> helix, rest;
  for (const ApproachSample& s : study.helix.samples) {
    const Vector2d p = s.p_O.head<2>();
    (s.phase == ApproachPhase::kHelix ? helix : rest).push_back(p);
  }
  if (!helix.empty()) rest.insert(rest.begin(), helix.back());
  picture.polyline(rest, {kStraightWay, 2.2, false});
  picture.polyline(helix, {kHelix, 2.2, false});
  if (study.helix.leave_m > 0) {
    picture.dot(rest.front(), 4, palette::kInk);
    picture.label(rest.front(), fmt::format("decision at {:.1f} m: {}", study.helix.leave_m,
                                            to_text(study.helix.samples.back().phase)));
  }
  picture.finish({{kHelix, "helix"}, {kStraightWay, "after the decision"}, {{0.3, 0.25, 0.2, 0.8}, "pylons"}});
  return picture.png();
}

std::string worth_chart(const HelixStudy& study) {
  double most = 1.05;
  for (const WorthPoint& w : study.worth) most = std::max(most, w.worth.stretch);
  ChartPicture chart(kChartWidth, kChartHeight, "One turn of a steady helix: benefit and cost",
                     {"path length of the helix over that of the line", 1, most},
                     {"share of the opening known (%)", 0, 104});
  const std::vector<Colour> colours{kHelix, kStraightWay, kBinormal};
  const std::vector<std::string> names{"flat: C = 0", "C = B / 2", "round: C = B"};
  const std::size_t each = study.worth.size() / names.size();
  for (std::size_t k = 0; k < names.size(); ++k) {
    std::vector<double> stretch, share;
    for (std::size_t i = k * each; i < (k + 1) * each; ++i) {
      stretch.push_back(study.worth[i].worth.stretch);
      share.push_back(100 * study.worth[i].worth.known_share);
    }
    chart.curve(stretch, share, {colours[k], 2.2, false}, names[k]);
    chart.points(stretch, share, colours[k], "");
  }
  chart.finish();
  return chart.png();
}

std::vector<std::filesystem::path> write_helix_report(const HelixStudy& study, const std::filesystem::path& folder) {
  make_folder(folder);
  HtmlReport page("Approach by helix",
                  fmt::format("An opening {:g} m wide and {:g} m high, approached by a helix and straight.",
                              study.opening.width_m, study.opening.height_m));
  std::vector<std::filesystem::path> files;
  const auto add = [&](const char* name, const std::string& png, const std::string& caption) {
    write_whole_file(folder / name, png);
    files.emplace_back(name);
    page.figure(png, caption);
  };
  std::vector<HtmlReport::Row> rows;
  for (const auto& [what, value] : helix_facts(study)) rows.push_back({what, value});
  page.table({"what", "value"}, rows);
  page.heading("Known parts of the opening");
  add("helix-known.png", known_share_chart(study), "Parts that both fans have seen at once, within their range.");
  page.begin_row();
  add("helix-opening.png", opening_picture(study, study.helix, "The opening, after the helix"),
      "Seen from the vehicle; the shade is the distance at which a part became known.");
  add("helix-opening-straight.png", opening_picture(study, study.straight, "The opening, after the straight approach"),
      "The same without the helix.");
  page.end_row();
  add("helix-entropy.png", entropy_chart(study), "Entropy of a map of the water from the start to the opening.");
  page.heading("The manoeuvre");
  page.begin_row();
  add("helix-approach.png", approach_picture(study), "Helix, decision, and the track after it.");
  add("helix-swing.png", swing_chart(study), "Amplitudes grow as the opening comes nearer.");
  page.end_row();
  add("helix-worth.png", worth_chart(study), "One dot for every half metre of B.");
  page.heading("Path following");
  add("helix-frames.png", helix_frames_picture(study.reference, study.convergence.back()),
      "The Serret-Frenet frame along a steady helix.");
  add("helix-errors.png", convergence_chart(study), "From two starts off the helix.");
  page.save(folder / "report.html");
  files.emplace_back("report.html");
  return files;
}

}  // namespace isobath
