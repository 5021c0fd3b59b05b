#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/perception/bin_update.hpp>
#include <isobath/perception/overlap_table.hpp>
#include <numbers>

namespace isobath {

using Eigen::Vector2d;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::size_t kAlign = 16;
constexpr std::size_t kMaxKeys = std::size_t{1} << 23;

std::size_t aligned(std::size_t bytes) { return (bytes + kAlign - 1) / kAlign * kAlign; }

double distance_to(std::span<const Vector2d> polygon) {
  double best = polygon[0].squaredNorm();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d& a = polygon[i];
    const Vector2d side = polygon[i + 1 < polygon.size() ? i + 1 : 0] - a;
    const double length2 = side.squaredNorm();
    const double along = length2 > 0 ? std::clamp(-a.dot(side) / length2, 0.0, 1.0) : 0;
    best = std::min(best, (a + along * side).squaredNorm());
  }
  return std::sqrt(best);
}

double farthest(std::span<const Vector2d> polygon) {
  double best = 0;
  for (const Vector2d& p : polygon) best = std::max(best, p.squaredNorm());
  return std::sqrt(best);
}

// One axis of a position on the lattice of 1/steps cells, and its mirror image.
struct Lattice {
  int cell;
  int part;
  Lattice(double at, int steps) {
    const auto q = static_cast<std::int64_t>(std::floor(at * steps + 0.5));
    const std::int64_t low = q >= 0 ? q / steps : -((-q + steps - 1) / steps);
    cell = static_cast<int>(low);
    part = static_cast<int>(q - low * steps);
  }
};

}  // namespace

// A row in the arena: this header, then clear, first_entry, entries, cells.
struct OverlapTable::Header {
  std::uint32_t key;
  std::uint32_t bytes;
  std::uint32_t cells;
  std::uint32_t entries;
  std::uint32_t bins;
  std::uint32_t gain_version;
  CellOffset low, high;

  static std::size_t size(std::size_t cells, std::size_t entries, std::size_t bins) {
    return aligned(sizeof(Header)) + aligned(cells * sizeof(double)) + aligned((bins + 1) * sizeof(std::uint32_t)) +
           aligned(entries * sizeof(Entry)) + aligned(cells * sizeof(CellOffset));
  }
  std::byte* data() { return reinterpret_cast<std::byte*>(this); }
  double* clear_data() { return reinterpret_cast<double*>(data() + aligned(sizeof(Header))); }
  std::uint32_t* first_data() {
    return reinterpret_cast<std::uint32_t*>(reinterpret_cast<std::byte*>(clear_data()) +
                                            aligned(cells * sizeof(double)));
  }
  Entry* entry_data() {
    return reinterpret_cast<Entry*>(reinterpret_cast<std::byte*>(first_data()) +
                                    aligned((bins + 1) * sizeof(std::uint32_t)));
  }
  CellOffset* cell_data() {
    return reinterpret_cast<CellOffset*>(reinterpret_cast<std::byte*>(entry_data()) + aligned(entries * sizeof(Entry)));
  }
};

std::vector<Field> fields(OverlapTableConfig& c) {
  return {
      Field::integer("table_mb", &c.table_mb, {1, 65536}, "MB", "Memory for the overlaps of beams with cells."),
      Field::integer("offset_steps", &c.offset_steps, {1, 16}, "1",
                     "Distinct positions of the sensor within a cell, along each axis."),
      Field::degrees("bearing_step_deg", &c.bearing_step, {0.001, 5}, "Maximum rounding of beam directions."),
  };
}

OverlapTable::OverlapTable(const OverlapTableConfig& config, double cell_m, int reach_cells)
    : config_(config), cell_m_(cell_m), reach_(std::min(reach_cells, 32000)) {
  const auto wrong = [](const char* key, const char* problem, const char* allowed) {
    isobath::Place place;
    place.key = key;
    throw Error(problem, place, allowed);
  };
  if (config.table_mb < 1 || config.table_mb > 65536) wrong("table_mb", "out of range", "1 .. 65536 MB");
  if (config.offset_steps < 1 || config.offset_steps > 16) wrong("offset_steps", "out of range", "1 .. 16");
  if (!(config.bearing_step.degrees() >= 0.001)) wrong("bearing_step_deg", "out of range", "0.001 .. 5 degrees");
  arena_size_ = static_cast<std::size_t>(config.table_mb) << 20;
  arena_ = std::make_unique_for_overwrite<std::byte[]>(arena_size_);
}

void OverlapTable::prepare(const BeamFan& fan, const RangeWindow& window, std::span<const double> gain) {
  if (!(window == window_) || fan.width != fan_widths_) adopt(fan, window);
  if (!std::equal(gain.begin(), gain.end(), gain_.begin(), gain_.end())) {
    gain_.assign(gain.begin(), gain.end());
    ++gain_version_;
  }
}

void OverlapTable::adopt(const BeamFan& fan, const RangeWindow& window) {
  window_ = window;
  fan_widths_ = fan.width;
  start_ = window.start_m / cell_m_;
  bin_ = window.bin_m / cell_m_;
  group_widths(fan);
  const double far = std::max(1.0, std::min(start_ + bin_ * window.bins, double(reach_)));
  const double step = std::min({widths_.front().radians() / 4, 1 / (4 * far), config_.bearing_step.radians()});
  const std::size_t places = widths_.size() * config_.offset_steps * config_.offset_steps;
  const double limit = std::max(1.0, std::floor(static_cast<double>(kMaxKeys) / static_cast<double>(places)) - 1);
  octant_ = static_cast<int>(std::clamp(std::ceil(kPi / 4 / step), 1.0, limit));
  slot_.assign(places * static_cast<std::size_t>(octant_ + 1), 0);
  forget();
  // A beam touches about as many cells as its area plus twice its outline; larger rows grow the scratch space once.
  const double cells = widths_.back().radians() / 2 * far * far + 4 * far + 16;
  cells_.reserve(static_cast<std::size_t>(std::min(cells, 1e6)));
  found_.reserve(static_cast<std::size_t>(std::min(cells * (2 + 1.5 / bin_), 2e6)));
}

void OverlapTable::group_widths(const BeamFan& fan) {
  widths_ = fan.width;
  for (Angle& w : widths_) w = Angle::radians(std::clamp(w.radians(), 1e-4, kPi));
  width_of_beam_.resize(widths_.size());
  const std::vector<Angle> of_beam = widths_;
  std::sort(widths_.begin(), widths_.end());
  std::size_t kept = 0;
  for (const Angle w : widths_) {
    if (kept == 0 || w.radians() > 1.02 * widths_[kept - 1].radians()) widths_[kept++] = w;
  }
  widths_.resize(kept);
  for (std::size_t b = 0; b < of_beam.size(); ++b) {
    const auto above = std::upper_bound(widths_.begin(), widths_.end(), of_beam[b]);
    width_of_beam_[b] = static_cast<int>(above - widths_.begin()) - 1;
  }
}

void OverlapTable::forget() {
  head_ = tail_ = wrap_ = 0;
  wrapped_ = false;
}

OverlapTable::Row OverlapTable::row(int beam, Angle azimuth, const Vector2d& sensor) {
  const int steps = config_.offset_steps;
  Lattice x(sensor.x() / cell_m_, steps);
  Lattice y(sensor.y() / cell_m_, steps);
  const Vector2d place(x.cell + double(x.part) / steps, y.cell + double(y.part) / steps);
  const int turn = 8 * octant_;
  const auto rounded = static_cast<int>(std::floor(azimuth.wrapped_positive().radians() / (kPi / 4) * octant_ + 0.5));
  int bearing = rounded % turn;
  // Mirrored axis: offset u is cell -u - 1 counted from the lattice's integer, or -u if the sensor is inside a cell.
  const auto mirror = [steps](Lattice& axis) {
    axis.cell -= axis.part == 0 ? 1 : 0;
    axis.part = (steps - axis.part) % steps;
    return -1;
  };
  int sign_x = 1;
  int sign_y = 1;
  if (bearing > 4 * octant_) {
    bearing = turn - bearing;
    sign_y = mirror(y);
  }
  if (bearing > 2 * octant_) {
    bearing = 4 * octant_ - bearing;
    sign_x = mirror(x);
  }
  const bool swapped = bearing > octant_;
  if (swapped) bearing = 2 * octant_ - bearing;
  const int qu = swapped ? y.part : x.part;
  const int qv = swapped ? x.part : y.part;
  const int group = width_of_beam_[beam];
  const auto key = static_cast<std::uint32_t>(((group * (octant_ + 1) + bearing) * steps + qu) * steps + qv);

  Header& h = *find_or_build(key, widths_[group], bearing, qu, qv);
  if (h.gain_version != gain_version_) pool(h);
  Row r;
  r.x = x.cell;
  r.y = y.cell;
  r.x_u = swapped ? 0 : sign_x;
  r.x_v = swapped ? sign_x : 0;
  r.y_u = swapped ? sign_y : 0;
  r.y_v = swapped ? 0 : sign_y;
  r.cells = {h.cell_data(), h.cells};
  r.clear = {h.clear_data(), h.cells};
  r.first_entry = {h.first_data(), h.bins + 1};
  r.entries = {h.entry_data(), h.entries};
  r.low = h.low;
  r.high = h.high;
  const double angle = rounded * (kPi / 4) / octant_;
  r.direction = {std::cos(angle), std::sin(angle)};
  r.sensor = place;
  return r;
}

OverlapTable::Header* OverlapTable::find_or_build(std::uint32_t key, Angle width, int bearing, int qx, int qy) {
  if (const std::uint32_t slot = slot_[key]) {
    return reinterpret_cast<Header*>(arena_.get() + (slot - std::size_t{1}) * kAlign);
  }
  build(width, bearing, qx, qy);
  ++rows_built_;
  return store(key);
}

// Visits the columns of cells that the wedge intersects, and in each column the rows that it intersects.
void OverlapTable::build(Angle width, int bearing, int qx, int qy) {
  cells_.clear();
  found_.clear();
  const Angle azimuth = Angle::radians(bearing * (kPi / 4) / octant_);
  const Wedge wedge(azimuth, width);
  const Vector2d sensor(double(qx) / config_.offset_steps, double(qy) / config_.offset_steps);
  const double far = std::min(start_ + bin_ * window_.bins, double(reach_));
  const Angle right = azimuth - width / 2;
  const bool behind = right < Angle::degrees(-90) || azimuth + width / 2 > Angle::degrees(90);
  const int last_u = static_cast<int>(std::floor(sensor.x() + far));
  for (int u = behind ? static_cast<int>(std::floor(sensor.x() - far)) : 0; u <= last_u; ++u) {
    const Wedge::Piece strip = wedge.clip({u - sensor.x(), -far}, {u + 1 - sensor.x(), far});
    if (strip.count < 3) continue;
    double low = far;
    double high = -far;
    for (const Vector2d& p : strip.polygon()) {
      low = std::min(low, p.y());
      high = std::max(high, p.y());
    }
    const int last_v = static_cast<int>(std::floor(high + sensor.y()));
    for (int v = static_cast<int>(std::floor(low + sensor.y())); v <= last_v; ++v) build_cell(wedge, u, v, sensor);
  }
}

void OverlapTable::build_cell(const Wedge& wedge, int u, int v, const Vector2d& sensor) {
  const Vector2d low = Vector2d(u, v) - sensor;
  const Wedge::Piece piece = wedge.clip(low, low + Vector2d::Ones());
  if (piece.count < 3) return;
  const std::span<const Vector2d> polygon = piece.polygon();
  const bool at_apex = low.x() <= 0 && low.x() >= -1 && low.y() <= 0 && low.y() >= -1;
  const double near = at_apex ? 0 : distance_to(polygon);
  const double first = std::max(0.0, std::floor((near - start_) / bin_));
  const double far = farthest(polygon);
  const double last = std::min<double>(window_.bins, std::ceil((far - start_) / bin_));
  if (first >= last) return;
  // Most cells overlap few bins: discs that contain none or all of the polygon take a short cut.
  const double whole = disc_overlap(polygon, 2 * far);
  const auto within = [&](double radius) {
    return radius <= near ? 0 : radius >= far ? whole : disc_overlap(polygon, radius);
  };
  const auto cell = static_cast<std::uint32_t>(cells_.size());
  bool any = false;
  double inside = within(start_ + first * bin_);
  for (int k = static_cast<int>(first); k < static_cast<int>(last); ++k) {
    const double next = within(start_ + (k + 1) * bin_);
    const double share = std::min(next - inside, 1.0);
    inside = next;
    if (share < 1e-9) continue;
    found_.push_back({static_cast<std::uint32_t>(k), {cell, static_cast<float>(share)}});
    any = true;
  }
  if (any) cells_.push_back({static_cast<std::int16_t>(u), static_cast<std::int16_t>(v)});
}

OverlapTable::Header* OverlapTable::store(std::uint32_t key) {
  const std::size_t bytes = Header::size(cells_.size(), found_.size(), window_.bins);
  std::byte* place = allocate(bytes);
  if (place) {
    slot_[key] = static_cast<std::uint32_t>((place - arena_.get()) / kAlign + 1);
  } else {
    if (single_.size() < bytes) single_.resize(bytes);
    place = single_.data();
  }
  auto* h = new (place) Header{};
  h->key = key;
  h->bytes = static_cast<std::uint32_t>(bytes);
  h->cells = static_cast<std::uint32_t>(cells_.size());
  h->entries = static_cast<std::uint32_t>(found_.size());
  h->bins = static_cast<std::uint32_t>(window_.bins);
  h->low = h->high = cells_.empty() ? CellOffset{0, 0} : cells_.front();
  for (const CellOffset& c : cells_) {
    h->low = {std::min(h->low.u, c.u), std::min(h->low.v, c.v)};
    h->high = {std::max(h->high.u, c.u), std::max(h->high.v, c.v)};
  }
  std::copy(cells_.begin(), cells_.end(), h->cell_data());
  std::uint32_t* first = h->first_data();
  std::fill(first, first + window_.bins + 1, 0u);
  for (const Found& f : found_) ++first[f.bin + 1];
  for (int k = 0; k < window_.bins; ++k) first[k + 1] += first[k];
  for (const Found& f : found_) h->entry_data()[first[f.bin]++] = f.entry;
  for (int k = window_.bins; k > 0; --k) first[k] = first[k - 1];
  first[0] = 0;
  h->gain_version = gain_version_ - 1;
  return h;
}

void OverlapTable::pool(Header& row) const {
  double* clear = row.clear_data();
  std::fill(clear, clear + row.cells, 0.0);
  const std::uint32_t* first = row.first_data();
  const Entry* entries = row.entry_data();
  for (std::uint32_t k = 0; k < row.bins; ++k) {
    if (gain_[k] == 0) continue;
    for (std::uint32_t i = first[k]; i < first[k + 1]; ++i) {
      clear[entries[i].cell] += clear_increment(gain_[k], double(entries[i].share));
    }
  }
  row.gain_version = gain_version_;
}

// Rows occupy [tail, head), or [tail, wrap) and [0, head) if the arena has wrapped.
std::byte* OverlapTable::allocate(std::size_t bytes) {
  if (bytes > arena_size_) return nullptr;
  for (;;) {
    if (!wrapped_ && arena_size_ - head_ < bytes) {
      wrap_ = head_;
      head_ = 0;
      wrapped_ = true;
    }
    if (!wrapped_ || tail_ - head_ >= bytes) break;
    evict_oldest();
  }
  std::byte* place = arena_.get() + head_;
  head_ += bytes;
  return place;
}

void OverlapTable::evict_oldest() {
  const auto* oldest = reinterpret_cast<const Header*>(arena_.get() + tail_);
  slot_[oldest->key] = 0;
  tail_ += oldest->bytes;
  if (tail_ < wrap_) return;
  tail_ = 0;
  wrapped_ = false;
}

}  // namespace isobath
