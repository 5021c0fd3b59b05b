// replaced by the first class of this room
