#include <fmt/format.h>
#include <isobath/app/config_options.hpp>
#include <isobath/app/progress.hpp>
#include <isobath/base/error.hpp>
#include <isobath/io/native_log.hpp>
#include <isobath/io/open.hpp>
#include <memory>

namespace isobath::app {
namespace {

struct Options {
  ConfigOptions config;
  std::filesystem::path input, output;
};

int act(const Options& options) {
  if (options.output.extension() != ".mcap") {
    throw Error("cannot write this kind of file", {options.output.string(), {}, {}, {}, {}},
                "a name that ends in .mcap");
  }
  const auto source = open_source(options.input, options.config.read().input);
  NativeLogWriter log(options.output);
  log.set_details(source->report().details);
  const bool place_known = source->report().origin.has_value();
  if (place_known) log.set_origin(*source->report().origin);
  ProgressLine progress;
  std::uint64_t events = 0;
  while (const auto event = source->next()) {
    if (log.write(*event)) ++events;
    progress.show(source->report().bytes_read, source->report().bytes_total, events);
  }
  if (!place_known && source->report().origin) log.set_origin(*source->report().origin);
  log.close();
  progress.clear();
  fmt::print("{} events written to {}\n", events, options.output.string());
  if (source->report().bytes_skipped > 0)
    fmt::print("{} bytes of the input were skipped\n", source->report().bytes_skipped);
  return kSuccess;
}

}  // namespace

Action add_convert(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      program.add_subcommand("convert", "Any log to the native log (MCAP), which other viewers open too");
  command->add_option("IN", options->input, "Log, or folder of frames")->required();
  command->add_option("OUT", options->output, "File to write, .mcap")->required();
  options->config.add_to(*command);
  return [options] { return act(*options); };
}

}  // namespace isobath::app
