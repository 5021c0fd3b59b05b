// Point files: points without times or poses, as a survey's result or a scanner's export. PCD of the Point Cloud
// Library (version 0.7: ascii, binary, binary_compressed; fields x, y, z of type F) and text grids of three numbers a
// line.
//
// Axes: x east, y north, z up; x north, y east, z down with InputConfig::axes "ned". In a text grid the third number is
// a depth, with the unit and sign of InputConfig::survey (csv_depth_unit, csv_depth_sign). Positions are metres of a
// local plane, unless csv_position names a zone of the UTM grid ("utm 33N"), which gives the map its place on the
// globe. The origin of W is then the first point; also without a zone where the first point lies over 10 km from 0.
//
// The points become soundings on the bottom, tile by tile of kPointTile, in lines to and fro, each seen by a vehicle
// that lies on the surface over the middle of the tile; tiles are a second apart. Points above the water, and those
// that are not finite, are counted. Untrusted: at most kMaxFilePoints points; a header that claims more than its file
// holds gives those that it holds. Errors: throws Error for a header that cannot be read or lacks x, y, z.
#pragma once

#include <filesystem>
#include <isobath/event/event.hpp>
#include <isobath/io/bytes/bytes.hpp>
#include <isobath/io/input/input_config.hpp>
#include <memory>
#include <span>

namespace isobath {

bool looks_like_pcd(std::span<const std::uint8_t> head);
/// Lines of three numbers and of nothing else, but for comments (#).
bool looks_like_xyz(std::span<const std::uint8_t> head);
std::unique_ptr<Source> open_pcd(const std::filesystem::path& file, const InputConfig& config);
std::unique_ptr<Source> open_xyz(const std::filesystem::path& file, const InputConfig& config);
/// The same of bytes in memory.
std::unique_ptr<Source> points_of_pcd(Bytes bytes, const std::string& name, const InputConfig& config);
std::unique_ptr<Source> points_of_xyz(Bytes bytes, const std::string& name, const InputConfig& config);

}  // namespace isobath
