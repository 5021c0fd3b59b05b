// Playback: a recording as the page plays it: the items of the page at any moment of the recording.
//
// Each page has its own Playback and calls it from one thread. Implementations should share costly parts (the index of
// a file, decoded blocks) between pages. A page whose user drags the timeline asks for another moment ten times a
// second, and all pages wait for each other. A call should therefore take a few milliseconds, and it must not wait for
// the recorder.
//
// Errors: a call throws Error if the recording cannot be read. The page shows the error, stands still, and may ask
// again.
#pragma once

#include <isobath/base/time.hpp>
#include <isobath/display/display_state.hpp>

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
  /// Sets `items` to their state at a moment of the span: the newest version of each item at that moment, and no other
  /// items. `items` come as the last call left them, so going forward needs only the changes in between. Leave items
  /// that do not change as they are: an item that is set again is sent again.
  virtual void show(Time moment, DisplayState& items) = 0;
  /// Moments are the times at which an item changes. Returns the moment that is `steps` moments after `from`, or before
  /// it if negative; an end of the span if there are fewer. `from` itself need not be a moment: the first step then
  /// leads to the nearest one in that direction.
  virtual Time step(Time from, int steps) = 0;
};

}  // namespace isobath
