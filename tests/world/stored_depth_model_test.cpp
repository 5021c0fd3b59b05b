// A depth model continues a stored map, or refuses it before the run begins.
#include <cerrno>
#include <filesystem>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/map/storage/disk_file.hpp>
#include <isobath/world/depth_model.hpp>
#include <string>
#include <unistd.h>

namespace isobath {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class StoredDepthModel : public testing::Test {
 protected:
  StoredDepthModel() : folder_(fs::temp_directory_path() / ("isobath_stored_" + std::to_string(::getpid()))) {
    fs::remove_all(folder_);
    MapFacts facts;
    facts.area = {{{16, -16}, 0.5}, 6};
    RegionQuadtree sensed(6, 0), state(6, 0);
    sensed.fill({0, 0, 20, 20}, DepthPixel::word_of_depth(7));
    state.fill({0, 0, 20, 20}, DepthPixel::word_of_state(20, kSensed, 1));
    MapFolder(folder_).commit(facts, DepthTrees(RegionQuadtree(6, 0), sensed, state));
  }
  ~StoredDepthModel() override {
    set_disk_fault({});
    fs::remove_all(folder_);
  }
  [[nodiscard]] std::string refusal() const {
    try {
      const DepthModel model(WorldConfiguration{}, folder_);
      return model.continues() ? "continued" : "begun anew";
    } catch (const Error& e) {
      return e.what();
    }
  }

  fs::path folder_;
};

// ledger: S1-26
TEST_F(StoredDepthModel, RefusesAMapOfWhichATreeCannotBeOpenedAndLeavesItAsItIs) {
  for (const char* tree : {"prior.1.tree", "sensed.1.tree", "state.1.tree", "map.json"}) {
    for (const int code : {EIO, EMFILE, EACCES, ENOMEM}) {
      set_disk_fault([&](DiskCall call, const fs::path& file) {
        return call == DiskCall::kOpen && file.filename() == tree ? code : 0;
      });
      EXPECT_THAT(refusal(), HasSubstr("cannot be opened")) << tree;
    }
  }
  set_disk_fault({});
  EXPECT_EQ(refusal(), "continued");
  EXPECT_TRUE(open_map(folder_).damages.empty());
}

TEST_F(StoredDepthModel, RefusesAMapWithTheSensedDepthsUnderTheNameOfTheState) {
  fs::copy_file(folder_ / "sensed.1.tree", folder_ / "state.1.tree", fs::copy_options::overwrite_existing);
  EXPECT_THAT(refusal(), HasSubstr("not the file that was committed"));
  EXPECT_EQ(open_map(folder_).facts.generation, 1U);
}

}  // namespace
}  // namespace isobath
