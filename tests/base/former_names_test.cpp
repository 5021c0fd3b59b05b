// Keys and sections that have a new name: for one release the error on the old name gives the new one.
#include <gmock/gmock.h>
#include <isobath/base/config.hpp>

namespace isobath {
namespace {

struct Renamed {
  int bins = 3;
  bool on = false;
  double radius = 1;
  std::vector<Section> sections() {
    return {{"sonar",
             "A section.",
             {Field::integer("max_bins", &bins, {1, 10}, "1", "A count.").was("most_bins"),
              Field::flag("on", &on, "A switch.")},
             {},
             "sounder"}};
  }
  Schema schema() {
    return {sections(), {{"ball", "A ball.", [this](const Place&) {
                            return std::vector{Field::real("radius", &radius, {0, 9}, "m", "Its size.").was("girth")};
                          }}}};
  }
};

template <class Action>
std::string refusal_of(const Action& act) {
  try {
    act();
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}
std::string refusal_of_file(const std::string& toml) {
  Renamed s;
  Schema schema = s.schema();
  return refusal_of([&] { read_toml(toml, "f.toml", schema); });
}

TEST(FormerNames, OfKeysGiveTheNewKeyInAFileAListAndASetting) {
  EXPECT_EQ(refusal_of_file("[sonar]\nmost_bins = 5\n"),
            "f.toml:2:1: sonar.most_bins: unknown key; it is called max_bins now");
  EXPECT_EQ(refusal_of_file("[[ball]]\n girth = 1\n"), "f.toml:2:2: ball.girth: unknown key; it is called radius now");
  Renamed s;
  auto sections = s.sections();
  EXPECT_THAT(refusal_of([&] { set_from_text("sonar.most_bins=5", sections); }),
              testing::EndsWith("sonar.most_bins: unknown key; it is called max_bins now"));
  EXPECT_EQ(s.bins, 3) << "the old key sets nothing";
}

TEST(FormerNames, OfSectionsGiveTheNewSection) {
  EXPECT_THAT(refusal_of_file("[sounder]\nmax_bins = 5\n"), testing::EndsWith("; it is called sonar now"));
}

TEST(FormerNames, LeaveTheAdviceOnOtherNamesAsItWas) {
  EXPECT_THAT(refusal_of_file("[sonar]\nmax_bin = 5\n"), testing::EndsWith("unknown key; did you mean max_bins?"));
  EXPECT_THAT(refusal_of_file("[\"\"]\n"), testing::HasSubstr("unknown section"));
  EXPECT_THAT(refusal_of_file("[sonar]\n\"\" = 5\n"), testing::Not(testing::HasSubstr("is called")))
      << "a field without a former name has none, not an empty one";
}

TEST(FormerNames, AreNotWritten) {
  Renamed s;
  EXPECT_EQ(write_toml(s.sections(), false), "[sonar]\nmax_bins = 3\non = false\n");
}

}  // namespace
}  // namespace isobath
