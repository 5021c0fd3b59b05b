// An agent that cannot be made.
#include <isobath/mission/command/agent_library.hpp>
#include <stdexcept>

namespace {

struct Failing : isobath::Agent {
  Failing() { throw std::runtime_error("no eyes"); }
  void on_message(const isobath::Message&, isobath::Time, isobath::Outbox&) override {}
  void tick(isobath::Time, isobath::Outbox&) override {}
};

}  // namespace

ISOBATH_AGENT(Failing)
