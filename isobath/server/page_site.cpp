#include <isobath/base/error.hpp>
#include <isobath/display/live_page.hpp>
#include <isobath/server/page_site.hpp>
#include <nlohmann/json.hpp>
#include <zlib.h>

namespace isobath {
namespace {

std::string gzipped(std::string_view bytes) {
  z_stream stream{};
  constexpr int kGzip = 15 + 16;  // window bits, and a gzip header instead of zlib's
  if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, kGzip, 8, Z_DEFAULT_STRATEGY) != Z_OK) return {};
  std::string packed(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));  // it only reads
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  const bool whole = deflate(&stream, Z_FINISH) == Z_STREAM_END;
  packed.resize(whole ? stream.total_out : 0);
  deflateEnd(&stream);
  return packed;
}

double seconds_shown(const PageSources& sources) {
  if (!sources.live) return 0;
  const TimeSpan span = sources.live_span();
  return to_seconds(span.end - span.start);
}

}  // namespace

WebSite page_site(std::span<const PageSources* const> vehicles) {
  const std::string page(live_page());
  const WebFile file{"text/html; charset=utf-8", page, gzipped(page)};
  WebSite site;
  for (std::size_t v = 0; v < vehicles.size(); ++v) {
    const std::string path = v == 0 ? "/" : "/vehicle/" + std::to_string(v + 1) + "/";
    site.files[path] = file;
    site.sockets[path + "socket"] = [source = vehicles[v]] { return std::make_unique<PageSession>(*source); };
  }
  const PageSources& sources = *vehicles.front();
  site.health = [&sources] {
    return nlohmann::json{{"status", "ok"},
                          {"version", sources.version},
                          {"shows", sources.live ? "a run" : "a recording"},
                          {"run_s", seconds_shown(sources)}}
        .dump();
  };
  site.metrics = [&sources] {
    return "# HELP isobath_run_seconds Seconds since the start of the run that is shown, on its own clock.\n"
           "# TYPE isobath_run_seconds gauge\n"
           "isobath_run_seconds " +
           std::to_string(seconds_shown(sources)) + "\n";
  };
  return site;
}

}  // namespace isobath
