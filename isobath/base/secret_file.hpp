// secret_of_file: a token or a passphrase, which the command line would show to every user of the machine.
#pragma once

#include <string>

namespace isobath {

/// What a text file holds, without the white space at its end. Throws Error where that is nothing, and as text_of_file.
std::string secret_of_file(const std::string& file);

}  // namespace isobath
