#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <isobath/io/gdal/netcdf_size.hpp>
#include <optional>
#include <vector>

namespace isobath {
namespace {

constexpr std::size_t kLongestHeader = 1 << 20;
constexpr std::uint64_t kMax = std::uint64_t{1} << 50;

/// The header of a classic file: big-endian, padded to four bytes.
class NetcdfHeader {
 public:
  explicit NetcdfHeader(std::vector<unsigned char> bytes) : bytes_(std::move(bytes)), version_(bytes_[3]) {}

  /// The size in bytes that the header requires; empty if the header is invalid.
  std::optional<std::uint64_t> needed() {
    at_ = 4;
    std::uint64_t records = count();
    if (records == (version_ == 5 ? ~std::uint64_t{0} : 0xffffffffU)) records = 0;  // still being written
    skip(4);
    std::vector<std::uint64_t> lengths(bounded(count()));
    for (std::uint64_t& length : lengths) {
      name();
      length = count();
    }
    attributes();
    skip(4);
    std::uint64_t end = 0, record_bytes = 0, record_variables = 0, last_start = 0, unpadded = 0;
    for (std::size_t n = bounded(count()); n > 0 && good_; --n) {
      name();
      std::uint64_t bytes = 1;
      bool of_records = false;
      for (std::size_t d = bounded(count()), first = d; d > 0 && good_; --d) {
        const std::uint64_t id = count();
        good_ = good_ && id < lengths.size();
        if (!good_) break;
        if (lengths[id] == 0 && d == first) {
          of_records = true;
        } else {
          bytes = product(bytes, lengths[id]);
        }
      }
      attributes();
      bytes = product(bytes, size_of(number(4)));
      number(version_ == 5 ? 8 : 4);  // the stated size, which overflows for large variables
      const std::uint64_t start = number(version_ == 1 ? 4 : 8);
      good_ = good_ && start < kMax;
      if (of_records) {
        record_bytes += (bytes + 3) / 4 * 4;
        unpadded = bytes;
        ++record_variables;
        last_start = std::max(last_start, start);
      } else {
        end = std::max(end, start + bytes);
      }
    }
    if (record_variables == 1) record_bytes = unpadded;  // a single record variable is not padded
    if (record_variables > 0 && records > 0) {
      end = std::max(end, last_start + unpadded + product(records - 1, record_bytes));
    }
    return good_ ? std::optional(end) : std::nullopt;
  }

 private:
  std::uint64_t number(std::size_t size) {
    std::uint64_t value = 0;
    if (at_ + size > bytes_.size()) {
      good_ = false;
      return 0;
    }
    for (std::size_t i = 0; i < size; ++i) value = (value << 8) | bytes_[at_ + i];
    at_ += size;
    return value;
  }
  std::uint64_t count() { return number(version_ == 5 ? 8 : 4); }
  /// A count of items; invalid if it exceeds the number of bytes.
  std::size_t bounded(std::uint64_t value) {
    if (value > bytes_.size()) good_ = false;
    return good_ ? static_cast<std::size_t>(value) : 0;
  }
  void skip(std::uint64_t bytes) {
    if (bytes > bytes_.size() - at_) {
      good_ = false;
    } else {
      at_ += static_cast<std::size_t>(bytes);
    }
  }
  void name() { skip((bounded(count()) + 3) / 4 * 4); }
  void attributes() {
    skip(4);
    for (std::size_t n = bounded(count()); n > 0 && good_; --n) {
      name();
      const std::uint64_t size = size_of(number(4));
      skip((product(bounded(count()), size) + 3) / 4 * 4);
    }
  }
  std::uint64_t size_of(std::uint64_t type) {
    static constexpr std::array<std::uint64_t, 12> kSizes = {0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8};
    good_ = good_ && type > 0 && type < kSizes.size();
    return good_ ? kSizes[type] : 0;
  }
  std::uint64_t product(std::uint64_t a, std::uint64_t b) {
    if (b != 0 && a > kMax / b) good_ = false;
    return good_ ? a * b : 0;
  }

  std::vector<unsigned char> bytes_;
  unsigned char version_;
  std::size_t at_ = 0;
  bool good_ = true;
};

}  // namespace

bool is_cut_off_classic_netcdf(const std::filesystem::path& file) {
  std::error_code failed;
  const std::uint64_t size = std::filesystem::file_size(file, failed);
  std::ifstream input(file, std::ios::binary);
  std::vector<unsigned char> head(std::min<std::uint64_t>(failed ? 0 : size, kLongestHeader));
  input.read(reinterpret_cast<char*>(head.data()), static_cast<std::streamsize>(head.size()));
  if (!input || head.size() < 4 || std::memcmp(head.data(), "CDF", 3) != 0) return false;
  const unsigned char version = head[3];
  if (version != 1 && version != 2 && version != 5) return false;
  const auto needed = NetcdfHeader(std::move(head)).needed();
  return !needed || *needed > size;
}

}  // namespace isobath
