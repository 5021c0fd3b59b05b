#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/base/printable_text.hpp>

namespace isobath {
namespace {
using testing::EndsWith, testing::StartsWith;

TEST(PrintableText, LeavesTextAsItIs) {
  for (const char* text : {"", "Lake Erie",
                           "Seebr\xC3\xBC"
                           "cke",
                           "\xE6\xB9\x96", "\xF0\x9F\x90\x9F"}) {
    EXPECT_EQ(printable_text(text), text);
  }
}

TEST(PrintableText, HoldsNoCommandForATerminal) {
  EXPECT_EQ(printable_text("a\x1b[2Jb"), "a [2Jb");
  EXPECT_EQ(printable_text("a\r\n\tb\x7f"), "a   b ");
  EXPECT_EQ(printable_text("a\xC2\x9B"
                           "2J"),
            "a 2J")
      << "a terminal takes U+009B for ESC [";
  EXPECT_EQ(printable_text("a\xE2\x80\xAE"
                           "b"),
            "a b")
      << "U+202E would show what follows backwards";
}

TEST(PrintableText, IsUtf8WhateverTheBytes) {
  const std::string none = "\xEF\xBF\xBD";
  EXPECT_EQ(printable_text("\xFF"
                           "a\xC3"),
            none + "a" + none);
  EXPECT_EQ(printable_text("\xC0\x80"), none + none) << "longer than needed";
  EXPECT_EQ(printable_text("\xED\xA0\x80"), none + none + none) << "half of a pair of UTF-16";
  EXPECT_EQ(printable_text("\xF4\x90\x80\x80"), none + none + none + none) << "beyond Unicode";
}

TEST(PrintableText, ShowsBeginningAndEndOfALongText) {
  const std::string text = "start" + std::string(100'000, 'x') + "end";
  const std::string shown = printable_text(text, 40);
  EXPECT_EQ(shown.size(), 45u);
  EXPECT_THAT(shown, StartsWith("startxxx"));
  EXPECT_THAT(shown, EndsWith("xxend"));
  EXPECT_EQ(printable_text("\xC3\xBC\xC3\xBC", 2), "\xC3\xBC\xC3\xBC") << "characters count, not bytes";
}

TEST(PrintableText, KeepsTheLinesOfAnOutput) {
  EXPECT_EQ(printable_lines("a\tb\n\x1b"
                            "c\n"),
            "a\tb\n c\n");
}

TEST(Error, IsShortHoweverLongTheTextsOfTheInputAre) {
  const std::string kilometres(100'000, 'k');
  const Error e("\"" + kilometres + "\" is not a number", {kilometres, {}, {}, {}, kilometres}, kilometres, kilometres);
  EXPECT_LT(std::string(e.what()).size(), 3000u);
  EXPECT_THAT(e.what(), testing::HasSubstr("is not a number")) << "what is wrong stands at the end";
}

}  // namespace
}  // namespace isobath
