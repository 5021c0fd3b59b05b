#include <boost/uuid/detail/md5.hpp>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/io/bytes/text_lines.hpp>
#include <isobath/io/ros/ros_recorder.hpp>
#include <map>

namespace isobath {
namespace {

std::string md5_of(const std::string& text) {
  boost::uuids::detail::md5 hash;
  hash.process_bytes(text.data(), text.size());
  boost::uuids::detail::md5::digest_type digest;
  hash.get_digest(digest);
  std::string hex;
  for (const auto part : digest) hex += fmt::format("{:0{}x}", part, 2 * sizeof part);
  return hex;
}

/// The texts of a definition and of the types below it, by name.
std::map<std::string, std::string> texts_by_type(std::string_view type, const std::string& definition) {
  std::map<std::string, std::string> texts;
  std::string* text = &texts[std::string(type)];
  TextRow lines(definition, '\n');
  for (std::string_view line; lines.next(line);) {
    if (line.starts_with("MSG: ")) {
      text = &texts[std::string(line.substr(5))];
    } else if (!line.starts_with("=====")) {
      text->append(line).append("\n");
    }
  }
  return texts;
}

/// The md5 of a type's text without comments: constants first, and for a field of a message type the md5 of that type
/// (wiki.ros.org/ROS/Technical Overview, "Message serialization and msg MD5 sums").
std::string md5_of_type(const std::string& type, const std::map<std::string, std::string>& texts) {
  std::string constants, fields;
  const std::string& text = texts.at(type);
  TextRow lines(text, '\n');
  for (std::string_view line; lines.next(line);) {
    line = trimmed(line.substr(0, line.find('#')));
    if (line.empty()) continue;
    const std::size_t blank = line.find(' ');
    const std::string_view name = trimmed(line.substr(blank));
    const auto needed = texts.find(std::string(line.substr(0, line.find_first_of(" ["))));
    std::string& to = name.find('=') != std::string_view::npos ? constants : fields;
    if (!to.empty()) to += "\n";
    to += needed == texts.end() ? std::string(line.substr(0, blank)) : md5_of_type(needed->first, texts);
    to.append(" ").append(name);
  }
  if (!constants.empty() && !fields.empty()) constants += "\n";
  return md5_of(constants + fields);
}

}  // namespace

std::string ros1_checksum(std::string_view type) {
  const std::string definition = known_ros_definition(type, RosEncoding::kRos1);
  ISOBATH_ASSERT(!definition.empty());
  return md5_of_type(std::string(type), texts_by_type(type, definition));
}

}  // namespace isobath
