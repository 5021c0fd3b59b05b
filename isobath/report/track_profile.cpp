#include <algorithm>
#include <cmath>
#include <isobath/report/plot/picture.hpp>
#include <isobath/report/track_profile.hpp>

namespace isobath {

namespace {

constexpr int kWidth_px = 1000, kHeight_px = 320;
const double kUnknown = std::nan("");

/// The values that are known lie between these, with a twentieth around.
ChartPicture::Axis axis_around(std::string label, std::initializer_list<std::span<const double>> curves) {
  double low = INFINITY, high = -INFINITY;
  for (const auto& curve : curves) {
    for (const double value : curve) {
      if (!std::isfinite(value)) continue;
      low = std::min(low, value);
      high = std::max(high, value);
    }
  }
  if (!(low <= high)) low = high = 0;
  const double around = std::max(0.05 * (high - low), 0.5);
  return {std::move(label), low - around, high + around};
}

}  // namespace

TrackProfile draw_track_profile(std::span<const BelievedPlace> track, const DepthSnapshot& map) {
  TrackProfile profile;
  if (track.size() < 2) return profile;
  std::vector<double> time_s, north_m, east_m, vehicle_m, map_m, chart_m;
  const PixelGrid grid = map.grid();
  for (const BelievedPlace& place : track) {
    time_s.push_back(to_seconds(place.time.time_since_epoch()));
    north_m.push_back(place.north_east.x());
    east_m.push_back(place.north_east.y());
    vehicle_m.push_back(place.depth_m);
    const Pixel pixel = grid.at(place.north_east);
    const DepthPixel now = map.at(pixel);
    map_m.push_back(now.known() ? now.depth_m() : kUnknown);
    std::uint32_t charted = DepthPixel::kUnknownDepth;
    if (map.trees().extent().contains(pixel)) map.trees().prior().read({pixel.column, pixel.row, 1, 1}, &charted, 1);
    chart_m.push_back(charted == DepthPixel::kUnknownDepth ? kUnknown : DepthPixel{charted, 0}.depth_m());
  }
  const double begin_s = time_s.front();
  for (double& t : time_s) t -= begin_s;
  const ChartPicture::Axis time{"time of the mission (s)", 0, std::max(time_s.back(), 1.0)};
  ChartPicture place(kWidth_px, kHeight_px, "Place of the vehicle, as estimated", time,
                     axis_around("m from the origin", {north_m, east_m}));
  place.curve(time_s, north_m, {palette::kTrack, 2, false}, "north");
  place.curve(time_s, east_m, {palette::kVehicle, 2, false}, "east");
  place.finish();
  profile.place = place.png();
  ChartPicture::Axis down = axis_around("depth (m)", {vehicle_m, map_m, chart_m});
  std::swap(down.low, down.high);
  ChartPicture depths(kWidth_px, kHeight_px, "Depths along the track, in the map after the run", time, down);
  depths.curve(time_s, chart_m, {palette::kInk, 1.5, true}, "chart");
  depths.curve(time_s, map_m, {palette::kTrack, 2, false}, "map");
  depths.curve(time_s, vehicle_m, {palette::kVehicle, 1.5, false}, "vehicle");
  depths.finish();
  profile.depths = depths.png();
  return profile;
}

void add_track_profile(HtmlReport& page, const TrackProfile& profile) {
  if (profile.depths.empty()) return;
  page.figure(profile.place, "The vehicle's place during the mission, as it estimated it.");
  page.figure(profile.depths,
              "Depths under the track of the mission: by the chart, where there is one, and by the map after the run.");
}

}  // namespace isobath
