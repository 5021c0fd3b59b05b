#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/sonar/strict_json.hpp>
#include <nlohmann/json.hpp>

namespace isobath {

JsonObject::JsonObject(const Json& object, std::string file, std::string path, std::string advice,
                       std::initializer_list<const char*> keys)
    : object_(object), file_(std::move(file)), path_(std::move(path)), advice_(std::move(advice)) {
  if (!object.is_object()) fail({}, "not an object", "{...}");
  for (const auto& item : object.items()) {
    bool known = false;
    for (const char* key : keys) known = known || item.key() == key;
    if (!known) fail(item.key(), "unknown key", {});
  }
  for (const char* key : keys) {
    if (!object.contains(key)) fail(key, "missing key", {});
  }
}

double JsonObject::number(const char* key) const {
  if (!object_[key].is_number()) fail(key, "wrong type", "a number");
  return object_[key].get<double>();
}

double JsonObject::number(const char* key, double low, double high) const {
  return within(key, number(key), low, high);
}

int JsonObject::integer(const char* key, int low, int high) const { return whole(key, number(key), low, high); }

std::string JsonObject::text(const char* key) const {
  if (!object_[key].is_string()) fail(key, "wrong type", "a text");
  return object_[key].get<std::string>();
}

bool JsonObject::flag(const char* key) const {
  if (!object_[key].is_boolean()) fail(key, "wrong type", "true or false");
  return object_[key].get<bool>();
}

std::vector<double> JsonObject::numbers(const char* key, std::size_t most, double low, double high) const {
  std::vector<double> all;
  for (const Json& one : list(key, most)) {
    if (!one.is_number()) fail(key, "wrong type", "a list of numbers");
    all.push_back(within(key, one.get<double>(), low, high));
  }
  return all;
}

const Json& JsonObject::list(const char* key, std::size_t most) const {
  const Json& all = object_[key];
  if (!all.is_array()) fail(key, "wrong type", "a list");
  if (all.size() > most) fail(key, "too long", "at most " + std::to_string(most) + " entries");
  return all;
}

void JsonObject::fail(const std::string& key, const std::string& problem, const std::string& allowed) const {
  throw Error(problem, {file_, {}, {}, {}, path_ + key}, allowed, advice_);
}

double JsonObject::within(const char* key, double value, double low, double high) const {
  if (!(value >= low && value <= high)) {
    fail(key, "out of range", std::to_string(low) + " .. " + std::to_string(high));
  }
  return value;
}

int JsonObject::whole(const char* key, double value, int low, int high) const {
  if (!(value >= low && value <= high) || value != std::floor(value)) {
    fail(key, "out of range", std::to_string(low) + " .. " + std::to_string(high) + ", whole");
  }
  return static_cast<int>(value);
}

Json parse_json(std::string_view text, const std::string& file, const std::string& advice) {
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& e) {
    throw Error("not JSON", {file, e.byte, {}, {}, {}}, {}, advice);
  } catch (const Json::exception&) {  // a number that does not fit into a double
    throw Error("not JSON: a number is out of range", {file, {}, {}, {}, {}}, {}, advice);
  }
}

}  // namespace isobath
