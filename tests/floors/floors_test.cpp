// The law of rooms and floors, checked on the sources: who may include whom, and what may not stand in a library at
// all.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <gmock/gmock.h>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <tests/support/data.hpp>
#include <utility>
#include <vector>

namespace isobath {
namespace {

namespace fs = std::filesystem;
using Names = std::set<std::string>;

/// Room -> what stands on its line of isobath/rooms.toml. A room within a room is named with its path: "map/depth".
const std::map<std::string, Names>& law() {
  static const std::map<std::string, Names> table = [] {
    static const std::regex line(R"re("?([a-z/]+)"? = "([a-z/ ]*)")re");
    std::map<std::string, Names> rooms;
    std::ifstream file(test::source_folder() / "isobath" / "rooms.toml");
    for (std::string text; std::getline(file, text);) {
      std::smatch match;
      if (!std::regex_match(text, match, line)) continue;
      std::istringstream words(match[2].str());
      rooms[match[1]] = Names(std::istream_iterator<std::string>(words), {});
    }
    return rooms;
  }();
  return table;
}

/// Whether `room` is `other` or stands in it.
bool is_within(const std::string& room, const std::string& other) {
  return room == other || room.starts_with(other + "/");
}

/// The room of a file or of an include: the innermost folder that is one, "map/depth" for isobath/map/depth/x.hpp.
/// Empty for what is not ours.
std::string room_of(const std::string& path) {
  const std::string prefix = "isobath/";
  if (!path.starts_with(prefix)) return "";
  std::string folder = path.substr(prefix.size());
  while (folder.find('/') != std::string::npos) {
    folder.erase(folder.rfind('/'));
    if (law().contains(folder)) return folder;
  }
  return folder;
}

/// Whether the law lets a file of one room include a file of another.
bool may_include(const std::string& room, const std::string& other) {
  if (room == other) return true;
  const Names& line = law().at(room);
  return std::any_of(line.begin(), line.end(), [&](const std::string& named) { return is_within(other, named); });
}

struct SourceFile {
  std::string path;  ///< from the root of the project
  std::string room;
  std::vector<std::string> includes;
  std::string text;  ///< without comments and without what stands in quotes

  [[nodiscard]] bool header() const { return path.ends_with(".hpp"); }
  [[nodiscard]] bool library() const { return room != "app"; }
};

/// Where the comment or the literal that starts at `from` ends; `from` itself where neither starts.
std::size_t end_of_noise(const std::string& text, std::size_t from) {
  const auto past = [&](const std::string& end, std::size_t at) {
    const std::size_t found = text.find(end, at);
    return found == std::string::npos ? text.size() : found + end.size();
  };
  if (text.compare(from, 2, "//") == 0) return std::min(text.find('\n', from), text.size());
  if (text.compare(from, 2, "/*") == 0) return past("*/", from + 2);
  if (text.compare(from, 2, "R\"") == 0) {
    const std::size_t open = std::min(text.find('(', from), text.size());
    return past(")" + text.substr(from + 2, open - from - 2) + "\"", open);
  }
  const bool separator = text[from] == '\'' && from > 0 && std::isalnum(static_cast<unsigned char>(text[from - 1]));
  if ((text[from] != '"' && text[from] != '\'') || separator) return from;
  std::size_t at = from + 1;
  while (at < text.size() && text[at] != text[from] && text[at] != '\n') at += text[at] == '\\' ? 2 : 1;
  return std::min(at + 1, text.size());
}

/// Blanks comments and literals, so that words in them are not taken for code.
std::string code_of(const std::string& text) {
  std::string code;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = end_of_noise(text, at);
    code += end > at ? ' ' : text[at];
    at = std::max(end, at + 1);
  }
  return code;
}

/// The names in angle brackets; those in quotes keep their first quote.
std::vector<std::string> includes_of(const std::string& text) {
  static const std::regex include(R"re([ \t]*#[ \t]*include[ \t]*([<"])([^>"]+)[>"].*)re");
  std::vector<std::string> names;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (std::regex_match(line, match, include)) names.push_back((match[1] == "\"" ? "\"" : "") + match[2].str());
  }
  return names;
}

std::vector<SourceFile> read_sources() {
  std::vector<SourceFile> files;
  const fs::path root = test::source_folder();
  for (const auto& entry : fs::recursive_directory_iterator(root / "isobath")) {
    const fs::path extension = entry.path().extension();
    if (extension != ".hpp" && extension != ".cpp") continue;
    std::ostringstream text;
    text << std::ifstream(entry.path()).rdbuf();
    const fs::path path = fs::relative(entry.path(), root);
    files.push_back({path.string(), room_of(path.string()), includes_of(text.str()), code_of(text.str())});
  }
  std::sort(files.begin(), files.end(), [](const SourceFile& a, const SourceFile& b) { return a.path < b.path; });
  return files;
}

const std::vector<SourceFile>& sources() {
  static const std::vector<SourceFile> files = read_sources();
  return files;
}

/// "path: text" for each file that the rule complains about; the rule returns an empty text where all is well.
std::vector<std::string> complaints(const std::function<std::string(const SourceFile&)>& rule) {
  std::vector<std::string> found;
  for (const SourceFile& file : sources()) {
    const std::string text = rule(file);
    if (!text.empty()) found.push_back(file.path + ": " + text);
  }
  return found;
}

std::string first_match(const std::string& text, const std::string& pattern) {
  std::smatch match;
  return std::regex_search(text, match, std::regex(pattern)) ? match.str() : "";
}

/// The first include that the law forbids to a file of this room; empty if there is none.
std::string forbidden_of(const std::string& room, const std::vector<std::string>& includes) {
  for (const std::string& include : includes) {
    const std::string other = room_of(include);
    if (!other.empty() && !may_include(room, other)) return include;
  }
  return "";
}

/// Takes away rooms from the ground up; what is left stands in circles.
Names rooms_in_circles(std::map<std::string, Names> open) {
  while (true) {
    const auto ground = std::find_if(open.begin(), open.end(), [](const auto& room) { return room.second.empty(); });
    if (ground == open.end()) break;
    const std::string name = ground->first;
    open.erase(ground);
    for (auto& room : open) room.second.erase(name);
  }
  Names left;
  for (const auto& room : open) left.insert(room.first);
  return left;
}

TEST(Floors, TableHasNoCircle) {
  const auto whole = [](const std::string& name) { return name.substr(0, name.find('/')); };
  std::map<std::string, Names> rooms, wholes;  // sub-rooms by themselves, and as parts of their rooms
  for (const auto& [room, line] : law()) {
    rooms[room];
    wholes[whole(room)];
    for (const auto& [other, unused] : law()) {
      if (other == room || !may_include(room, other)) continue;
      rooms[room].insert(other);
      if (whole(other) != whole(room)) wholes[whole(room)].insert(whole(other));
    }
  }
  EXPECT_THAT(rooms_in_circles(rooms), testing::IsEmpty());
  EXPECT_THAT(rooms_in_circles(wholes), testing::IsEmpty());
  rooms["base"].insert("map/depth");
  EXPECT_THAT(rooms_in_circles(rooms), testing::IsSupersetOf({"base", "map/storage", "map/depth"}));
}

TEST(Floors, EveryFolderIsARoomOfTheTable) {
  ASSERT_GT(sources().size(), 10u);
  for (const auto& entry : fs::directory_iterator(test::source_folder() / "isobath")) {
    if (entry.path().filename() == "rooms.toml") continue;
    EXPECT_TRUE(entry.is_directory()) << entry.path() << " stands in no room";
    EXPECT_FALSE(fs::is_empty(entry.path())) << entry.path() << " is empty";
  }
  const Names modules = {"io/exports/vdb", "stereo/chessboard"};  // loaded by a room, and linked into none
  Names rooms;
  for (const SourceFile& file : sources()) {
    const std::size_t from = std::string("isobath/").size();
    const std::string folder = file.path.substr(from, file.path.rfind('/') - from);
    if (modules.contains(folder)) continue;
    EXPECT_EQ(file.room, folder) << file.path << ": its folder is no room of the table";
    rooms.insert(folder);
  }
  const auto known = [](const std::string& name) {
    return std::any_of(law().begin(), law().end(), [&](const auto& room) { return is_within(room.first, name); });
  };
  for (const auto& [room, line] : law()) {
    EXPECT_TRUE(rooms.contains(room)) << room << " is a room of the table, and holds nothing";
    for (const std::string& named : line) EXPECT_TRUE(known(named)) << room << " names " << named;
  }
}

// A folder that shows more is asked whether it is two rooms.
TEST(Floors, NoFolderHasMoreThanFortyFiveUnits) {
  std::map<std::string, Names> units;
  for (const SourceFile& file : sources()) {
    units[file.path.substr(0, file.path.rfind('/'))].insert(file.path.substr(0, file.path.rfind('.')));
  }
  for (const auto& [folder, names] : units) EXPECT_LE(names.size(), 45u) << folder;
}

TEST(Floors, RoomsIncludeOnlyWhatTheirLineAllows) {
  const auto found = complaints([](const SourceFile& file) -> std::string {
    const std::string include = forbidden_of(file.room, file.includes);
    return include.empty() ? "" : "includes " + include;
  });
  EXPECT_THAT(found, testing::IsEmpty());
}

TEST(Floors, APlantedIncludeUpwardsIsFound) {
  const std::pair<const char*, const char*> planted[] = {
      {"base", "isobath/geometry/pose.hpp"},
      {"map/storage", "isobath/map/depth/depth_map.hpp"},  // within a room
      {"map/depth", "isobath/map/voxel/voxel_map.hpp"},
      {"io/bytes", "isobath/io/open_source.hpp"},
      {"io/formats/ping", "isobath/io/formats/tritech/tritech_protocol.hpp"},
      {"mission/plan", "isobath/mission/agents/navigator.hpp"},
      {"report/plot", "isobath/report/html_report.hpp"},
      {"sim", "isobath/map/depth/depth_map.hpp"},
      {"world", "isobath/onboard/pipeline.hpp"},
      {"onboard", "isobath/sim/simulator.hpp"},  // what flies sees no truth, and draws nothing
      {"onboard", "isobath/report/plot/picture.hpp"},
      {"onboard", "isobath/evaluation/evaluation_suite.hpp"},
  };
  for (const auto& [room, include] : planted) {
    EXPECT_TRUE(fs::exists(test::source_folder() / include)) << include;
    EXPECT_EQ(forbidden_of(room, {"vector", include}), include) << room;
  }
  EXPECT_EQ(forbidden_of("map/depth", {"isobath/map/storage/block_pool.hpp", "isobath/base/error.hpp"}), "");
  EXPECT_EQ(forbidden_of("io", {"isobath/io/formats/ping/ping_logs.hpp"}), "")
      << "a room that is named brings its rooms";
}

TEST(Floors, TheTableOfContributingIsTheLaw) {
  static const std::regex row(R"re(\| \d+ \| `([a-z/]+)` \| ([a-z/ ]*)\|.*)re");
  std::map<std::string, Names> table;
  std::ifstream file(test::source_folder() / "CONTRIBUTING.md");
  for (std::string text; std::getline(file, text);) {
    std::smatch match;
    if (!std::regex_match(text, match, row)) continue;
    std::istringstream words(match[2].str());
    table[match[1]] = Names(std::istream_iterator<std::string>(words), {});
  }
  EXPECT_EQ(table, law());
}

using Graph = std::map<std::string, Names>;

/// Files that include each other, from one of them round to itself; empty where there is no circle.
std::vector<std::string> circle_in(const Graph& graph) {
  Names done;
  std::vector<std::string> way;
  std::function<bool(const std::string&)> walk = [&](const std::string& file) {
    const auto met = std::find(way.begin(), way.end(), file);
    const bool closed = met != way.end();
    if (closed) way.erase(way.begin(), met);
    if (closed || done.contains(file)) return closed;
    way.push_back(file);
    const auto node = graph.find(file);
    if (node != graph.end() && std::any_of(node->second.begin(), node->second.end(), walk)) return true;
    way.pop_back();
    done.insert(file);
    return false;
  };
  const auto from = std::find_if(graph.begin(), graph.end(), [&](const auto& node) { return walk(node.first); });
  return from == graph.end() ? std::vector<std::string>{} : way;
}

/// A header and its source are one.
Graph include_graph() {
  Graph graph;
  const auto unit = [](const std::string& path) { return path.substr(0, path.rfind('.')); };
  for (const SourceFile& file : sources()) {
    Names& includes = graph[unit(file.path)];
    for (const std::string& include : file.includes) {
      if (!room_of(include).empty() && unit(include) != unit(file.path)) includes.insert(unit(include));
    }
  }
  return graph;
}

/// What the modules of the live page import, types too.
Graph page_graph() {
  static const std::regex import(R"re(from '(\.[^']+)')re");
  Graph graph;
  const fs::path root = test::source_folder() / "web" / "src";
  for (const auto& entry : fs::recursive_directory_iterator(root)) {
    if (entry.path().extension() != ".ts") continue;
    std::ostringstream text;
    text << std::ifstream(entry.path()).rdbuf();
    const std::string source = text.str();
    Names& imports = graph[fs::relative(entry.path(), root).replace_extension().string()];
    for (std::sregex_iterator match(source.begin(), source.end(), import), end; match != end; ++match) {
      imports.insert(fs::relative((entry.path().parent_path() / (*match)[1].str()).lexically_normal(), root).string());
    }
  }
  return graph;
}

TEST(Floors, NoCircleOfIncludesAmongFiles) {
  EXPECT_GT(include_graph().size(), 300u);
  EXPECT_THAT(circle_in(include_graph()), testing::IsEmpty());
  EXPECT_GT(page_graph().size(), 30u);
  EXPECT_THAT(circle_in(page_graph()), testing::IsEmpty());
}

TEST(Floors, APlantedCircleIsFound) {
  Graph graph = include_graph();
  graph["isobath/base/angle"].insert("isobath/run/run");  // which reaches it by many ways
  EXPECT_THAT(circle_in(graph), testing::Contains("isobath/base/angle"));
  Graph page = page_graph();
  page["request"].insert("feed");
  EXPECT_THAT(circle_in(page), testing::IsSupersetOf({"feed", "request"}));
}

TEST(Floors, IncludesAreByFullPath) {
  const auto found = complaints([](const SourceFile& file) -> std::string {
    for (const std::string& include : file.includes) {
      if (include.starts_with('"')) return "includes " + include + "\"";
    }
    return "";
  });
  EXPECT_THAT(found, testing::IsEmpty());
}

TEST(Floors, EveryHeaderHasAPragmaOnce) {
  const auto found = complaints([](const SourceFile& file) -> std::string {
    return file.header() && file.text.find("#pragma once\n") == std::string::npos ? "no #pragma once" : "";
  });
  EXPECT_THAT(found, testing::IsEmpty());
}

/// The files outside the folder of a header that include it, themselves or through other headers.
Names seen_from_outside(const std::string& header, const std::vector<SourceFile>& files) {
  Names outside, reached = {header}, open = reached;
  while (!open.empty()) {
    const std::string next = open.extract(open.begin()).value();
    for (const SourceFile& file : files) {
      if (std::count(file.includes.begin(), file.includes.end(), next) == 0) continue;
      if (fs::path(file.path).parent_path() != fs::path(header).parent_path()) outside.insert(file.path);
      if (file.header() && reached.insert(file.path).second) open.insert(file.path);
    }
  }
  return outside;
}

/// Headers that need a heavy library, although files of another folder include them.
Names heavy_headers(const std::vector<SourceFile>& files) {
  static const std::regex heavy(
      "(gdal|ogr|cpl_|toml\\+\\+|nlohmann/json\\.hpp|CLI/|cairo|png\\.h|zlib\\.h|zstd|lz4|sqlite3\\.h|boost/"
      "(beast|asio)|GeographicLib/).*");
  Names found;
  for (const SourceFile& file : files) {
    const bool needs = std::any_of(file.includes.begin(), file.includes.end(),
                                   [](const std::string& include) { return std::regex_match(include, heavy); });
    if (file.header() && file.library() && needs && !seen_from_outside(file.path, files).empty()) {
      found.insert(file.path);
    }
  }
  return found;
}

TEST(Floors, HeavyLibrariesStayInTheirFolder) { EXPECT_THAT(heavy_headers(sources()), testing::IsEmpty()); }

TEST(Floors, AHeavyLibraryThatAnotherFolderSeesThroughAHeaderIsFound) {
  std::vector<SourceFile> files = sources();
  const auto file = [&](const std::string& path) {
    return std::find_if(files.begin(), files.end(), [&](const SourceFile& f) { return f.path == path; });
  };
  file("isobath/server/web_counts.hpp")->includes.push_back("zlib.h");
  EXPECT_THAT(heavy_headers(files),
              testing::ElementsAre("isobath/server/web_counts.hpp"));  // web_server.hpp includes it
}

TEST(Floors, TheLibraryPrintsNothing) {
  const auto found = complaints([](const SourceFile& file) -> std::string {
    if (!file.library() || file.path == "isobath/base/error.cpp") return "";  // a failed assertion speaks
    if (std::count(file.includes.begin(), file.includes.end(), "iostream") > 0) return "includes iostream";
    return first_match(file.text, R"(\b(std::(cout|cerr|clog)|printf|fprintf|puts|putchar|perror|fmt::print)\b)");
  });
  EXPECT_THAT(found, testing::IsEmpty());
}

TEST(Floors, ARunIsAFunctionOfItsInput) {
  const auto found = complaints([](const SourceFile& file) -> std::string {
    if (!file.library()) return "";
    const std::string random = first_match(file.text, R"(\brandom_device\b|\bs?rand\s*\()");
    const bool real = file.room == "run" || file.room == "server";     // they measure, and show in real time
    const bool live = file.room == "links" || file.room == "standin";  // their input has the time of the clock
    const std::string clock = live ? "high_resolution" : real ? "(system|high_resolution)" : "\\w+";
    return random + first_match(file.text, "\\b" + clock + "_clock::now\\b|\\bgettimeofday\\b|\\bgetenv\\b");
  });
  EXPECT_THAT(found, testing::IsEmpty());
}

/// Names of the standard library -> the headers that bring them. Those stand here that a precompiled header could hide.
const std::map<std::string, Names>& standard_names() {
  static const std::map<std::string, Names> table = [] {
    const std::vector<std::pair<std::string, std::string>> lines = {
        {"vector", "vector"},
        {"string to_string stoi", "string"},
        {"string_view", "string_view string"},
        {"optional nullopt", "optional"},
        {"function reference_wrapper hash", "functional"},
        {"map multimap", "map"},
        {"set multiset", "set"},
        {"unordered_map", "unordered_map"},
        {"unordered_set", "unordered_set"},
        {"deque", "deque"},
        {"queue priority_queue", "queue"},
        {"array", "array span"},
        {"span", "span"},
        {"variant visit get_if holds_alternative monostate", "variant"},
        {"unique_ptr shared_ptr weak_ptr make_unique make_shared", "memory"},
        {"mutex lock_guard unique_lock scoped_lock", "mutex condition_variable"},
        {"condition_variable", "condition_variable"},
        {"thread jthread", "thread"},
        {"atomic", "atomic"},
        {"chrono", "chrono thread condition_variable"},
        {"filesystem", "filesystem"},
        {"ifstream ofstream fstream", "fstream"},
        {"numeric_limits", "limits"},
        {"numbers", "numbers"},
        {"bit_cast popcount bit_width countl_zero countr_zero", "bit"},
        {"accumulate iota gcd lerp midpoint", "numeric cmath"},
        {"sqrt sin cos tan atan2 hypot exp log log1p pow fabs floor ceil round lround isfinite isnan fmod", "cmath"},
        {"sort stable_sort clamp max_element min_element nth_element transform fill copy_if any_of all_of none_of "
         "find_if lower_bound upper_bound binary_search rotate reverse unique",
         "algorithm"},
        {"int8_t uint8_t int16_t uint16_t int32_t uint32_t int64_t uint64_t", "cstdint"},
        {"exchange", "utility"},
        {"memcpy memcmp memset strlen", "cstring"},
        {"from_chars to_chars", "charconv"},
    };
    const auto words = [](const std::string& text) {
      std::istringstream stream(text);
      return Names(std::istream_iterator<std::string>(stream), {});
    };
    std::map<std::string, Names> named;
    for (const auto& [names, headers] : lines)
      for (const std::string& name : words(names)) named[name] = words(headers);
    return named;
  }();
  return table;
}

/// What a source includes, itself and by headers of the project. Headers of other libraries are not looked into.
const Names& reached(const std::string& path) {
  static std::map<std::string, Names> known;
  const auto [entry, fresh] = known.try_emplace(path);
  if (!fresh) return entry->second;
  const auto file = std::ranges::find(sources(), path, &SourceFile::path);
  Names names;
  if (file != sources().end()) {
    for (const std::string& include : file->includes) {
      names.insert(include);
      if (room_of(include).empty()) continue;
      const Names further = reached(include);
      names.insert(further.begin(), further.end());
    }
  }
  return known[path] = names;
}

// The builds use precompiled headers, which bring the standard library to every source; so no compiler says what is
// missing.
TEST(Floors, EverySourceIncludesTheStandardHeadersOfWhatItNames) {
  static const std::regex named(R"(\bstd::(?:ranges::)?(\w+))");
  const auto found = complaints([](const SourceFile& file) -> std::string {
    const Names& own = reached(file.path);
    for (std::sregex_iterator match(file.text.begin(), file.text.end(), named), end; match != end; ++match) {
      const auto line = standard_names().find((*match)[1].str());
      if (line == standard_names().end()) continue;
      const auto brings = [&](const std::string& header) { return own.contains(header); };
      if (std::ranges::none_of(line->second, brings))
        return "names std::" + line->first + ", includes no " + *line->second.begin();
    }
    return "";
  });
  EXPECT_THAT(found, testing::IsEmpty());
}

// The checks above are as good as what they take for code.
TEST(Floors, CommentsAndLiteralsAreNotCode) {
  EXPECT_EQ(code_of("a /* std::cout */ b // printf\nc \"rand()\" d '\"' e R\"(x \" y)\" f"), "a   b  \nc   d   e   f");
  EXPECT_THAT(includes_of("#include <isobath/a.hpp>\n  # include \"b.hpp\"\n// #include <c>\n"),
              testing::ElementsAre("isobath/a.hpp", "\"b.hpp"));
  EXPECT_EQ(room_of("isobath/map/occupancy/body_grid.hpp"), "map/occupancy");
  EXPECT_EQ(room_of("isobath/io/open_source.hpp"), "io");
  EXPECT_EQ(room_of("isobath/io/exports/vdb/vdb_module.hpp"), "io/exports");
  EXPECT_EQ(room_of("vector"), "");
}

}  // namespace
}  // namespace isobath
