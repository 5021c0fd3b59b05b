// An agent of a library of its own: answers a task call with as many hazards as its number says.
#include <isobath/mission/command/agent_library.hpp>

namespace {

struct Lookout : isobath::Agent {
  void on_message(const isobath::Message& message, isobath::Time, isobath::Outbox& out) override {
    const auto* task = std::get_if<isobath::TaskCall>(&message);
    if (task) out.say(isobath::ChartedHazards{std::make_shared<std::vector<isobath::Hazard>>(task->id)});
  }
  void tick(isobath::Time, isobath::Outbox&) override {}
};

}  // namespace

ISOBATH_AGENT(Lookout)
