#include <algorithm>
#include <array>
#include <isobath/io/bytes/text_lines.hpp>
#include <isobath/io/ros/ros_definition.hpp>
#include <map>
#include <utility>

namespace isobath {
namespace {

constexpr std::array<std::pair<std::string_view, RosPrimitive>, 19> kPrimitives{{
    {"bool", RosPrimitive::kBool},
    {"int8", RosPrimitive::kI8},
    {"byte", RosPrimitive::kI8},
    {"uint8", RosPrimitive::kU8},
    {"char", RosPrimitive::kU8},
    {"int16", RosPrimitive::kI16},
    {"uint16", RosPrimitive::kU16},
    {"int32", RosPrimitive::kI32},
    {"uint32", RosPrimitive::kU32},
    {"int64", RosPrimitive::kI64},
    {"uint64", RosPrimitive::kU64},
    {"float32", RosPrimitive::kF32},
    {"float64", RosPrimitive::kF64},
    {"string", RosPrimitive::kText},
    {"time", RosPrimitive::kTime},
    {"duration", RosPrimitive::kTime},
    {"builtin_interfaces/Time", RosPrimitive::kTime},
    {"builtin_interfaces/Duration", RosPrimitive::kTime},
    {"octet", RosPrimitive::kU8},
}};

std::optional<RosPrimitive> primitive_of(std::string_view name) {
  const auto* const found = std::ranges::find(kPrimitives, name, &std::pair<std::string_view, RosPrimitive>::first);
  return found == kPrimitives.end() ? std::nullopt : std::optional(found->second);
}

/// The texts of a definition by the names of their types.
using TypeTexts = std::map<std::string, std::string_view, std::less<>>;

/// The next line of a text, which loses it.
std::string_view take_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

TypeTexts split_types(std::string_view root, std::string_view text) {
  TypeTexts texts;
  std::string name = ros_type_name(root);
  const char* begin = text.data();
  const auto keep = [&](const char* end) { texts.try_emplace(name, begin, static_cast<std::size_t>(end - begin)); };
  while (!text.empty()) {
    const std::string_view line = take_line(text);
    if (!trimmed(line).starts_with("=====")) continue;
    std::string_view rest = text;
    const std::string_view head = trimmed(take_line(rest));
    if (!head.starts_with("MSG:")) continue;
    keep(line.data());
    text = rest;
    name = ros_type_name(trimmed(head.substr(4)));
    begin = rest.data();
  }
  keep(text.data() + text.size());
  return texts;
}

/// A type with its array: "float32[36]", "string<=10", "Vector3[]", "uint8[<=5]".
bool read_type(std::string_view word, std::string& name, RosField& field) {
  const std::size_t bracket = word.find('[');
  std::string_view element = word.substr(0, bracket);
  element = element.substr(0, element.find("<="));  // bound of a text
  name = ros_type_name(element);
  if (bracket == std::string_view::npos) return !name.empty();
  std::string_view inside = word.substr(bracket + 1);
  if (!inside.ends_with(']')) return false;
  inside.remove_suffix(1);
  field.array = RosField::Array::kSequence;
  if (inside.empty() || inside.starts_with("<=")) return !name.empty();
  field.array = RosField::Array::kFixed;
  return parse_number(inside, field.count) && field.count <= RosDefinition::kMaxCount && !name.empty();
}

/// The two first words of a line without its comment; whether it declares a field.
bool read_field(std::string_view line, std::string& type, RosField& field, bool& bad) {
  const std::size_t hash = line.find('#');
  std::string_view rest = trimmed(line.substr(0, hash));
  if (rest.empty()) return false;
  const std::size_t blank = rest.find_first_of(" \t");
  if (blank == std::string_view::npos) return bad = true, false;
  const std::string_view word = rest.substr(0, blank);
  rest = trimmed(rest.substr(blank));
  const std::string_view name = rest.substr(0, rest.find_first_of(" \t="));
  const std::string_view after = trimmed(rest.substr(name.size()));
  if (after.starts_with('=')) return false;  // a constant
  field.name = name;
  bad = !read_type(word, type, field) || name.empty();
  return !bad;
}

/// Reads types on demand, each once.
class DefinitionParser {
 public:
  DefinitionParser(const TypeTexts& texts, std::vector<RosType>& types) : texts_(texts), types_(types) {}

  /// Index of a type; empty: it is missing, invalid, or contains itself.
  std::optional<std::size_t> read(const std::string& name) {
    const auto known = indices_.find(name);
    if (known != indices_.end()) return open_.contains(name) ? std::nullopt : std::optional(known->second);
    const auto text = texts_.find(name);
    if (text == texts_.end() || types_.size() >= RosDefinition::kMaxTypes) return {};
    const std::size_t index = types_.size();
    types_.push_back({name, {}, 0});
    indices_[name] = index;
    open_[name] = true;
    if (!read_fields(index, name, text->second)) return {};
    open_.erase(name);
    return index;
  }

 private:
  bool read_fields(std::size_t index, const std::string& name, std::string_view text) {
    while (!text.empty()) {
      RosField field;
      std::string type;
      bool bad = false;
      const bool found = read_field(take_line(text), type, field, bad);
      if (bad || ++fields_ > RosDefinition::kMaxFields) return false;
      if (!found) continue;
      if (!resolve(name, type, field)) return false;
      const std::size_t one = field.primitive == RosPrimitive::kMessage ? types_[field.type].min_bytes
                              : field.primitive == RosPrimitive::kText  ? 4
                              : field.primitive == RosPrimitive::kTime  ? 8
                                                                        : bytes_of(field.primitive);
      const bool sequence = field.array == RosField::Array::kSequence;
      types_[index].min_bytes += sequence ? 4 : one * field.count;
      if (types_[index].min_bytes > RosDefinition::kMaxCount) return false;
      types_[index].fields.push_back(std::move(field));
    }
    return true;
  }

  bool resolve(const std::string& inside, const std::string& type, RosField& field) {
    if (const auto primitive = primitive_of(type)) {
      field.primitive = *primitive;
      return true;
    }
    std::string full = type == "Header" ? "std_msgs/Header" : type;
    if (full.find('/') == std::string::npos) full = inside.substr(0, inside.find('/') + 1) + full;
    const auto index = read(full);
    if (index) field.type = *index;
    return index.has_value();
  }

  const TypeTexts& texts_;
  std::vector<RosType>& types_;
  std::map<std::string, std::size_t> indices_;
  std::map<std::string, bool> open_;
  std::size_t fields_ = 0;
};

}  // namespace

std::size_t bytes_of(RosPrimitive primitive) {
  switch (primitive) {
    case RosPrimitive::kBool:
    case RosPrimitive::kI8:
    case RosPrimitive::kU8: return 1;
    case RosPrimitive::kI16:
    case RosPrimitive::kU16: return 2;
    case RosPrimitive::kI32:
    case RosPrimitive::kU32:
    case RosPrimitive::kF32: return 4;
    case RosPrimitive::kI64:
    case RosPrimitive::kU64:
    case RosPrimitive::kF64: return 8;
    case RosPrimitive::kMessage:
    case RosPrimitive::kText:
    case RosPrimitive::kTime: break;
  }
  return 0;
}

std::optional<RosDefinition> RosDefinition::parse(std::string_view root, std::string_view text) {
  const TypeTexts texts = split_types(root, text);
  RosDefinition definition;
  if (!DefinitionParser(texts, definition.types_).read(ros_type_name(root))) return {};
  return definition;
}

std::string ros_type_name(std::string_view name) {
  std::string result(name);
  if (const std::size_t at = result.find("/msg/"); at != std::string::npos) result.erase(at, 4);
  return result;
}

}  // namespace isobath
