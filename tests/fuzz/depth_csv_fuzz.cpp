// Tables of depths: the first line declares the columns, the second the kind of positions, the rest is any text.
#include <cstdint>
#include <isobath/base/error.hpp>
#include <isobath/io/formats/depth_csv.hpp>
#include <sstream>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace isobath;
  std::istringstream text(std::string(reinterpret_cast<const char*>(data), size));
  InputConfig config;
  std::getline(text, config.survey.csv_columns);
  std::getline(text, config.survey.csv_position);
  if (config.survey.csv_position.ends_with('s')) config.survey.csv_time = CsvTime::kSeconds;
  std::string rest(std::istreambuf_iterator<char>(text), {});
  try {
    const Bytes head = std::as_bytes(std::span(rest));
    looks_like_depth_csv(head, config.survey);
    table_columns(head);
    const auto source = open_depth_csv(std::make_unique<std::istringstream>(rest), "fuzz", config);
    while (const auto event = source->next()) {
      const auto* const fix = std::get_if<Navigation>(&*event);
      if (fix && !fix->X_WB.is_finite()) __builtin_trap();
      const auto* const reading = std::get_if<RangeReading>(&*event);
      if (reading && !(*reading->range_m > 0)) __builtin_trap();
    }
  } catch (const Error&) {
  }
  return 0;
}
