#include "util/progress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace msf {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;

// A clock that is set by hand and the lines that were written.
struct Stage {
  std::chrono::steady_clock::time_point now;
  std::vector<std::string> lines;
  Progress::Surroundings Surroundings(bool is_terminal) {
    return {[this](const std::string& text) { lines.push_back(text); }, [this] { return now; },
            is_terminal};
  }
};

TEST(Progress, ALogGetsALineEveryTenSecondsAndAtTheEnd) {
  Stage stage;
  {
    Progress progress("run", "frames", 300, stage.Surroundings(false));
    for (int i = 1; i <= 300; ++i) {
      stage.now += milliseconds(100);
      progress.Update(i);
    }
  }
  EXPECT_THAT(stage.lines, ElementsAre("run: 100/300 frames, 10.0/s, 0:20 left\n",
                                       "run: 200/300 frames, 10.0/s, 0:10 left\n",
                                       "run: 300/300 frames, 10.0/s, 0:00 left\n"));
}

TEST(Progress, ATerminalsLineIsRewrittenAndEnded) {
  Stage stage;
  {
    Progress progress("run", "frames", 1000, stage.Surroundings(true));
    stage.now += milliseconds(100);
    progress.Update(1);  // too early
    stage.now += milliseconds(900);
    progress.Update(10);
    stage.now += milliseconds(99'000);
    progress.Update(1000);
  }
  EXPECT_THAT(stage.lines, ElementsAre("\rrun: 10/1000 frames, 10.0/s, 1:39 left",
                                       "\rrun: 1000/1000 frames, 10.0/s, 0:00 left", "\n"));
}

TEST(Progress, AnUnknownTotalHasNoTimeLeft) {
  Stage stage;
  Progress progress("read", "images", 0, stage.Surroundings(false));
  stage.now += milliseconds(20'000);
  progress.Update(30);
  EXPECT_THAT(stage.lines, ElementsAre("read: 30 images, 1.5/s\n"));
}

}  // namespace
}  // namespace msf
