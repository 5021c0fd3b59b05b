// Words of a request: paths, hosts, origins and codings, good and bad.
#include <gmock/gmock.h>
#include <isobath/server/web_counts.hpp>
#include <isobath/server/web_request.hpp>

namespace isobath {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(WebRequest, PathsAreReadOnce) {
  EXPECT_EQ(path_of_target("/"), "/");
  EXPECT_EQ(path_of_target("/page.js?v=1&w=%zz"), "/page.js");
  EXPECT_EQ(path_of_target("/a%20b%2Fc"), "/a b/c");
  EXPECT_EQ(path_of_target("/%C3%A9\xc3\xa9"), "/\xc3\xa9\xc3\xa9");
  EXPECT_EQ(path_of_target("/%252e%252e"), "/%2e%2e");
  EXPECT_EQ(path_of_target("/..."), "/...");
}

TEST(WebRequest, PathsThatNoPageHas) {
  for (const char* target : {"",
                             "*",
                             "page",
                             "http://localhost/",
                             "/..",
                             "/../etc/passwd",
                             "/a/../b",
                             "/./a",
                             "/%2e%2e/etc/passwd",
                             "/.%2E",
                             "/%2e",
                             "/..%2fetc",
                             "/..\\etc",
                             "/%5c",
                             "/%",
                             "/%1",
                             "/%zz",
                             "/%-1",
                             "/%+1",
                             "/%00",
                             "/a%0d%0ab",
                             "/\x7f",
                             "/%ff",
                             "/%c0%ae%c0%ae",
                             "/%e0%80%af",
                             "/%ed%a0%80",
                             "/%f4%90%80%80",
                             "/%c3",
                             "/%e2%82"}) {
    EXPECT_FALSE(path_of_target(target)) << target;
  }
  EXPECT_FALSE(path_of_target(std::string_view("/\0", 2)));
}

TEST(WebRequest, HostsThatNobodyElseCanPointHere) {
  const std::vector<std::string> names = names_of_list("Boat.Example, buoy");
  EXPECT_THAT(names, ElementsAre("boat.example", "buoy"));
  EXPECT_THAT(names_of_list(" , "), IsEmpty());
  for (const char* host : {"localhost", "LocalHost:8484", "127.0.0.1", "127.0.0.1:8484", "192.168.1.7:1", "[::1]",
                           "[::1]:8484", "[fe80::1]:99999", "boat.example", "BOAT.example:80", "buoy"}) {
    EXPECT_TRUE(is_own_host(host, names)) << host;
  }
  for (const char* host : {"",
                           ":8484",
                           "evil.example",
                           "localhost.evil.example",
                           "127.0.0.1.evil.example",
                           "localhost.",
                           "localhost:",
                           "localhost:80:80",
                           "localhost:8x",
                           "localhost:123456",
                           "1270.0.0.1",
                           "127.1",
                           "[::1",
                           "[::1]x",
                           "[localhost]",
                           "[]",
                           "::1",
                           "boat.example.",
                           "boat",
                           "localhost/",
                           " localhost",
                           "localhost\"",
                           "user@localhost"}) {
    EXPECT_FALSE(is_own_host(host, names)) << host;
  }
  EXPECT_FALSE(is_own_host(std::string_view("127.0.0.1\0.evil", 15), names));
  EXPECT_FALSE(is_own_host(std::string_view("[::1\0]", 6), names));
}

TEST(WebRequest, OriginsOfPagesOfOurOwn) {
  EXPECT_TRUE(is_origin_of("http://localhost:8484", "localhost:8484"));
  EXPECT_TRUE(is_origin_of("https://Boat.example", "boat.example"));
  for (const char* origin : {"", "null", "http://localhost", "http://localhost:8485", "http://evil.example",
                             "http://localhost:8484.evil.example", "http://localhost:8484/", "file://localhost:8484",
                             "localhost:8484", "http://127.0.0.1:8484"}) {
    EXPECT_FALSE(is_origin_of(origin, "localhost:8484")) << origin;
  }
}

TEST(WebRequest, Codings) {
  for (const char* takes : {"gzip", "GZIP", "deflate, gzip, br", "br;q=1.0, gzip;q=0.8", "gzip ; q=0.001"}) {
    EXPECT_TRUE(takes_gzip(takes)) << takes;
  }
  for (const char* not_taken :
       {"", "*", "identity", "x-gzip", "gzipped", "gzip;q=0", "gzip;q=0.000", "br, gzip; q=0"}) {
    EXPECT_FALSE(takes_gzip(not_taken)) << not_taken;
  }
}

TEST(WebCounts, AsPrometheusReadsThem) {
  WebCounts counts;
  counts.clients = 2;
  counts.frame_bytes = 12345678901;
  counts.refuse("origin");
  counts.refuse("host");
  counts.refuse("origin");
  const std::string text = to_prometheus(counts);
  EXPECT_THAT(text, HasSubstr("# TYPE isobath_web_clients gauge\nisobath_web_clients 2\n"));
  EXPECT_THAT(text, HasSubstr("\nisobath_web_frame_bytes_total 12345678901\n"));
  EXPECT_THAT(text, HasSubstr("\nisobath_web_refused_total{reason=\"host\"} 1\n"
                              "isobath_web_refused_total{reason=\"origin\"} 2\n"));
}

}  // namespace
}  // namespace isobath
