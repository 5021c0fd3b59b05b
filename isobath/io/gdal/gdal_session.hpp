// GdalSession: registers GDAL's drivers and collects GDAL's messages. While a session lives, GDAL prints nothing on
// this thread.
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
  /// The first failure, else the last warning, in one line; empty if there is neither.
  [[nodiscard]] const std::string& complaint() const { return failures_ > 0 ? first_failure_ : last_warning_; }
  void forget();
  /// Called by the error handler.
  void note(bool failure, const char* text);

 private:
  int warnings_ = 0;
  int failures_ = 0;
  std::string first_failure_;
  std::string last_warning_;
};

}  // namespace isobath
