#include <algorithm>
#include <chrono>
#include <cstring>
#include <initializer_list>
#include <isobath/base/error.hpp>
#include <isobath/io/ros/ros_writer.hpp>
#include <limits>
#include <utility>

namespace isobath {
namespace {

constexpr std::size_t kCdrHeadBytes = 4;
constexpr std::uint8_t kLittleEndianCdr[kCdrHeadBytes] = {0, 1, 0, 0};

/// Offset, after a head of CDR, at which a number of this size is placed.
std::size_t cdr_place(std::size_t at, std::size_t size) {
  return size < 2 ? at : kCdrHeadBytes + (at - kCdrHeadBytes + size - 1) / size * size;
}

/// Copies a message field by field from one encoding to the other.
class RosRecoder {
 public:
  RosRecoder(const RosDefinition& definition, Bytes in, bool from_cdr)
      : definition_(definition), in_(in), from_cdr_(from_cdr) {
    if (from_cdr) {
      ok_ = in.size() >= kCdrHeadBytes && std::memcmp(in.data(), kLittleEndianCdr, 2) == 0;
      at_ = kCdrHeadBytes;
    } else {
      out_.assign(std::begin(kLittleEndianCdr), std::end(kLittleEndianCdr));
    }
  }

  std::optional<std::vector<std::uint8_t>> copied() {
    copy_type(0);
    return ok_ ? std::optional(std::move(out_)) : std::nullopt;
  }

 private:
  void copy_type(std::size_t type) {
    for (const RosField& field : definition_.types()[type].fields) {
      if (!ok_) return;
      copy_field(field);
    }
  }

  void copy_field(const RosField& field) {
    const bool sequence = field.array == RosField::Array::kSequence;
    const std::size_t count = sequence ? copy_count() : field.count;
    if (field.primitive == RosPrimitive::kMessage) {
      if (definition_.types()[field.type].min_bytes == 0) return;
      for (std::size_t i = 0; i < count && ok_; ++i) copy_type(field.type);
    } else if (field.primitive == RosPrimitive::kText) {
      for (std::size_t i = 0; i < count && ok_; ++i) copy_text();
    } else if (field.primitive == RosPrimitive::kTime) {
      copy(4, 2 * count);
    } else {
      copy(bytes_of(field.primitive), count);
    }
  }

  Bytes take(std::size_t size, std::size_t count) {
    if (count == 0 || !ok_) return {};
    const std::size_t at = from_cdr_ ? cdr_place(at_, size) : at_;
    ok_ = at <= in_.size() && count <= (in_.size() - at) / size;
    if (!ok_) return {};
    at_ = at + size * count;
    return in_.subspan(at, size * count);
  }

  void copy(std::size_t size, std::size_t count) {
    const Bytes bytes = take(size, count);
    if (bytes.empty()) return;
    if (!from_cdr_) out_.resize(cdr_place(out_.size(), size));
    put(bytes);
  }

  std::uint32_t copy_count() {
    const std::uint32_t count = take_count();
    put_count(count);
    return count;
  }

  void copy_text() {
    std::uint32_t size = take_count();
    const Bytes bytes = take(1, size);
    if (!ok_) return;
    const bool closed = from_cdr_ && !bytes.empty() && bytes.back() == std::byte{0};
    const Bytes text = closed ? bytes.first(bytes.size() - 1) : bytes;
    put_count(static_cast<std::uint32_t>(text.size() + (from_cdr_ ? 0 : 1)));
    put(text);
    if (!from_cdr_) out_.push_back(0);
  }

  std::uint32_t take_count() {
    const Bytes bytes = take(4, 1);
    return bytes.empty() ? 0 : RecordView(bytes).at<std::uint32_t>(0);
  }
  void put_count(std::uint32_t count) {
    if (!from_cdr_) out_.resize(cdr_place(out_.size(), 4));
    put(std::as_bytes(std::span(&count, 1)));
  }
  void put(Bytes bytes) {
    const auto* const from = reinterpret_cast<const std::uint8_t*>(bytes.data());
    out_.insert(out_.end(), from, from + bytes.size());
  }

  const RosDefinition& definition_;
  Bytes in_;
  bool from_cdr_, ok_ = true;
  std::size_t at_ = 0;
  std::vector<std::uint8_t> out_;
};

}  // namespace

RosWriter::RosWriter(RosDefinition definition, RosEncoding encoding)
    : definition_(std::move(definition)), encoding_(encoding) {}

RosWriter& RosWriter::begin() {
  out_.clear();
  if (encoding_ == RosEncoding::kCdr) out_.assign(std::begin(kLittleEndianCdr), std::end(kLittleEndianCdr));
  levels_.assign(1, {});
  ++messages_;
  return *this;
}

/// The next field that is a value or a sequence; null after the last.
const RosField* RosWriter::next() {
  while (!levels_.empty()) {
    Level& level = levels_.back();
    const auto& fields = definition_.types()[level.type].fields;
    if (level.left == 0) {
      levels_.pop_back();
      if (!levels_.empty()) ++levels_.back().field;
    } else if (level.field == fields.size()) {
      --level.left;
      level.field = 0;
    } else {
      const RosField& field = fields[level.field];
      if (field.primitive != RosPrimitive::kMessage || field.array == RosField::Array::kSequence) return &field;
      levels_.push_back({field.type, 0, field.count});
    }
  }
  return nullptr;
}

void RosWriter::align(std::size_t size) {
  if (encoding_ == RosEncoding::kCdr) out_.resize(cdr_place(out_.size(), size));
}

void RosWriter::put(const void* from, std::size_t size) {
  const auto* const bytes = static_cast<const std::uint8_t*>(from);
  out_.insert(out_.end(), bytes, bytes + size);
}

void RosWriter::put_number(RosPrimitive primitive, double value) {
  const auto put_as = [&]<class Number>(Number number) { put(&number, sizeof number); };
  switch (primitive) {
    case RosPrimitive::kBool: return put_as(static_cast<std::uint8_t>(value != 0));
    case RosPrimitive::kI8: return put_as(static_cast<std::int8_t>(value));
    case RosPrimitive::kU8: return put_as(static_cast<std::uint8_t>(value));
    case RosPrimitive::kI16: return put_as(static_cast<std::int16_t>(value));
    case RosPrimitive::kU16: return put_as(static_cast<std::uint16_t>(value));
    case RosPrimitive::kI32: return put_as(static_cast<std::int32_t>(value));
    case RosPrimitive::kU32: return put_as(static_cast<std::uint32_t>(value));
    case RosPrimitive::kI64: return put_as(static_cast<std::int64_t>(value));
    case RosPrimitive::kU64: return put_as(static_cast<std::uint64_t>(value));
    case RosPrimitive::kF32: return put_as(static_cast<float>(value));
    case RosPrimitive::kF64: return put_as(value);
    case RosPrimitive::kMessage:
    case RosPrimitive::kText:
    case RosPrimitive::kTime: break;
  }
  ISOBATH_ASSERT(false);
}

RosWriter& RosWriter::header(Time time, std::string_view frame) {
  const RosField* const first = next();
  if (first && first->name == "seq") number(messages_ - 1);
  return this->time(time).text(frame);
}

RosWriter& RosWriter::number(double value) {
  const RosField* const field = next();
  ISOBATH_ASSERT(field && field->array == RosField::Array::kNone);
  align(bytes_of(field->primitive));
  put_number(field->primitive, value);
  ++levels_.back().field;
  return *this;
}

RosWriter& RosWriter::numbers(std::initializer_list<double> values) {
  for (const double value : values) number(value);
  return *this;
}

RosWriter& RosWriter::time(Time time) {
  const RosField* const field = next();
  ISOBATH_ASSERT(field && field->primitive == RosPrimitive::kTime && field->array == RosField::Array::kNone);
  const std::int64_t ns = time.time_since_epoch().count();
  constexpr std::int64_t kSecond = 1'000'000'000;
  const std::uint32_t parts[] = {static_cast<std::uint32_t>(ns / kSecond), static_cast<std::uint32_t>(ns % kSecond)};
  align(4);
  put(parts, sizeof parts);
  ++levels_.back().field;
  return *this;
}

RosWriter& RosWriter::text(std::string_view value) {
  const RosField* const field = next();
  ISOBATH_ASSERT(field && field->primitive == RosPrimitive::kText && field->array == RosField::Array::kNone);
  const bool cdr = encoding_ == RosEncoding::kCdr;
  align(4);
  const auto size = static_cast<std::uint32_t>(value.size() + (cdr ? 1 : 0));
  put(&size, sizeof size);
  put(value.data(), value.size());
  if (cdr) out_.push_back(0);
  ++levels_.back().field;
  return *this;
}

RosWriter& RosWriter::array(std::span<const double> values) {
  const RosField* const field = next();
  ISOBATH_ASSERT(field && field->array != RosField::Array::kNone && bytes_of(field->primitive) > 0);
  if (field->array == RosField::Array::kSequence) {
    const auto size = static_cast<std::uint32_t>(values.size());
    align(4);
    put(&size, sizeof size);
  } else {
    ISOBATH_ASSERT(field->count == values.size());
  }
  if (!values.empty()) align(bytes_of(field->primitive));
  for (const double value : values) put_number(field->primitive, value);
  ++levels_.back().field;
  return *this;
}

RosWriter& RosWriter::raw_array(std::span<const std::uint8_t> bytes) {
  const RosField* const field = next();
  ISOBATH_ASSERT(field && field->array == RosField::Array::kSequence && bytes_of(field->primitive) > 0);
  const std::size_t one = bytes_of(field->primitive);
  const auto size = static_cast<std::uint32_t>(bytes.size() / one);
  align(4);
  put(&size, sizeof size);
  if (!bytes.empty()) align(one);
  put(bytes.data(), bytes.size());
  ++levels_.back().field;
  return *this;
}

RosWriter& RosWriter::count(std::size_t elements) {
  const RosField* const field = next();
  ISOBATH_ASSERT(field && field->primitive == RosPrimitive::kMessage && field->array == RosField::Array::kSequence);
  const auto size = static_cast<std::uint32_t>(elements);
  align(4);
  put(&size, sizeof size);
  levels_.push_back({field->type, 0, elements});
  return *this;
}

std::span<const std::uint8_t> RosWriter::done() {
  ISOBATH_ASSERT(next() == nullptr);
  return out_;
}

bool ros_can_hold(Time time, RosEncoding encoding) {
  const std::int64_t s = std::chrono::floor<std::chrono::seconds>(time.time_since_epoch()).count();
  const std::int64_t last = encoding == RosEncoding::kCdr ? std::int64_t{std::numeric_limits<std::int32_t>::max()}
                                                          : std::int64_t{std::numeric_limits<std::uint32_t>::max()};
  return s >= 0 && s <= last;
}

std::optional<std::vector<std::uint8_t>> recoded(const RosDefinition& definition, Bytes message, RosEncoding from) {
  return RosRecoder(definition, message, from == RosEncoding::kCdr).copied();
}

}  // namespace isobath
