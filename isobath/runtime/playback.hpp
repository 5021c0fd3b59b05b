// Playback: a recording as a page looks at it: what was to be seen at any moment of it.
//
// Each page has one of its own and calls it from one thread; what is dear (the index of a file, decoded blocks) is
// better shared between them. A page that is dragged through a recording asks for another moment ten times a second,
// and all pages wait for each other: a call should take a few milliseconds, and must not wait for who records.
//
// Errors: Error where the recording cannot be read; the page is told, stands still, and may ask again.
#pragma once

#include <isobath/base/time.hpp>
#include <isobath/runtime/display_items.hpp>

namespace isobath {

/// start <= end.
struct TimeSpan {
  Time start, end;
};

class Playback {
 public:
  virtual ~Playback() = default;

  /// The first and the last moment. The end grows while the recording is still being written.
  virtual TimeSpan span() = 0;
  /// Makes of `items` what they were at a moment of the span: of each item the newest as of then, and no other. They
  /// are as the last call left them, so that going on takes only what lies between; items that stay as they were are
  /// better left alone than cleared and set again, because all that is set again is sent again.
  virtual void show(Time moment, DisplayItems& items) = 0;
  /// The moment with something new that comes `steps` after `from`, or before it if negative; at an end of the span
  /// where there are fewer. `from` need be none of them: the first step leads to the next beside it.
  virtual Time step(Time from, int steps) = 0;
};

}  // namespace isobath
