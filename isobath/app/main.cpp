#include <cstdio>
#include <exception>
#include <isobath/app/commands.hpp>
#include <isobath/app/usage.hpp>

int main(int argc, char** argv) {
  try {
    return isobath::app::run_program(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "isobath: %s\n", e.what());
  } catch (...) {
    std::fputs("isobath: an unknown error\n", stderr);
  }
  return isobath::app::kBadInput;
}
