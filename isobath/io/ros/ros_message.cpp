#include <algorithm>
#include <isobath/io/ros/ros_message.hpp>

namespace isobath {
namespace {

constexpr std::size_t kCdrHead = 4;

template <class Number>
double number_in(Bytes bytes, std::endian order) {
  return static_cast<double>(RecordView(bytes, order).at<Number>(0));
}

}  // namespace

RosMessage::RosMessage(const RosDefinition& definition, Bytes bytes, RosEncoding encoding)
    : definition_(definition), bytes_(bytes), encoding_(encoding) {
  if (encoding == RosEncoding::kRos1) return;
  // The head: 00 00 big-endian, 00 01 little-endian; others are parameter lists and XCDR2.
  ok_ = bytes.size() >= kCdrHead && bytes[0] == std::byte{0} && bytes[1] <= std::byte{1};
  if (ok_ && bytes[1] == std::byte{0}) order_ = std::endian::big;
}

RosValue RosMessage::root() const { return {this, RosField{}, encoding_ == RosEncoding::kCdr ? kCdrHead : 0}; }

std::size_t RosMessage::aligned(std::size_t at, std::size_t size) const {
  if (encoding_ == RosEncoding::kRos1 || size < 2) return at;
  return kCdrHead + (at - kCdrHead + size - 1) / size * size;
}

Bytes RosMessage::take(std::size_t& at, std::size_t count) const {
  if (!ok_ || at > bytes_.size() || count > bytes_.size() - at) {
    ok_ = false;
    at = bytes_.size();
    return {};
  }
  at += count;
  return bytes_.subspan(at - count, count);
}

double RosMessage::number_at(std::size_t& at, RosPrimitive primitive) const {
  const std::size_t size = bytes_of(primitive);
  at = aligned(at, size);
  const Bytes bytes = take(at, size);
  if (bytes.empty()) return 0;
  switch (primitive) {
    case RosPrimitive::kBool:
    case RosPrimitive::kU8: return number_in<std::uint8_t>(bytes, order_);
    case RosPrimitive::kI8: return number_in<std::int8_t>(bytes, order_);
    case RosPrimitive::kI16: return number_in<std::int16_t>(bytes, order_);
    case RosPrimitive::kU16: return number_in<std::uint16_t>(bytes, order_);
    case RosPrimitive::kI32: return number_in<std::int32_t>(bytes, order_);
    case RosPrimitive::kU32: return number_in<std::uint32_t>(bytes, order_);
    case RosPrimitive::kI64: return number_in<std::int64_t>(bytes, order_);
    case RosPrimitive::kU64: return number_in<std::uint64_t>(bytes, order_);
    case RosPrimitive::kF32: return number_in<float>(bytes, order_);
    case RosPrimitive::kF64: return number_in<double>(bytes, order_);
    case RosPrimitive::kMessage:
    case RosPrimitive::kText:
    case RosPrimitive::kTime: break;
  }
  ok_ = false;
  return 0;
}

std::uint32_t RosMessage::count_at(std::size_t& at) const {
  at = aligned(at, 4);
  const Bytes bytes = take(at, 4);
  return bytes.empty() ? 0 : RecordView(bytes, order_).at<std::uint32_t>(0);
}

std::string_view RosMessage::text_at(std::size_t& at) const {
  std::string_view text = text_of(take(at, count_at(at)));
  if (encoding_ == RosEncoding::kCdr && text.ends_with('\0')) text.remove_suffix(1);
  return text;
}

std::size_t RosMessage::length_at(std::size_t& at, const RosField& field) const {
  if (field.array == RosField::Array::kNone) return 1;
  const std::size_t count = field.array == RosField::Array::kFixed ? field.count : count_at(at);
  const std::size_t one = field.primitive == RosPrimitive::kMessage ? definition_.types()[field.type].min_bytes
                          : field.primitive == RosPrimitive::kText  ? 4
                          : field.primitive == RosPrimitive::kTime  ? 8
                                                                    : bytes_of(field.primitive);
  if (one == 0) return 0;  // of empty messages
  if (!ok_ || at > bytes_.size() || count > (bytes_.size() - at) / one) {
    ok_ = false;
    return 0;
  }
  return count;
}

void RosMessage::skip_one(std::size_t& at, const RosField& field) const {
  if (field.primitive == RosPrimitive::kMessage) {
    for (const RosField& inner : definition_.types()[field.type].fields) {
      if (!ok_) return;
      skip(at, inner);
    }
  } else if (field.primitive == RosPrimitive::kText) {
    (void)text_at(at);
  } else if (field.primitive == RosPrimitive::kTime) {
    at = aligned(at, 4);
    take(at, 8);
  } else {
    const std::size_t size = bytes_of(field.primitive);
    at = aligned(at, size);
    take(at, size);
  }
}

void RosMessage::skip(std::size_t& at, const RosField& field) const {
  if (field.primitive == RosPrimitive::kMessage && definition_.types()[field.type].min_bytes == 0) {
    if (field.array == RosField::Array::kSequence) (void)count_at(at);
    return;  // empty messages take no bytes, however many there are
  }
  const std::size_t count = length_at(at, field), size = bytes_of(field.primitive);
  if (count == 0) return;
  if (size > 0) {
    at = aligned(at, size);
    take(at, count * size);
    return;
  }
  for (std::size_t i = 0; i < count && ok_; ++i) skip_one(at, field);
}

RosValue RosValue::operator[](std::string_view name) const {
  std::size_t at = at_;
  if (field_.primitive == RosPrimitive::kMessage && field_.array == RosField::Array::kNone) {
    for (const RosField& field : message_->definition_.types()[field_.type].fields) {
      if (field.name == name) return {message_, field, at};
      message_->skip(at, field);
    }
  }
  if (message_->missing_.empty()) message_->missing_ = name;
  return {message_, {std::string(name), RosPrimitive::kText, 0, RosField::Array::kNone, 1}, message_->bytes_.size()};
}

bool RosValue::has(std::string_view name) const {
  if (field_.primitive != RosPrimitive::kMessage || field_.array != RosField::Array::kNone) return false;
  const auto& fields = message_->definition_.types()[field_.type].fields;
  return std::ranges::find(fields, name, &RosField::name) != fields.end();
}

double RosValue::number() const {
  std::size_t at = at_;
  if (field_.array == RosField::Array::kNone) return message_->number_at(at, field_.primitive);
  message_->ok_ = false;
  return 0;
}

std::string_view RosValue::text() const {
  std::size_t at = at_;
  if (field_.primitive == RosPrimitive::kText && field_.array == RosField::Array::kNone) return message_->text_at(at);
  message_->ok_ = false;
  return {};
}

std::optional<Time> RosValue::time() const {
  std::size_t at = at_;
  if (field_.primitive != RosPrimitive::kTime || field_.array != RosField::Array::kNone) {
    message_->ok_ = false;
    return {};
  }
  at = message_->aligned(at, 4);
  const RecordView view(message_->take(at, 8), message_->order_);
  const auto seconds = view.at<std::uint32_t>(0), nanoseconds = view.at<std::uint32_t>(4);
  if ((seconds == 0 && nanoseconds == 0) || nanoseconds >= 1'000'000'000) return {};
  return Time{std::chrono::seconds(seconds) + std::chrono::nanoseconds(nanoseconds)};
}

std::vector<RosValue> RosValue::elements() const {
  std::size_t at = at_;
  const std::size_t count = message_->length_at(at, field_);
  RosField one = field_;
  one.array = RosField::Array::kNone;
  std::vector<RosValue> all;
  all.reserve(std::min<std::size_t>(count, 1 << 16));
  for (std::size_t i = 0; i < count && message_->ok_; ++i) {
    all.push_back({message_, one, at});
    message_->skip_one(at, one);
  }
  return all;
}

std::vector<double> RosValue::numbers() const {
  std::size_t at = at_;
  if (bytes_of(field_.primitive) == 0) message_->ok_ = false;
  const std::size_t count = message_->length_at(at, field_);
  std::vector<double> all;
  if (!message_->ok_) return all;
  all.reserve(count);
  for (std::size_t i = 0; i < count; ++i) all.push_back(message_->number_at(at, field_.primitive));
  return all;
}

Bytes RosValue::bytes() const {
  std::size_t at = at_;
  const std::size_t size = bytes_of(field_.primitive);
  if (size == 0) message_->ok_ = false;
  const std::size_t count = message_->length_at(at, field_);
  if (!message_->ok_ || count == 0) return {};
  at = message_->aligned(at, size);
  return message_->take(at, count * size);
}

}  // namespace isobath
