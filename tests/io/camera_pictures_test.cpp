// Pictures of cameras and maps of numbers, whole and damaged.
#include <cmath>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/io/frames/camera_pictures.hpp>
#include <limits>
#include <tests/support/data.hpp>

namespace isobath::camera_pictures {
namespace {

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
void put(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

// ledger: S8-01
TEST(CameraPictures, ArePngAsTheyWereWritten) {
  const auto file = test::scratch_folder() / "picture.png";
  for (const int channels : {1, 3}) {
    CameraImage image(37, 21, channels);
    Random random(1);
    for (std::uint8_t& sample : image.samples) sample = static_cast<std::uint8_t>(random.index(256));
    write_camera_image(file, image);
    EXPECT_EQ(read_camera_image(file), image);
  }
}

TEST(CameraPictures, ADamagedPictureIsAnErrorThatNamesTheFile) {
  const auto folder = test::scratch_folder();
  write_camera_image(folder / "whole.png", CameraImage(40, 30, 3));
  const std::string whole = bytes_of(folder / "whole.png");
  for (std::size_t cut = 0; cut + 12 < whole.size(); ++cut) {  // the last chunk has no pixels
    put(folder / "cut.png", whole.substr(0, cut));
    EXPECT_THROW(read_camera_image(folder / "cut.png"), Error) << cut;
  }
}

TEST(CameraPictures, AJpegIsReadAndACutOneRefused) {
  ISOBATH_NEEDS_DATA(data, "stereo-debian");
  const auto folder = test::scratch_folder();
  const CameraImage image = read_camera_image(data / "opencv/left01.jpg");
  EXPECT_EQ(image.width, 640);
  EXPECT_EQ(image.height, 480);
  const std::string whole = bytes_of(data / "opencv/left01.jpg");
  for (std::size_t cut = 4; cut < whole.size() - 2000; cut += whole.size() / 40) {
    put(folder / "cut.jpg", whole.substr(0, cut));
    EXPECT_THROW(read_camera_image(folder / "cut.jpg"), Error) << cut;
  }
  std::string garbled = whole;
  for (std::size_t at = 200; at < garbled.size(); at += 97) garbled[at] = static_cast<char>(at);
  put(folder / "garbled.jpg", garbled);
  EXPECT_THROW(read_camera_image(folder / "garbled.jpg"), Error);
}

TEST(NumberMaps, ArePfmOfBothByteOrdersAndScaledGrey) {
  const auto folder = test::scratch_folder();
  NumberMap map{2, 2, {1, 2, std::numeric_limits<float>::quiet_NaN(), 4.5f}};
  write_pfm(folder / "map.pfm", map);
  const NumberMap back = read_number_map(folder / "map.pfm", 1);
  EXPECT_EQ(back.values[0], 1);
  EXPECT_EQ(back.values[3], 4.5f);
  EXPECT_TRUE(std::isnan(back.values[2]));
  put(folder / "big.pfm", std::string("Pf\n1 1\n1.0\n") + std::string("\x40\x20\x00\x00", 4));
  EXPECT_EQ(read_number_map(folder / "big.pfm", 1).values[0], 2.5f);
  CameraImage grey(2, 1, 1);
  grey.samples = {0, 50};
  write_camera_image(folder / "grey.png", grey);
  const NumberMap scaled = read_number_map(folder / "grey.png", 0.25);
  EXPECT_TRUE(std::isnan(scaled.values[0]));
  EXPECT_EQ(scaled.values[1], 12.5f);
  for (const char* bad : {"Pf\n", "Pf\n2 2\n-1\n123", "Pf\n-2 2\n-1\n", "Pf\n2 x\n-1\n", "Pf\n99999 99999\n-1\n"}) {
    put(folder / "bad.pfm", bad);
    EXPECT_THROW(read_number_map(folder / "bad.pfm", 1), Error) << bad;
  }
}

}  // namespace
}  // namespace isobath::camera_pictures
