// Writes docs/detection-delay.md and its picture: detection_delay_page PAGE PICTURE.
#include <cstdio>
#include <isobath/base/error.hpp>
#include <isobath/base/pending_file.hpp>
#include <tests/studies/detection_delay.hpp>

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: %s PAGE PICTURE\n", argv[0]);
    return 2;
  }
  try {
    const std::vector<isobath::DetectionDelay> rows = isobath::measure_delays({});
    isobath::write_whole_file(argv[1], isobath::test::delay_page(rows));
    isobath::write_whole_file(argv[2], isobath::delay_picture(rows));
  } catch (const isobath::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
