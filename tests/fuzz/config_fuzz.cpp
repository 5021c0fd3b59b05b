// Any bytes as a configuration: they end in checked values or in an Error of one line, and what was read is written so
// that it reads back the same.
#include <cstddef>
#include <cstdint>
#include <isobath/base/config.hpp>
#include <isobath/base/error.hpp>

namespace {

enum class Update { kBin, kPrinted };

struct Sample {
  double share = 0.5;
  int count = 3;
  bool flag = false;
  std::string text = "text";
  isobath::Angle angle = isobath::Angle::degrees(90);
  Update update = Update::kBin;

  std::vector<isobath::Section> sections() {
    using isobath::Field;
    return {{"grid",
             "Numbers.",
             {Field::real("share", &share, {0, 1}, "1", "A share."),
              Field::integer("count", &count, {1, 10}, "1", "A count."),
              Field::degrees("angle_deg", &angle, {-180, 180}, "An angle.")}},
            {"input",
             "Words.",
             {Field::flag("flag", &flag, "A switch."), Field::text("text", &text, "A text."),
              Field::choice<Update>("update", &update, {{"bin", Update::kBin}, {"printed", Update::kPrinted}},
                                    "A choice.")}}};
  }
};

/// Whether the bytes were taken.
bool read(std::string_view bytes, Sample& sample) {
  std::vector<isobath::Section> sections = sample.sections();
  try {
    isobath::read_toml(bytes, "fuzz.toml", sections);
  } catch (const isobath::Error& error) {
    ISOBATH_ASSERT(std::string_view(error.what()).find('\n') == std::string_view::npos);
    return false;
  }
  return true;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  Sample first;
  if (read(bytes, first)) {
    const std::string written = isobath::write_toml(first.sections(), true);
    Sample second;
    ISOBATH_ASSERT(read(written, second));
    ISOBATH_ASSERT(isobath::write_toml(second.sections(), true) == written);
  }
  ISOBATH_ASSERT(first.share >= 0 && first.share <= 1 && first.count >= 1 && first.count <= 10);
  try {
    std::vector<isobath::Section> sections = first.sections();
    isobath::set_from_text(bytes, sections);
  } catch (const isobath::Error&) {
  }
  return 0;
}
