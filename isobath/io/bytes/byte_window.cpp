#include <algorithm>
#include <cstring>
#include <isobath/base/file_access.hpp>
#include <isobath/io/bytes/byte_window.hpp>

namespace isobath {
namespace {
namespace fs = std::filesystem;

constexpr std::size_t kBlock = std::size_t{1} << 20;

}  // namespace

ByteWindow::ByteWindow(std::string name, Bytes bytes, std::shared_ptr<const void> owner)
    : name_(std::move(name)), size_(bytes.size()), view_(bytes), owner_(std::move(owner)), ended_(true) {}

ByteWindow ByteWindow::open(const fs::path& file) {
  std::error_code failed;
  const fs::file_status status = fs::status(file, failed);
  if (!fs::exists(status)) throw Error("no such file", {file.string()});
  if (fs::is_directory(status)) throw Error("is a folder, not a file", {file.string()});
  check_is_file_or_folder(file);
  ByteWindow window(file.string(), {}, nullptr);
  window.file_.reset(std::fopen(file.c_str(), "rb"));
  if (!window.file_) throw Error("cannot be read", {file.string()}, {}, "check its permissions");
  std::setvbuf(window.file_.get(), nullptr, _IONBF, 0);  // blocks are large; a second buffer would only add copies
  window.size_ = fs::file_size(file, failed);
  if (failed) window.size_ = 0;
  window.ended_ = false;
  if (window.want(1).empty()) throw Error("is empty", {file.string()});
  return window;
}

Bytes ByteWindow::want(std::size_t count) {
  if (view_.size() < count && !ended_) refill(count);
  return view_;
}

void ByteWindow::advance(std::size_t count) {
  ISOBATH_ASSERT(count <= view_.size());
  view_ = view_.subspan(count);
  position_ += count;
}

// Makes a new block: the rest of the old one, then as much of the file as fits.
void ByteWindow::refill(std::size_t count) {
  // Half a block more than wanted, so that a search that wants this much at every step rarely copies.
  std::size_t capacity = std::max(count + kBlock / 2, kBlock);
  if (size_ > 0) capacity = static_cast<std::size_t>(std::min<std::uint64_t>(capacity, size_ - position_));
  if (capacity <= view_.size()) {
    ended_ = true;
    return;
  }
  auto block = std::make_shared_for_overwrite<std::byte[]>(capacity);
  std::copy(view_.begin(), view_.end(), block.get());
  const std::size_t wanted = capacity - view_.size();
  const std::size_t got = std::fread(block.get() + view_.size(), 1, wanted, file_.get());
  ended_ = got < wanted;
  view_ = Bytes(block.get(), view_.size() + got);
  owner_ = std::move(block);
}

}  // namespace isobath
