#include <algorithm>
#include <array>
#include <isobath/report/group_outcome.hpp>
#include <isobath/report/plot/picture.hpp>

namespace isobath {
namespace {

constexpr int kSide = 760;
/// Colours that also people with red-green blindness tell apart (Okabe and Ito 2008).
constexpr std::array<Colour, kMaxGroup> kVehicles = {
    Colour{0.0, 0.45, 0.7, 1}, {0.84, 0.37, 0.0, 1},  {0.0, 0.62, 0.45, 1}, {0.8, 0.47, 0.65, 1},
    {0.9, 0.62, 0.0, 1},       {0.34, 0.71, 0.91, 1}, {0.3, 0.3, 0.3, 1},   {0.6, 0.55, 0.1, 1}};

}  // namespace

std::string draw_group(const GroupRecord& record, const std::string& title) {
  const std::vector<Lane> lanes = lanes_of(record.plan.search);
  Eigen::AlignedBox2d box;
  for (const Lane& lane : lanes) box.extend(lane.from_W).extend(lane.to_W);
  std::vector<std::vector<Eigen::Vector2d>> tracks;
  for (const GroupVehicleRecord& vehicle : record.vehicles) {
    std::vector<Eigen::Vector2d>& track = tracks.emplace_back();
    for (const TrueMotion& motion : vehicle.track) {
      track.emplace_back(motion.state.X_WB.translation.head<2>());
      box.extend(track.back());
    }
  }
  PlanPicture picture(frame_around(box), kSide, {title, "north (m)", "east (m)"});
  for (const Lane& lane : lanes) {
    const std::array<Eigen::Vector2d, 2> line = {lane.from_W, lane.to_W};
    picture.polyline(line, {palette::kFaint, 1, true});
  }
  for (const TrueBody& body : record.bodies) {
    picture.polygon(body.outline, {palette::kInk, 1.5, false}, {0.3, 0.25, 0.2, 0.6});
  }
  const Colour& of_passage = kVehicles[4];
  for (const GroupPassage& passage : record.plan.passages) {
    picture.polygon(passage.outline, {of_passage, 1.5, true}, {of_passage.red, of_passage.green, of_passage.blue, 0.1});
  }
  std::vector<PlanPicture::LegendEntry> legend = {{palette::kFaint, "lanes"}};
  if (!record.plan.passages.empty()) legend.push_back({of_passage, "passage: one at a time"});
  if (!record.bodies.empty()) legend.push_back({palette::kInk, "bodies"});
  for (std::size_t v = 0; v < tracks.size(); ++v) {
    const Colour& colour = kVehicles[v % kVehicles.size()];
    if (tracks[v].size() > 1) picture.polyline(tracks[v], {colour, 2, false});
    if (!tracks[v].empty()) picture.dot(tracks[v].front(), 3.5, colour);
    if (!tracks[v].empty() && record.vehicles[v].lost_s) picture.dot(tracks[v].back(), 6, palette::kObstacle);
    legend.push_back({colour, record.vehicles[v].name});
  }
  if (std::ranges::any_of(record.vehicles, [](const auto& vehicle) { return vehicle.lost_s.has_value(); })) {
    legend.push_back({palette::kObstacle, "lost here"});
  }
  picture.finish(legend);
  return picture.png();
}

}  // namespace isobath
