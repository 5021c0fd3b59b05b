// Texts that the parser of toml++ takes for impossible are errors with a place; TOML that it can take is let through.
#include <gtest/gtest.h>
#include <isobath/base/config.hpp>
#include <isobath/base/toml_text.hpp>

namespace isobath::toml_text_test {
namespace {

struct Sample {
  std::string text;
  std::vector<double> numbers;
};

Sample read(const std::string& toml) {
  Sample sample;
  std::vector<Section> sections = {{"s",
                                    "A section.",
                                    {Field::text("text", &sample.text, "A text."),
                                     Field::rows("numbers", &sample.numbers, 1, {}, "1", "Numbers.")}}};
  read_toml(toml, "f.toml", sections);
  return sample;
}

std::string refusal(const std::string& toml) {
  try {
    read(toml);
  } catch (const Error& error) {
    return error.what();
  }
  return "taken";
}

std::string repeated(const std::string& part, int times) {
  std::string text;
  for (int i = 0; i < times; ++i) text += part;
  return text;
}

TEST(TomlText, WhatTheParserTakesForImpossibleIsAnErrorWithItsPlace) {
  EXPECT_EQ(refusal("[%"), "f.toml:1:2: no name after the [ of a table");
  EXPECT_EQ(refusal("[s]\n[[ =]]"), "f.toml:2:4: no name after the [ of a table");
  EXPECT_EQ(refusal("[s]\nnumbers = [}"), "f.toml:2:12: a } cannot close a [");
  EXPECT_EQ(refusal("[s]\nnumbers = 1 }"), "f.toml:2:13: a } without an opening bracket");
  EXPECT_EQ(refusal("[s]\nnumbers = [1979-05-27 0]"), "f.toml:2:22: a date and a time; write them as a text in quotes");
}

TEST(TomlText, OutsideQuotesAndCommentsAllIsAscii) {
  const std::string problem = "a character that is not ASCII outside quotes and comments";
  EXPECT_EQ(refusal("[s]\nt\u00e9xt = \"a\""), "f.toml:2:2: " + problem);
  EXPECT_EQ(refusal("[s]\ntext = \u201ca\u201d"), "f.toml:2:8: " + problem);
  EXPECT_EQ(refusal("[s]\ntext = \"\u00e9\u00e9\" \u00b0"), "f.toml:2:13: " + problem) << "columns are characters";
  EXPECT_EQ(refusal("[s]\ntext = \"a\"\xff"), "f.toml:2:11: " + problem);
  EXPECT_EQ(refusal("[s]\ntext = \"\\\u00e9\""), "f.toml:2:10: a character that is not ASCII after a backslash");
  EXPECT_EQ(refusal("[s]\ntext = \"\"\"a \\\n  \u00e9\"\"\""),
            "f.toml:3:3: a character that is not ASCII at the start of a continued line; write \\u and four digits");
}

TEST(TomlText, Utf8IsWelcomeInQuotesAndComments) {
  EXPECT_EQ(
      read("\xEF\xBB\xBF# 3\u00b0 of \u6df1\u5ea6, it's \"open\n[s] # \u00e9\ntext = \"1\u00b0\" # \U0001F30A").text,
      "1\u00b0");
  EXPECT_EQ(read("[s]\ntext = 'C:\\\u00e9'").text, "C:\\\u00e9");
  EXPECT_EQ(read("[s]\n\"text\" = \"\"\"\na \\\n   b\u00e9 \"\" \\\" #\"\"\"\"\"").text, "a b\u00e9 \"\" \" #\"\"");
  EXPECT_EQ(read("[s]\ntext = '''\n\u00e9'\n\\'''").text, "\u00e9'\n\\");
  EXPECT_EQ(read("[s]\nnumbers = [\n  1_0, # ten, \u00e9\n  -2.5]\n").numbers, (std::vector<double>{10, -2.5}));
  EXPECT_EQ(read("s = { text = \"\", numbers = [ ] }").text, "");
}

TEST(TomlText, QuotesBeginWhereAValueOrAKeyDoesAndEnd) {
  EXPECT_EQ(refusal("[s]\ntext = 1\"a\""), "f.toml:2:9: a quote inside a word");
  EXPECT_EQ(refusal("[s]\ntext = '''''''''"), "f.toml:2:16: a quote inside a word") << "three, two of the text, three";
  EXPECT_EQ(refusal("[s]\ntext = \"a\n\""), "f.toml:2:8: a text without a closing quote");
  EXPECT_EQ(refusal("[s]\ntext = '''a''"), "f.toml:2:8: a text without a closing quote");
  EXPECT_EQ(refusal("[s]\ntext = \"a\\"), "f.toml:2:8: a text without a closing quote");
}

TEST(TomlText, TablesInTablesEnd) {
  const std::string deep = repeated("[", kDeepestBrackets) + repeated("]", kDeepestBrackets);
  EXPECT_NO_THROW(check_toml_text("a = " + deep, "f.toml"));
  EXPECT_EQ(refusal("a = [" + deep + "]"), "f.toml:1:37: brackets nested deeper than 32");
  const std::string long_key = "a" + repeated(".a", kMaxKeyParts - 1);
  EXPECT_NO_THROW(check_toml_text("[" + long_key + "]\n" + long_key + " = [1.5, " + repeated("1.5,", 100) + "]", "f"));
  EXPECT_EQ(refusal("[a" + repeated(".a", 1000000) + "]"), "f.toml:1:33: a key of more than 16 parts");
}

TEST(TomlText, AssignmentsOfTheCommandLineAreCheckedToo) {
  Sample sample;
  std::vector<Section> sections = {{"s", "A section.", {Field::text("text", &sample.text, "A text.")}}};
  set_from_text("s.text=[}", sections);
  EXPECT_EQ(sample.text, "[}") << "a bare word";
  EXPECT_THROW(set_from_text("%.text=1", sections), Error);
  set_from_text("s.text=3\u00b0", sections);
  EXPECT_EQ(sample.text, "3\u00b0");
}

}  // namespace
}  // namespace isobath::toml_text_test
