#include <cmath>
#include <fmt/format.h>
#include <isobath/base/angle.hpp>
#include <isobath/base/pending_file.hpp>
#include <isobath/io/exports/geojson.hpp>
#include <isobath/report/html_report.hpp>
#include <isobath/report/plot/picture.hpp>
#include <isobath/studies/track_study.hpp>

namespace isobath {
namespace {

constexpr int kTrackPlot = 760;  // px
constexpr Colour kReading{0.45, 0.47, 0.5, 0.35};

double course_deg(const Eigen::Vector2d& velocity) {
  return Angle::radians(std::atan2(velocity.y(), velocity.x())).wrapped_positive().degrees();
}

std::string tracks_csv(const TrackStudy& study) {
  std::string text = "number,time_s,north_m,east_m\n";
  for (const TrackCourse& course : study.courses) {
    for (std::size_t k = 0; k < course.times.size(); ++k) {
      text += fmt::format("{},{:.3f},{:.2f},{:.2f}\n", course.number, to_seconds(course.times[k]), course.p_W[k].x(),
                          course.p_W[k].y());
    }
  }
  return text;
}

std::string tracks_geojson(const TrackStudy& study) {
  std::vector<GeoFeature> features;
  for (const TrackCourse& course : study.courses) {
    GeoFeature feature;
    feature.outline = course.p_W;
    feature.shape = course.p_W.size() > 1 ? GeoShape::kLine : GeoShape::kPoint;
    feature.properties = {{"number", static_cast<std::int64_t>(course.number)},
                          {"readings", static_cast<std::int64_t>(course.times.size())},
                          {"from_s", to_seconds(course.times.front())},
                          {"to_s", to_seconds(course.times.back())},
                          {"speed", course.velocity_W.norm()},
                          {"course_deg", course_deg(course.velocity_W)},
                          {"still", course.lies_still()}};
    features.push_back(std::move(feature));
  }
  return geojson_text(features, *study.table.origin);
}

std::string tracks_picture(const TrackStudy& study) {
  Eigen::AlignedBox2d box;
  for (const PositionTable::Row& row : study.table.rows) box.extend(row.p_W);
  PlanPicture picture(frame_around(box), kTrackPlot, {"Tracks of bodies", "north (m)", "east (m)"});
  for (const PositionTable::Row& row : study.table.rows) picture.dot(row.p_W, 1, kReading);
  for (const TrackCourse& course : study.courses) {
    picture.polyline(course.p_W, {palette::kTrack, 1.5, false});
    picture.dot(course.p_W.back(), 3, course.lies_still() ? palette::kHidden : palette::kObstacle);
  }
  picture.finish({{kReading, "positions"},
                  {palette::kTrack, "tracks"},
                  {palette::kObstacle, "last place of a body that moves"},
                  {palette::kHidden, "last place of a body that lies still"}});
  return picture.png();
}

}  // namespace

std::vector<std::filesystem::path> write_tracks(const TrackStudy& study, const std::filesystem::path& folder) {
  make_folder(folder);
  std::vector<std::filesystem::path> files = {"tracks.csv", "tracks.png"};
  write_whole_file(folder / "tracks.csv", tracks_csv(study));
  write_whole_file(folder / "tracks.png", tracks_picture(study));
  if (study.table.origin) {
    write_whole_file(folder / "tracks.geojson", tracks_geojson(study));
    files.emplace_back("tracks.geojson");
  }
  return files;
}

}  // namespace isobath
