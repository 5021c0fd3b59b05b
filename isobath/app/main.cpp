#include <cstdio>
#include <exception>
#include <isobath/app/commands.hpp>
#include <isobath/app/printable_output.hpp>
#include <isobath/app/usage.hpp>
#include <isobath/base/printable_text.hpp>

int main(int argc, char** argv) {
  try {
    isobath::app::make_output_printable();
    return isobath::app::run_program(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "isobath: %s\n", isobath::printable_text(e.what()).c_str());
  } catch (...) {
    std::fputs("isobath: an unknown error\n", stderr);
  }
  return isobath::app::kBadInput;
}
