#include <algorithm>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/random.hpp>
#include <isobath/evaluation/traffic_replay.hpp>
#include <isobath/io/input/position_table.hpp>
#include <isobath/sim/clutter.hpp>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr int kReplayTries = 1000;

/// Joins the reports of each ship, in the order of their times.
class TrackJoiner {
 public:
  explicit TrackJoiner(std::size_t ships) : open_(ships), numbers_(ships) {}

  void add(const PositionTable::Row& row, double time_s) {
    if (!row.body) {
      ++out_.left_out["report without a name"];
      return;
    }
    RecordedTrack& track = open_[*row.body];
    std::size_t& number = numbers_[*row.body];
    if (number == 0) number = ++ships_;
    if (!track.t_s.empty()) {
      const double since_s = time_s - track.t_s.back();
      if (since_s > TrafficRecording::kMaxGap_s) {
        end(track);
      } else if (since_s <= 0) {
        ++out_.left_out["report of the same time as the one before"];
        return;
      } else if ((row.p_W - track.p.back()).norm() > TrafficRecording::kMaxSpeed * since_s) {
        ++out_.left_out["report of an impossible speed"];
        return;
      }
    }
    track.ship = number;
    track.t_s.push_back(time_s);
    track.p.push_back(row.p_W);
  }
  TrafficRecording finish() {
    for (RecordedTrack& track : open_) end(track);
    return std::move(out_);
  }

 private:
  void end(RecordedTrack& track) {
    if (track.t_s.size() >= 2) {
      if (out_.tracks.size() >= TrafficRecording::kMaxTracks) {
        throw Error(fmt::format("more than {} tracks of ships", TrafficRecording::kMaxTracks), {}, "a shorter table");
      }
      out_.tracks.push_back(std::move(track));
    } else {
      out_.left_out["single report"] += track.t_s.size();
    }
    track = {};
  }

  std::vector<RecordedTrack> open_;   // by the index of the table
  std::vector<std::size_t> numbers_;  // of the ships; 0: not seen yet
  std::size_t ships_ = 0;
  TrafficRecording out_;
};

/// From the recording to W: a place p becomes turn (p - about) / length_scale + at.
struct ReplayPlacement {
  double from_s = 0;  // of the recording, at time 0 of the run
  Eigen::Matrix2d turn;
  Vector2d about, at_W;
  double length_scale = 1, time_scale = 1;

  [[nodiscard]] double recorded_s(double run_s) const { return from_s + run_s * time_scale; }
  [[nodiscard]] double run_s(double recorded_s) const { return (recorded_s - from_s) / time_scale; }
  [[nodiscard]] Vector2d to_W(const Vector2d& p) const { return turn * (p - about) / length_scale + at_W; }
};

struct MovingReport {
  const RecordedTrack* track = nullptr;
  std::size_t index = 0;
};

/// Reports after which the ship goes on at `min_speed` or more, as recorded.
std::vector<MovingReport> moving_reports(const TrafficRecording& recording, double min_speed) {
  std::vector<MovingReport> reports;
  for (const RecordedTrack& track : recording.tracks) {
    for (std::size_t i = 0; i + 1 < track.t_s.size(); ++i) {
      const double way = (track.p[i + 1] - track.p[i]).norm();
      if (way >= min_speed * (track.t_s[i + 1] - track.t_s[i])) reports.push_back({&track, i});
    }
  }
  return reports;
}

/// Nearest distance from `point` during the run, once a second.
double nearest_to(const Vector2d& point, const RecordedTrack& track, const ReplayPlacement& placement,
                  double duration_s) {
  double nearest = std::numeric_limits<double>::infinity();
  for (double t = 0; t <= duration_s; t += 1) {
    nearest = std::min(nearest, (placement.to_W(track.at(placement.recorded_s(t))) - point).norm());
  }
  return nearest;
}

Body ship_body(const RecordedTrack& track, const ReplayPlacement& placement, const ReplayConfig& config,
               double duration_s) {
  const double depth = (config.top_m + config.bottom_m) / 2;
  Body body;
  body.name = fmt::format("ship {}", track.ship);
  const auto add = [&](double t, const Vector2d& recorded) {
    const Vector2d p = placement.to_W(recorded).unaryExpr(&whole_cm);
    body.path.insert(body.path.end(), {t, p.x(), p.y(), depth});
  };
  add(0, track.at(placement.recorded_s(0)));
  for (std::size_t i = 0; i < track.t_s.size(); ++i) {
    const double t = placement.run_s(track.t_s[i]);
    if (t > 0 && t < duration_s) add(t, track.p[i]);
  }
  add(duration_s, track.at(placement.recorded_s(duration_s)));
  body.shape = Cylinder{.centre = {body.path[1], body.path[2], depth},
                        .radius = config.radius_m,
                        .length = config.bottom_m - config.top_m};
  return body;
}

}  // namespace

std::vector<Field> fields(ReplayConfig& c) {
  return {
      Field::flag("on", &c.on, "Whether the ships of a recording come along, one of which meets the vehicle."),
      Field::file("file", &c.file, "Recording of AIS reports (.csv); empty: --replay of the command line."),
      Field::real("length_scale", &c.length_scale, {0.01, 1e4}, "1", "Factor by which lengths are divided."),
      Field::real("time_scale", &c.time_scale, {0.01, 1e4}, "1", "Factor by which times are divided."),
      Field::numbers("meeting_s", c.meeting_s.data(), 2, {1, 1e4}, "s",
                     "Minimum and maximum time after which a vehicle that goes straight meets the ship."),
      Field::real("min_speed", &c.min_speed, {0.01, 30}, "m/s", "Minimum speed of that ship then, scaled."),
      Field::real("radius_m", &c.radius_m, {0.05, 20}, "m", "Radius of the bodies."),
      Field::real("within_m", &c.within_m, {1, 1e4}, "m",
                  "Other ships come along that come as near as this to the start, scaled."),
      Field::real("free_m", &c.free_m, {0, 1000}, "m", "Minimum distance of all ships from the vehicle at the start."),
      Field::real("top_m", &c.top_m, {-100, 12000}, "m", "Depth of the tops of the bodies."),
      Field::real("bottom_m", &c.bottom_m, {-100, 12000}, "m", "Depth of their feet.")};
}

Vector2d RecordedTrack::at(double time_s) const {
  if (time_s <= t_s.front()) return p.front();
  auto next = static_cast<std::size_t>(std::lower_bound(t_s.begin(), t_s.end(), time_s) - t_s.begin());
  next = std::min(next, t_s.size() - 1);
  const double share = (time_s - t_s[next - 1]) / (t_s[next] - t_s[next - 1]);
  return p[next - 1] + share * (p[next] - p[next - 1]);
}

std::uint64_t TrafficRecording::digest() const {
  std::uint64_t digest = 0xcbf29ce484222325u;
  const auto add = [&digest](double value) {
    digest = (digest ^ std::bit_cast<std::uint64_t>(value)) * 0x100000001b3u;
  };
  for (const RecordedTrack& track : tracks) {
    add(static_cast<double>(track.ship));
    for (const double t : track.t_s) add(t);
    for (const Vector2d& p : track.p) {
      add(p.x());
      add(p.y());
    }
  }
  return digest;
}

TrafficRecording read_recording(const std::filesystem::path& file) {
  const PositionTable table = read_positions(file);
  TrackJoiner joiner(table.names.size());
  for (const PositionTable::Row& row : table.rows) joiner.add(row, to_seconds(row.time - table.rows.front().time));
  TrafficRecording recording = joiner.finish();
  for (const auto& [reason, count] : table.left_out) recording.left_out[reason] += count;
  if (recording.tracks.empty()) {
    throw Error("no ship has two usable reports", {.file = file.string()}, "a table with time, mmsi and position");
  }
  return recording;
}

ReplayedTraffic replayed_traffic(const ReplayConfig& c, const TrafficRecording& recording,
                                 const EncounteredVehicle& vehicle, std::uint64_t seed, double duration_s) {
  if (c.bottom_m <= c.top_m) throw Error("does not lie below top_m", {.key = "replay.bottom_m"}, "more than top_m");
  const std::vector<MovingReport> reports = moving_reports(recording, c.min_speed * c.length_scale / c.time_scale);
  if (reports.empty()) {
    throw Error(fmt::format("no ship of the recording moves at {:g} m/s", c.min_speed), {.key = "replay.min_speed"},
                "less, or another recording");
  }
  Random random(seed);
  for (int attempt = 0; attempt < kReplayTries; ++attempt) {
    const MovingReport& report = reports[random.index(reports.size())];
    const double meeting_s = random.uniform(c.meeting_s[0], c.meeting_s[1]);
    const Angle angle = Angle::radians(random.uniform(0, 2 * std::numbers::pi));
    ReplayPlacement placement;
    placement.length_scale = c.length_scale;
    placement.time_scale = c.time_scale;
    placement.from_s = report.track->t_s[report.index] - meeting_s * c.time_scale;
    placement.about = report.track->p[report.index];
    placement.turn << cos(angle), -sin(angle), sin(angle), cos(angle);
    placement.at_W = vehicle.start_W + vehicle.speed * meeting_s * Vector2d(cos(vehicle.course), sin(vehicle.course));
    if (!report.track->covers(placement.from_s)) continue;
    ReplayedTraffic traffic;
    traffic.meeting_s = meeting_s;
    bool free = true;
    for (const RecordedTrack& track : recording.tracks) {
      if (!track.covers(placement.from_s)) continue;
      const double gap_m = (placement.to_W(track.at(placement.from_s)) - vehicle.start_W).norm() - c.radius_m;
      free = free && gap_m >= c.free_m;
      const bool is_met = &track == report.track;
      if (!free || (!is_met && nearest_to(vehicle.start_W, track, placement, duration_s) > c.within_m)) continue;
      const auto where = is_met ? traffic.bodies.begin() : traffic.bodies.end();
      traffic.bodies.insert(where, ship_body(track, placement, c, duration_s));
    }
    if (free) return traffic;
  }
  throw Error(fmt::format("no report of the recording leaves {:g} m free at the start", c.free_m),
              {.key = "replay.free_m"}, "less, or another recording");
}

}  // namespace isobath
