// The picture of the last scan, which a run writes as sonar.png: where a sample of the sonar stands in it.
#include <algorithm>
#include <array>
#include <cmath>
#include <gdal_priv.h>
#include <isobath/io/mcap/native_log.hpp>
#include <numbers>
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>
#include <tests/support/echoes.hpp>

namespace isobath::sector_picture {
namespace {

namespace fs = std::filesystem;

/// Red, green and blue of each pixel.
class PictureFile {
 public:
  explicit PictureFile(const fs::path& file) {
    GDALAllRegister();
    const GDALDatasetUniquePtr data(GDALDataset::Open(file.c_str()));
    if (!data) return;
    columns = data->GetRasterXSize();
    rows = data->GetRasterYSize();
    for (int b = 0; b < 3; ++b) {
      auto& band = bands_[static_cast<std::size_t>(b)];
      band.resize(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
      EXPECT_EQ(data->GetRasterBand(b + 1)->RasterIO(GF_Read, 0, 0, columns, rows, band.data(), columns, rows, GDT_Byte,
                                                     0, 0),
                CE_None);
    }
  }
  using Colour = std::array<int, 3>;
  [[nodiscard]] Colour at(int row, int column) const {
    const auto i = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
    return {bands_[0][i], bands_[1][i], bands_[2][i]};
  }
  int rows = 0, columns = 0;

 private:
  std::array<std::vector<std::uint8_t>, 3> bands_;
};

constexpr int kBeams = 41, kBins = 100;  // 3 degrees each from 60 degrees to port; 0.2 m each
constexpr double kBin = 0.2, kRange = kBins * kBin, kSide = 61.5 * std::numbers::pi / 180;

/// The picture of a log of one fan, in which one sample is bright.
PictureFile picture_of(const fs::path& folder, int bright_beam, int bright_bin) {
  const auto fan = test::fan_of(kBeams, Angle::degrees(-60), Angle::degrees(3));
  NativeLogWriter log(folder / "one.mcap");
  for (int n = 0; n < 3; ++n) {
    Navigation fix;
    fix.time = Time(seconds(0.5 * n));
    fix.X_WB.translation = {0, 0, 5};
    log.write(fix);
    Ping ping = test::ping_of<float>(fan, {0, kBin, kBins}, [&](int beam, int bin) {
      return beam == bright_beam && bin == bright_bin ? 250.0 : 20.0 + (beam * 7 + bin * 13) % 5;
    });
    ping.time = fix.time;
    log.write(ping);
  }
  log.close();
  const auto run = test::isobath_run(folder / "one.mcap", folder / "out",
                                     {"--set", "echoes.method=os_cfar", "--set", "report.replay=false", "--set",
                                      "sphere.keep=false", "--set", "voxels.sonars=none"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  return PictureFile(folder / "out/sonar.png");
}

constexpr PictureFile::Colour kNoData{237, 237, 237}, kStrongest{255, 237, 115};

/// Where the sector lies in the picture: its apex, in pixels from the upper left, and the size of a pixel.
struct Sector {
  double row = 0, column = 0, pixel_m = 0;
  int left = 0, right = 0, top = 0;  ///< of the plot, without the panel with the legend
};

/// The plot begins where a long line has no data. The sector is what is dark blue in it, as weak echoes are; it is
/// symmetric about its axis.
Sector sector_of(const PictureFile& picture) {
  Sector s;
  int run = 0;
  for (; s.top < picture.rows && run < 300; ++s.top) {
    run = 0;
    for (s.right = 0; s.right < picture.columns; ++s.right) {
      if (picture.at(s.top, s.right) == kNoData) {
        ++run;
      } else if (run >= 300) {
        break;
      } else {
        run = 0;
      }
    }
  }
  EXPECT_GE(run, 300) << "a plot";
  s.left = s.right - run;
  int first_row = picture.rows, first = s.right, last = s.left;
  for (int row = s.top; row < picture.rows; ++row) {
    for (int column = s.left; column < s.right; ++column) {
      const auto [red, green, blue] = picture.at(row, column);
      if (red > 100 || blue < red + 20) continue;
      first_row = std::min(first_row, row);
      first = std::min(first, column);
      last = std::max(last, column);
    }
  }
  s.pixel_m = 2 * kRange * std::sin(kSide) / (last + 1 - first);
  s.row = first_row + kRange / s.pixel_m;
  s.column = 0.5 * (first + last + 1);
  return s;
}

// The middle of the pixels of the brightest colour is where the middle of the sample is. ledger: S5-59
TEST(SectorPicture, PlacesASampleAtItsBearingAndRangeWithinAPixel) {
  for (const auto& [beam, bin] : {std::pair(27, 63), std::pair(4, 38)}) {
    const PictureFile picture = picture_of(test::scratch_folder(), beam, bin);
    ASSERT_GT(picture.rows, 0);
    const Sector sector = sector_of(picture);
    double rows = 0, columns = 0, pixels = 0;
    for (int row = sector.top; row < picture.rows; ++row) {
      for (int column = sector.left; column < sector.right; ++column) {
        if (picture.at(row, column) != kStrongest) continue;
        rows += row + 0.5;
        columns += column + 0.5;
        ++pixels;
      }
    }
    ASSERT_GT(pixels, 0) << beam;
    const double range = (bin + 0.5) * kBin, bearing = (-60 + 3 * beam) * std::numbers::pi / 180;
    EXPECT_NEAR(sector.row - rows / pixels, range * std::cos(bearing) / sector.pixel_m, 1) << beam;
    EXPECT_NEAR(columns / pixels - sector.column, range * std::sin(bearing) / sector.pixel_m, 1) << beam;
  }
}

}  // namespace
}  // namespace isobath::sector_picture
