#include <algorithm>
#include <isobath/display/display_bytes.hpp>
#include <isobath/display/display_state.hpp>
#include <isobath/server/packed_records.hpp>
#include <zlib.h>

namespace isobath {

std::string packed(std::string_view bytes, Packing packing, int level) {
  z_stream stream{};
  const int window = packing == Packing::kGzip ? 15 + 16 : 15;  // 16: the header of gzip instead of that of zlib
  if (deflateInit2(&stream, level, Z_DEFLATED, window, 8, Z_DEFAULT_STRATEGY) != Z_OK) return {};
  std::string out(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));  // it only reads
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  const bool whole = deflate(&stream, Z_FINISH) == Z_STREAM_END;
  out.resize(whole ? stream.total_out : 0);
  deflateEnd(&stream);
  return out;
}

void PackedRecords::append_slice(std::string& out, std::size_t max_bytes, Time time) {
  const std::size_t n = std::min(left(), max_bytes);
  DisplayBytes slice;
  slice.add(static_cast<std::uint32_t>(sent)).add(static_cast<std::uint32_t>(bytes.size()));
  std::string payload = slice.take();
  payload.append(bytes, sent, n);
  append_record(out, DisplayKind::kPacked, static_cast<std::uint64_t>(channel), time, payload);
  sent += n;
}

}  // namespace isobath
