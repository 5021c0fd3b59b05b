#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <isobath/links/hub_link.hpp>
#include <system_error>
#include <termios.h>
#include <unistd.h>

namespace isobath {
namespace {

namespace fs = std::filesystem;

/// The path is a symbolic link to the end that others open as a serial device; what is written while that end does not
/// read is dropped, as on a serial line.
class PtyLink final : public StreamLink<net::posix::stream_descriptor> {
 public:
  using StreamLink::StreamLink;
  ~PtyLink() override { let_go(); }
  PtyLink(const PtyLink&) = delete;
  PtyLink& operator=(const PtyLink&) = delete;

  void open() override {
    const int master = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    std::array<char, 128> name{};
    if (master < 0 || ::grantpt(master) != 0 || ::unlockpt(master) != 0 ||
        ::ptsname_r(master, name.data(), name.size()) != 0) {
      if (master >= 0) ::close(master);
      return lose("no pseudo-terminal");
    }
    stream_.assign(master);
    other_end_ = ::open(name.data(), O_RDWR | O_NOCTTY);  // kept open: else the terminal hangs up with each client
    termios raw{};
    if (other_end_ < 0 || ::tcgetattr(other_end_, &raw) != 0) return lose("no pseudo-terminal");
    ::cfmakeraw(&raw);
    ::tcsetattr(other_end_, TCSANOW, &raw);
    std::error_code fault;
    if (fs::is_symlink(address_.host, fault)) fs::remove(address_.host, fault);
    fs::create_symlink(name.data(), address_.host, fault);
    if (fault) return lose(address_.host + ": " + fault.message());
    begin();
  }
  void close() override {
    StreamLink::close();
    let_go();
  }

 private:
  void transmit(const std::vector<std::byte>& bytes) override {
    const ssize_t written = ::write(stream_.native_handle(), bytes.data(), bytes.size());
    if (written < static_cast<ssize_t>(bytes.size())) {
      dropped_ += bytes.size() - static_cast<std::size_t>(std::max<ssize_t>(0, written));
    }
    net::post(context_, [self = shared_from_this(), this, life = life_] {
      if (life == life_) sent({});
    });
  }
  void let_go() {
    if (other_end_ < 0) return;
    ::close(other_end_);
    other_end_ = -1;
    std::error_code ignored;
    if (fs::is_symlink(address_.host, ignored)) fs::remove(address_.host, ignored);
  }

  int other_end_ = -1;
};

}  // namespace

std::shared_ptr<HubLink> make_pty_link(net::io_context& context, const HubClock& clock, const LinkAddress& address,
                                       ByteReceiver& receiver) {
  return std::make_shared<PtyLink>(context, clock, address, receiver);
}

}  // namespace isobath
