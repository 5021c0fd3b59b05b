#include <gmock/gmock.h>
#include <isobath/base/config.hpp>
#include <isobath/base/error.hpp>
#include <tests/support/data.hpp>

namespace isobath::config_test {
namespace {

enum class Fruit { kApple, kPear };

struct Sample {
  double share = 0.25;
  int count = 3;
  bool on = false;
  std::string name = "a \"b\"\n";
  Angle turn = Angle::degrees(90);
  Fruit fruit = Fruit::kApple;
  std::vector<Section> sections() {
    return {{"sample",
             "A section.",
             {Field::real("share", &share, {0, 1}, "1", "A share."),
              Field::integer("count", &count, {1, 10}, "1", "A count."), Field::flag("on", &on, "A switch."),
              Field::text("name", &name, "A text."), Field::degrees("turn_deg", &turn, {-180, 180}, "A turn."),
              Field::choice<Fruit>("fruit", &fruit, {{"apple", Fruit::kApple}, {"pear", Fruit::kPear}}, "A fruit.")}}};
  }
};

std::string error_of(const std::string& toml) {
  Sample s;
  auto sections = s.sections();
  try {
    read_toml(toml, "f.toml", sections);
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

TEST(Config, WrittenDefaultsReadBackUnchanged) {
  Sample a;
  a.share = 0.1;
  a.fruit = Fruit::kPear;
  const std::string text = write_toml(a.sections(), true);
  Sample b;
  auto sections = b.sections();
  read_toml(text, "x", sections);
  EXPECT_EQ(b.share, 0.1);
  EXPECT_EQ(b.name, "a \"b\"\n");
  EXPECT_EQ(b.fruit, Fruit::kPear);
  EXPECT_EQ(write_toml(b.sections(), true), text);
  EXPECT_THAT(text, testing::HasSubstr("turn_deg = 90.0\n"));
}

TEST(Config, UnknownKeyNamesLineColumnAndNearestKey) {
  EXPECT_EQ(error_of("[sample]\n  shore = 1\n"), "f.toml:2:3: sample.shore: unknown key; did you mean share?");
  EXPECT_THAT(error_of("[sampel]\n"), testing::HasSubstr("unknown section; allowed: sample; did you mean sample?"));
}

TEST(Config, AValueThatIsNoChoiceNamesTheNearest) {
  EXPECT_THAT(error_of("[sample]\nfruit = \"pera\""),
              testing::HasSubstr("is not one of the choices; allowed: apple or pear; did you mean pear?"));
}

TEST(Config, ASettingOfTheCommandLineHasNeitherLineNorColumn) {
  Sample s;
  auto sections = s.sections();
  const auto error = [&](const std::string& setting) -> std::string {
    try {
      set_from_text(setting, sections);
    } catch (const Error& e) {
      EXPECT_FALSE(e.where().line);
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(error("sample.shore=1"), "--set sample.shore=1: sample.shore: unknown key; did you mean share?");
  EXPECT_EQ(error("share=1"), "--set share=1: not of the form section.key=value; did you mean sample.share?");
}

TEST(Config, ValueOutOfRangeNamesTheRange) {
  EXPECT_EQ(error_of("[sample]\nshare = 1.5"), "f.toml:2:9: sample.share: 1.5 is out of range; allowed: 0 .. 1 1");
  EXPECT_THAT(error_of("[sample]\nshare = nan"), testing::HasSubstr("nan"));
  EXPECT_THAT(error_of("[sample]\ncount = 2.5"), testing::HasSubstr("not a whole number"));
  EXPECT_THAT(error_of("[sample]\nfruit = \"plum\""), testing::HasSubstr("allowed: apple or pear"));
  EXPECT_THAT(error_of("[sample]\nturn_deg = [1]"), testing::HasSubstr("not a number"));
  EXPECT_THAT(error_of("[sample\n"), testing::StartsWith("f.toml:1:"));
}

TEST(Config, SetFromTextTakesBareWordsAndNumbers) {
  Sample s;
  auto sections = s.sections();
  set_from_text("sample.fruit=pear", sections);
  set_from_text("sample.turn_deg=-45", sections);
  EXPECT_EQ(s.fruit, Fruit::kPear);
  EXPECT_DOUBLE_EQ(s.turn.degrees(), -45);
  EXPECT_THROW(set_from_text("sample.share=2", sections), Error);
  EXPECT_THROW(set_from_text("nonsense", sections), Error);
}

}  // namespace
}  // namespace isobath::config_test
