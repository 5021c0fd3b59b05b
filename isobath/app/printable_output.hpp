// Makes everything printable that the program writes to standard output (base/printable_text.hpp), whichever command
// writes it: titles, names and reasons come from files, and a terminal obeys what they hold.
//
// Standard output becomes a stream that passes text on to the former one, with lines and tabs kept. Text that is
// printable keeps its bytes. JSON has lost nothing by then: json_text() writes such characters as \uXXXX.
#pragma once

namespace isobath::app {

/// Once, before the first output. Where no stream can be made, standard output stays as it is.
void make_output_printable();

}  // namespace isobath::app
