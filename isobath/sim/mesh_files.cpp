// Meshes of terrain and of rasters, and their holes. Only this file of the room uses GDAL.
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <gdal_priv.h>
#include <isobath/base/random.hpp>
#include <isobath/geometry/geodesy.hpp>
#include <isobath/sim/triangle_mesh.hpp>
#include <map>
#include <numbers>
#include <unordered_map>

namespace isobath {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using Eigen::Vector3i;

constexpr int kMaxCells = 4'000'000;

/// A regular grid of rows x columns vertices.
TriangleMesh net(int rows, int columns, const std::function<Vector3d(int, int)>& vertex) {
  TriangleMesh mesh;
  mesh.vertices.reserve(static_cast<std::size_t>(rows) * columns);
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) mesh.vertices.push_back(vertex(r, c).cast<float>());
  }
  for (int r = 0; r + 1 < rows; ++r) {
    for (int c = 0; c + 1 < columns; ++c) {
      const int a = r * columns + c, b = a + 1, d = a + columns, e = d + 1;
      mesh.triangles.push_back({a, b, e});
      mesh.triangles.push_back({a, e, d});
    }
  }
  return mesh;
}

[[noreturn]] void refuse(Place place, const char* key, const std::string& problem, const std::string& advice = {}) {
  place.key += std::string(".") + key;
  throw Error(problem, place, "", advice);
}

}  // namespace

// Sum of waves of many lengths and directions whose height falls with their length: a natural bottom has a power
// spectrum of about k^-3 (Fox and Hayes 1985). The sum is normalised to the requested rms height.
TriangleMesh terrain_mesh(const BottomConfig& c) {
  constexpr int kWaves = 48;
  struct Wave {
    Eigen::Vector2d k;
    double height, phase;
  };
  Random random(static_cast<std::uint64_t>(c.seed));
  std::array<Wave, kWaves> waves;
  double power = 0;
  const double octaves = std::max(0.0, std::log2(c.wavelength_m / (2.5 * c.cell_m)));
  for (Wave& w : waves) {
    const double length = c.wavelength_m * std::exp2(-octaves * random.uniform());
    const double direction = 2 * std::numbers::pi * random.uniform();
    w.k = 2 * std::numbers::pi / length * Eigen::Vector2d(std::cos(direction), std::sin(direction));
    w.height = length / c.wavelength_m;
    w.phase = 2 * std::numbers::pi * random.uniform();
    power += 0.5 * w.height * w.height;
  }
  const double gain = power > 0 ? c.relief_m / std::sqrt(power) : 0;
  const double cells = std::ceil(2 * c.extent_m / c.cell_m);
  if (cells * cells > kMaxCells) {
    refuse(c.place, "cell_m", fmt::format("{:.0f} x {:.0f} cells are too many", cells, cells), "at most 2000 x 2000");
  }
  const int side = static_cast<int>(cells) + 1;
  return net(side, side, [&](int r, int col) {
    const Eigen::Vector2d p(-c.extent_m + r * c.cell_m, -c.extent_m + col * c.cell_m);
    double z = c.depth + c.slope.dot(p);
    for (const Wave& w : waves) z += gain * w.height * std::cos(w.k.dot(p) + w.phase);
    return Vector3d(p.x(), p.y(), z);
  });
}

TriangleMesh raster_mesh(const BottomConfig& c) {
  static const bool kRegistered = [] {
    GDALAllRegister();
    CPLSetErrorHandler(CPLQuietErrorHandler);
    return true;
  }();
  (void)kRegistered;
  const std::unique_ptr<GDALDataset> data(GDALDataset::Open(c.file.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY));
  if (!data || data->GetRasterCount() < 1)
    refuse(c.place, "file", "GDAL cannot read a raster from this file: " + c.file);
  std::array<double, 6> t{};
  if (data->GetGeoTransform(t.data()) != CE_None) refuse(c.place, "file", "the raster has no georeference");
  GDALRasterBand* band = data->GetRasterBand(1);
  const int columns = band->GetXSize(), rows = band->GetYSize();
  const int every = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(columns) * rows / kMaxCells)));
  const int nx = std::max(2, columns / every), ny = std::max(2, rows / every);
  std::vector<float> values(static_cast<std::size_t>(nx) * ny);
  if (band->RasterIO(GF_Read, 0, 0, columns, rows, values.data(), nx, ny, GDT_Float32, 0, 0) != CE_None) {
    refuse(c.place, "file", "the raster cannot be read: " + c.file);
  }
  int has_no_data = 0;
  const double no_data = band->GetNoDataValue(&has_no_data);
  const OGRSpatialReference* system = data->GetSpatialRef();
  const bool geographic = system ? system->IsGeographic() != 0 : std::abs(t[0]) <= 180 && std::abs(t[1]) < 0.1;
  const auto place_of = [&](double col, double row) {
    return Eigen::Vector2d(t[0] + t[1] * col + t[2] * row, t[3] + t[4] * col + t[5] * row);  // easting, northing
  };
  const Eigen::Vector2d origin = c.centred ? place_of(columns / 2.0, rows / 2.0) : c.origin;
  const LocalPlane plane({geographic ? std::clamp(origin.y(), -80.0, 80.0) : 0, geographic ? origin.x() : 0});
  int empty = 0;
  TriangleMesh mesh = net(ny, nx, [&](int r, int col) {
    const float value = values[static_cast<std::size_t>(r) * nx + col];
    const bool none =
        !std::isfinite(value) || (has_no_data && static_cast<double>(value) == no_data) || std::abs(value) > 12000;
    empty += none;
    const Eigen::Vector2d at = place_of((col + 0.5) * columns / nx, (r + 0.5) * rows / ny);
    const Eigen::Vector2d p =
        geographic ? plane.to_plane({at.y(), at.x()}) : Eigen::Vector2d(at.y() - origin.y(), at.x() - origin.x());
    const double z = c.depth + (c.elevation ? -1.0 : 1.0) * static_cast<double>(value);
    return Vector3d(p.x(), p.y(), none ? std::numeric_limits<double>::quiet_NaN() : z);
  });
  if (empty > 0 && !c.allow_holes) {
    refuse(c.place, "file", fmt::format("the bottom has holes: {} of {} cells hold no data", empty, values.size()),
           "crop the raster to a part without holes, or set allow_holes = true");
  }
  std::erase_if(mesh.triangles, [&mesh](const Vector3i& tri) {
    return std::isnan(mesh.vertices[tri[0]].z() + mesh.vertices[tri[1]].z() + mesh.vertices[tri[2]].z());
  });
  for (Vector3f& v : mesh.vertices) {
    if (std::isnan(v.z())) v.z() = 0;  // in no triangle
  }
  return mesh;
}

int holes(const TriangleMesh& mesh) {
  // Vertices at the same position, to a millimetre, become one.
  std::map<std::array<long, 3>, int> places;
  std::vector<int> same(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Vector3f& v = mesh.vertices[i];
    const std::array<long, 3> key{std::lround(v.x() * 1000), std::lround(v.y() * 1000), std::lround(v.z() * 1000)};
    same[i] = places.emplace(key, static_cast<int>(places.size())).first->second;
  }
  std::map<std::pair<int, int>, int> edges;
  for (const Vector3i& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      const int a = same[t[k]], b = same[t[(k + 1) % 3]];
      if (a != b) ++edges[std::minmax(a, b)];
    }
  }
  std::unordered_map<int, std::vector<int>> border;  // edges of a single triangle
  for (const auto& [edge, uses] : edges) {
    if (uses != 1) continue;
    border[edge.first].push_back(edge.second);
    border[edge.second].push_back(edge.first);
  }
  int loops = 0;
  std::map<int, bool> seen;
  for (const auto& [start, next] : border) {
    if (seen[start]) continue;
    bool closed = true;  // the border of a fin (a triangle attached to an edge of two others) does not close
    std::vector<int> open{start};
    while (!open.empty()) {
      const int at = open.back();
      open.pop_back();
      if (std::exchange(seen[at], true)) continue;
      closed = closed && border[at].size() % 2 == 0;
      for (const int other : border[at]) open.push_back(other);
    }
    loops += closed;
  }
  return std::max(0, loops - 1);
}

}  // namespace isobath
