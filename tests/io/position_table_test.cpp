// Tables of positions of bodies, such as AIS reports.
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <isobath/base/error.hpp>
#include <isobath/io/input/position_table.hpp>
#include <string>

namespace isobath::position_table {
namespace {

namespace fs = std::filesystem;

fs::path table_of(const char* name, const std::string& text) {
  const fs::path file = fs::path(testing::TempDir()) / fmt::format("position_table_{}.csv", name);
  std::ofstream(file) << text;
  return file;
}

TEST(PositionTable, LeavesOutAndCountsBadRows) {
  const PositionTable table =
      read_positions(table_of("bad",
                              "Time,MMSI,Latitude_degrees,Longitude_degrees,COG_degrees,SOG_knots\n"
                              "2016-01-12 13:02:11.218,1,50.77,-1.09,157.8,5.9\n"
                              "2016-01-12 13:02:12,2,50.77,54.8,0,1\n"
                              "2016-01-12 13:02:13,3,95,0,0,1\n"
                              "yesterday,4,50.77,-1.09,0,1\n"
                              "2016-01-12 13:02:10,5,50.78,-1.08,360,102.3\n"));
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_LT(table.rows[0].time, table.rows[1].time);
  EXPECT_FALSE(table.rows[0].velocity_W);
  ASSERT_TRUE(table.rows[1].velocity_W);
  EXPECT_NEAR(table.rows[1].velocity_W->norm(), 5.9 * 1852 / 3600, 1e-9);
  EXPECT_EQ(table.left_out.at("row too far away"), 1U);
  EXPECT_EQ(table.left_out.at("row without a possible position"), 1U);
  EXPECT_EQ(table.left_out.at("row without a time"), 1U);
  EXPECT_THROW(read_positions(table_of("empty", "time,north,east\n")), Error);
  EXPECT_THROW(read_positions(table_of("columns", "time,depth\n1,2\n")), Error);
}

}  // namespace
}  // namespace isobath::position_table
