// Configuration as a property: whatever is written reads back, whatever is read ends in a value or in an Error.
#include <bit>
#include <cmath>
#include <gmock/gmock.h>
#include <isobath/base/config.hpp>
#include <isobath/base/error.hpp>
#include <rapidcheck/gtest.h>

namespace isobath {
namespace {

enum class Update { kBin, kPrinted, kAnyTarget };

struct Sample {
  double real = 0;
  double share = 0;
  int whole = 0;
  bool flag = false;
  std::string text;
  Angle angle;
  Update update = Update::kBin;

  std::vector<Section> sections() {
    return {{"numbers",
             "Numbers.",
             {Field::real("real", &real, {}, "m", "Any real."), Field::real("share", &share, {0, 1}, "1", "A share."),
              Field::integer("whole", &whole, {}, "1", "Any whole number."),
              Field::degrees("angle_deg", &angle, {-720, 720}, "An angle.")}},
            {"words",
             "Words.",
             {Field::flag("flag", &flag, "A switch."), Field::text("text", &text, "A text."),
              Field::choice<Update>(
                  "update", &update,
                  {{"bin", Update::kBin}, {"printed", Update::kPrinted}, {"any_target", Update::kAnyTarget}},
                  "A choice.")}}};
  }
  std::string toml(bool annotated) { return write_toml(sections(), annotated); }
};

/// Any bit pattern of a double but nan: zeros of both signs, subnormal and infinite ones among them.
rc::Gen<double> any_real() {
  return rc::gen::suchThat(
      rc::gen::oneOf(rc::gen::map(rc::gen::arbitrary<std::uint64_t>(), [](auto x) { return std::bit_cast<double>(x); }),
                     rc::gen::arbitrary<double>(), rc::gen::element(0.0, -0.0, INFINITY, -INFINITY, 5e-324, 1e22, 0.1)),
      [](double x) { return !std::isnan(x); });
}

/// UTF-8 of any code points: controls, quotes, backslashes, and up to four bytes.
rc::Gen<std::string> any_text() {
  const auto point =
      rc::gen::oneOf(rc::gen::inRange<std::uint32_t>(0, 0x80), rc::gen::inRange<std::uint32_t>(0x80, 0xd800),
                     rc::gen::inRange<std::uint32_t>(0xe000, 0x110000));
  return rc::gen::map(rc::gen::container<std::vector<std::uint32_t>>(point), [](const auto& points) {
    std::string utf8;
    const auto put = [&](std::uint32_t byte) { utf8 += static_cast<char>(byte); };
    for (const std::uint32_t p : points) {
      if (p < 0x80) {
        put(p);
      } else if (p < 0x800) {
        put(0xc0 | p >> 6), put(0x80 | (p & 0x3f));
      } else if (p < 0x10000) {
        put(0xe0 | p >> 12), put(0x80 | (p >> 6 & 0x3f)), put(0x80 | (p & 0x3f));
      } else {
        put(0xf0 | p >> 18), put(0x80 | (p >> 12 & 0x3f)), put(0x80 | (p >> 6 & 0x3f)), put(0x80 | (p & 0x3f));
      }
    }
    return utf8;
  });
}

RC_GTEST_PROP(ConfigProperty, WhatIsWrittenReadsBackToTheBit, (bool annotated)) {
  Sample a;
  a.real = *any_real();
  a.share = *rc::gen::map(rc::gen::arbitrary<std::uint32_t>(), [](std::uint32_t x) { return x / 4294967295.0; });
  a.whole = *rc::gen::arbitrary<int>();
  a.flag = *rc::gen::arbitrary<bool>();
  a.text = *any_text();
  a.angle = Angle::degrees(*rc::gen::map(rc::gen::inRange(-7200000, 7200001), [](int x) { return x / 1e4; }));
  a.update = *rc::gen::element(Update::kBin, Update::kPrinted, Update::kAnyTarget);
  const std::string text = a.toml(annotated);

  Sample b;
  auto sections = b.sections();
  read_toml(text, "written.toml", sections);
  RC_ASSERT(std::bit_cast<std::uint64_t>(b.real) == std::bit_cast<std::uint64_t>(a.real));
  RC_ASSERT(b.share == a.share);
  RC_ASSERT(b.whole == a.whole);
  RC_ASSERT(b.flag == a.flag);
  RC_ASSERT(b.text == a.text);
  RC_ASSERT(b.angle == a.angle);
  RC_ASSERT(b.update == a.update);
  RC_ASSERT(b.toml(annotated) == text);
}

RC_GTEST_PROP(ConfigProperty, ValuesOutOfRangeAreRefusedAndChangeNothing, ()) {
  const double value = *rc::gen::suchThat(any_real(), [](double x) { return !(x >= 0 && x <= 1); });
  Sample s;
  auto sections = s.sections();
  Sample writer;
  writer.real = value;
  const std::string number = writer.sections()[0].fields[0].value();
  RC_ASSERT_THROWS_AS(read_toml("[numbers]\nshare = " + number, "f.toml", sections), Error);
  RC_ASSERT_THROWS_AS(set_from_text("numbers.share=" + number, sections), Error);
  RC_ASSERT(s.share == 0);
}

RC_GTEST_PROP(ConfigProperty, AnyBytesEndInValuesOrInAnErrorOfOneLine, ()) {
  const auto piece = rc::gen::oneOf(
      rc::gen::element<std::string>("[numbers]\n", "[words]\n", "real", "share", "flag", "text", "=", "1e400", "nan",
                                    "true", "\"", "'''", "{", "[", "]", "\n", ".", "-", "0x", "1979-05-27", "#", "\\u"),
      rc::gen::arbitrary<std::string>());
  const auto pieces = *rc::gen::container<std::vector<std::string>>(piece);
  std::string bytes;
  for (const std::string& p : pieces) bytes += p;
  Sample s;
  auto sections = s.sections();
  for (const bool whole : {true, false}) {
    try {
      whole ? read_toml(bytes, "f.toml", sections) : set_from_text("words.text=" + bytes, sections);
    } catch (const Error& e) {
      RC_ASSERT(std::string(e.what()).find('\n') == std::string::npos);
    }
  }
  RC_ASSERT(s.share >= 0 && s.share <= 1);
}

RC_GTEST_PROP(ConfigProperty, ABareWordSetsATextAsItStands, ()) {
  const std::string word = *rc::gen::nonEmpty(rc::gen::container<std::string>(rc::gen::inRange('a', 'z')));
  RC_PRE(word != "inf" && word != "nan" && word != "true" && word != "false");
  Sample s;
  auto sections = s.sections();
  set_from_text("words.text=" + word, sections);
  RC_ASSERT(s.text == word);
}

TEST(Config, AnglesOfTheEdgesOfTheirRangeReadBack) {
  for (const double edge : {-720.0, -0.1, 0.1, 0.3, 33.3, 359.9, 720.0}) {
    Sample a;
    a.angle = Angle::degrees(edge);
    Sample b;
    auto sections = b.sections();
    read_toml(a.toml(false), "f.toml", sections);
    EXPECT_EQ(a.angle, b.angle) << edge;
  }
}

}  // namespace
}  // namespace isobath
