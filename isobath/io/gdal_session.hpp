// GdalSession: what GDAL says stays with us. While one lives, GDAL prints nothing on this thread, its drivers are
// registered, and its complaints are kept.
#pragma once

#include <string>

namespace isobath {

class GdalSession {
 public:
  GdalSession();
  ~GdalSession();
  GdalSession(const GdalSession&) = delete;
  GdalSession& operator=(const GdalSession&) = delete;

  [[nodiscard]] int warnings() const { return warnings_; }
  [[nodiscard]] int failures() const { return failures_; }
  /// The first failure, else the last warning, in one line; empty without either.
  [[nodiscard]] const std::string& complaint() const { return failures_ > 0 ? first_failure_ : last_warning_; }
  void forget();
  /// For the handler of errors.
  void note(bool failure, const char* text);

 private:
  int warnings_ = 0;
  int failures_ = 0;
  std::string first_failure_;
  std::string last_warning_;
};

}  // namespace isobath
