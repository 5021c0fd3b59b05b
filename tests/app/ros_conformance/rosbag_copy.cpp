// Copies a bag with librosbag_storage, so that the copy is a bag which the library of ROS 1 wrote:
//   rosbag_copy IN OUT none|bz2|lz4 [TOPIC_PREFIX_TO_LEAVE_OUT]
// Prints a line for each topic: name, type, md5 of its type, messages. Exits with 1 where the library refuses.
#include <cstdio>
#include <exception>
#include <map>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <string>

int main(int count, char** words) {
  if (count < 4) return 2;
  const std::string compression = words[3], without = count > 4 ? words[4] : "";
  try {
    rosbag::Bag in(words[1], rosbag::bagmode::Read), out(words[2], rosbag::bagmode::Write);
    out.setCompression(compression == "bz2"   ? rosbag::compression::BZ2
                       : compression == "lz4" ? rosbag::compression::LZ4
                                              : rosbag::compression::Uncompressed);
    std::map<std::string, int> messages;
    rosbag::View view(in);
    for (const rosbag::MessageInstance& m : view) {
      if (!without.empty() && m.getTopic().compare(0, without.size(), without) == 0) continue;
      out.write(m.getTopic(), m.getTime(), m, m.getConnectionHeader());
      ++messages[m.getTopic() + " " + m.getDataType() + " " + m.getMD5Sum()];
    }
    out.close();
    for (const auto& topic : messages) std::printf("%s %d\n", topic.first.c_str(), topic.second);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
  return 0;
}
