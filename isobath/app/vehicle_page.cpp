#include <chrono>
#include <fmt/format.h>
#include <isobath/app/option_facts.hpp>
#include <isobath/app/values.hpp>
#include <isobath/app/vehicle_page.hpp>
#include <isobath/base/error.hpp>
#include <isobath/base/secret_file.hpp>
#include <thread>

namespace isobath::app {
namespace {

std::atomic<bool> interrupted{false};  // a signal may come at any time

void interrupt(int /*signal*/) { interrupted = true; }

std::vector<std::string> limit_names() {
  WebServerConfig server;
  std::vector<std::string> names;
  for (const Field& field : fields(server)) names.push_back(field.name() + "=");
  return names;
}

}  // namespace

bool is_interrupted() { return interrupted; }

void listen_for_interrupt() {
  std::signal(SIGINT, interrupt);
  std::signal(SIGTERM, interrupt);
}

void wait_for_interrupt() {
  while (!interrupted) std::this_thread::sleep_for(std::chrono::milliseconds(50));
}

void PageOptions::add_to(CLI::App& command) {
  const WebServerConfig server;
  command.add_option("--port", port, "Port; 0: any free port")
      ->check(whole(0, 65535))
      ->default_str(std::to_string(server.port))
      ->group("Page");
  command.add_option("--address", address, "Address to serve at; 0.0.0.0: all networks")
      ->type_name("ADDRESS")
      ->default_str(server.address + ", this machine only")
      ->group("Page");
  command
      .add_option(
          "--token-file", token_file,
          "File with a token; a page that sends it may command: hold, resume, abort, acknowledge alarms, plan missions")
      ->type_name("FILE")
      ->check(reads())
      ->group("Page");
  command.add_option("--limit", limits, "One limit of the server, such as max_clients=4")
      ->type_name("KEY=VALUE")
      ->check(such_as(limit_names))
      ->allow_extra_args(false)
      ->group("Page");
}

std::string PageOptions::token() const { return token_file.empty() ? std::string() : secret_of_file(token_file); }

WebServerConfig PageOptions::server() const {
  WebServerConfig server;
  std::vector<Section> sections = {{"server", "The live page's server.", fields(server)}};
  if (address) server.address = *address;
  if (port) server.port = *port;
  for (const std::string& limit : limits) {
    if (limit.find('=') == std::string::npos) throw Error("not of the form key=value", {"--limit " + limit});
    set_from_text("server." + limit, sections, "--limit");
  }
  return server;
}

/// Pages may command and plan.
void VehiclePage::take_orders() {
  sources_.command = [this](PageCommand command, const std::string& by) {
    using Kind = OperatorCommand::Kind;
    switch (command) {
      case PageCommand::kHold: return desk_.order({Kind::kHold, nullptr, by});
      case PageCommand::kResume: return desk_.order({Kind::kResume, nullptr, by});
      case PageCommand::kAbort: return desk_.order({Kind::kAbort, nullptr, by});
      case PageCommand::kAcknowledge: return desk_.order({Kind::kAcknowledge, nullptr, by});
      case PageCommand::kReturn: return desk_.order({Kind::kReturn, nullptr, by});
    }
    return std::string();
  };
  sources_.planning = {
      [this](const MissionDraft& draft, const std::string& by) { return desk_.send(draft, by); },
      [this](const MissionDraft& draft, std::uint64_t session) { return desk_.preview(draft, session); },
      [this](std::uint64_t session) { return desk_.preview_text(session); }};
  sources_.handed_over = [this](const std::string& sentence) { desk_.hand_over(sentence); };
}

std::string place_of(const WebServerConfig& config, int port) {
  const bool any = config.address == "0.0.0.0" || config.address == "::";
  const bool six = config.address.find(':') != std::string::npos && !any;
  return fmt::format("http://{}{}{}:{}/", six ? "[" : "", any ? "localhost" : config.address, six ? "]" : "", port);
}

}  // namespace isobath::app
