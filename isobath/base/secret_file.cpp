#include <cctype>
#include <isobath/base/error.hpp>
#include <isobath/base/secret_file.hpp>
#include <isobath/base/text_file.hpp>

namespace isobath {

std::string secret_of_file(const std::string& file) {
  std::string secret = text_of_file(file);
  while (!secret.empty() && std::isspace(static_cast<unsigned char>(secret.back())) != 0) secret.pop_back();
  if (secret.empty()) throw Error("holds no secret", {file}, "one line", "make one with: openssl rand -hex 16");
  return secret;
}

}  // namespace isobath
