#include "simulation/simulator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "simulation/cast.h"
#include "util/options.h"

namespace msf {
namespace {

bool Same(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF) == 0; }

// Without noise, drift and range limits.
Scenario Perfect(const std::string& name) {
  Scenario scenario = *LoadScenario(name);
  scenario.depth.perfect = true;
  scenario.color.noise = 0;
  scenario.color.exposure_drift = 0;
  scenario.color.vignetting = 0;
  return scenario;
}

TEST(Scenario, EveryKnownOneIsValid) {
  const std::vector<std::string> names = ScenarioNames();
  for (const char* name :
       {"xyz", "rpy", "halfsphere", "static", "two_room_loop", "atlas", "walking_xyz",
        "walking_rpy", "walking_halfsphere", "walking_static", "sitting_xyz", "moving_box",
        "pushed_chair", "flying_box", "busy_office"}) {
    EXPECT_EQ(std::count(names.begin(), names.end(), name), 1) << name;
  }
  for (const std::string& name : names) {
    const StatusOr<Scenario> scenario = LoadScenario(name);
    EXPECT_TRUE(scenario.ok()) << scenario.message();
    EXPECT_EQ(scenario->name, name);
    EXPECT_FALSE(scenario->description.empty());
  }
}

TEST(Scenario, MistakesGetASentence) {
  EXPECT_NE(LoadScenario("nowhere").message().find("two_room_loop"), std::string::npos);
  Scenario scenario;
  EXPECT_FALSE(ReadOptions(YAML::Load("{actors: [{kind: walker, legs: 3}]}"), scenario).ok());
  ASSERT_TRUE(ReadOptions(YAML::Load("{actors: [{kind: walker}]}"), scenario).ok());
  EXPECT_NE(scenario.Check().message().find("stations"), std::string::npos);
  scenario = {};
  scenario.path.kind = "spiral";
  EXPECT_FALSE(Simulator::Create(scenario, 1).ok());
}

TEST(Scenario, LengthsThatNobodyCanRenderAreRefused) {
  const double nan = std::nan("");
  for (const double duration_s : {0., -1., 0.01, 1e5, 1e12, HUGE_VAL, nan}) {
    Scenario scenario;
    scenario.duration_s = duration_s;
    EXPECT_NE(scenario.Check().message().find("duration_s and fps"), std::string::npos)
        << duration_s;
  }
  for (const double fps : {0., -30., 1e9, HUGE_VAL, nan}) {
    Scenario scenario;
    scenario.fps = fps;
    EXPECT_NE(scenario.Check().message().find("duration_s and fps"), std::string::npos) << fps;
  }
  for (const double start_time_s : {1e300, -HUGE_VAL, nan}) {
    Scenario scenario;
    scenario.start_time_s = start_time_s;
    EXPECT_NE(scenario.Check().message().find("start_time_s"), std::string::npos) << start_time_s;
  }
  Scenario longest;
  longest.duration_s = 1'000'000 / longest.fps;
  EXPECT_TRUE(longest.Check().ok());
}

TEST(Simulator, SameSeedSameBytesInAnyOrder) {
  const Scenario scenario = *LoadScenario("walking_xyz");
  Simulator first = *Simulator::Create(scenario, 7), second = *Simulator::Create(scenario, 7);
  const SimulatedFrame a = first.Render(150);
  second.Render(3);
  const SimulatedFrame b = second.Render(150);
  EXPECT_TRUE(Same(a.frame->color, b.frame->color));
  EXPECT_TRUE(Same(a.frame->depth, b.frame->depth));
  EXPECT_TRUE(Same(a.mask, b.mask));
  EXPECT_EQ(a.frame->time_s, b.frame->time_s);
  EXPECT_EQ(a.T_wc.translation(), b.T_wc.translation());

  Simulator other = *Simulator::Create(scenario, 8);
  const SimulatedFrame c = other.Render(150);
  EXPECT_GT(cv::norm(a.frame->color, c.frame->color, cv::NORM_L1) / a.frame->color.total(), 20);
  EXPECT_GT((a.T_wc.translation() - c.T_wc.translation()).norm(), 1e-4);
}

TEST(Simulator, FramesAreWellFormedAndOnTime) {
  const Scenario scenario = *LoadScenario("xyz");
  Simulator simulator = *Simulator::Create(scenario, 1);
  EXPECT_EQ(simulator.num_frames(), 750);
  const SimulatedFrame simulated = simulator.Render(20);
  EXPECT_TRUE(CheckFrame(*simulated.frame).ok());
  EXPECT_EQ(simulated.frame->id, FrameId(20));
  EXPECT_EQ(cv::countNonZero(simulated.mask), 0);
  for (int i = 1; i < simulator.num_frames(); ++i) {
    EXPECT_NEAR(simulator.TimeOf(i) - simulator.TimeOf(i - 1), 1.0 / 30, 0.004);
  }
}

// A point of a surface that is seen in two frames has the same colour and the depth that its place
// demands.
TEST(Simulator, FramesAgreeWithThePoses) {
  Simulator simulator = *Simulator::Create(Perfect("xyz"), 2);
  const Camera& camera = simulator.camera();
  const SimulatedFrame a = simulator.Render(30), b = simulator.Render(75);
  ASSERT_GT((a.T_wc.translation() - b.T_wc.translation()).norm(), 0.1);
  cv::Mat smooth_a, smooth_b;
  cv::GaussianBlur(a.frame->color, smooth_a, {0, 0}, 1.5);
  cv::GaussianBlur(b.frame->color, smooth_b, {0, 0}, 1.5);
  int compared = 0, depth_agrees = 0, color_agrees = 0, color_agrees_unmoved = 0;
  for (int y = 10; y < 470; y += 7) {
    for (int x = 10; x < 630; x += 7) {
      const double z = a.frame->depth.at<uint16_t>(y, x) / camera.depth_factor;
      const Eigen::Vector3d p_b =
          b.T_wc.Inverse() * (a.T_wc * camera.Unproject({double(x), double(y)}, z));
      const Eigen::Vector2d uv_px = camera.Project(p_b);
      if (uv_px.x() < 3 || uv_px.y() < 3 || uv_px.x() > 636 || uv_px.y() > 476) continue;
      const int u = int(std::lround(uv_px.x())), v = int(std::lround(uv_px.y()));
      const auto alike = [](const cv::Vec3b& c, const cv::Vec3b& d) {
        return std::abs(c[0] - d[0]) < 16 && std::abs(c[1] - d[1]) < 16 &&
               std::abs(c[2] - d[2]) < 16;
      };
      ++compared;
      depth_agrees += std::abs(b.frame->depth.at<uint16_t>(v, u) / camera.depth_factor - p_b.z()) <
                      0.01 * p_b.z();
      color_agrees += alike(smooth_a.at<cv::Vec3b>(y, x), smooth_b.at<cv::Vec3b>(v, u));
      color_agrees_unmoved += alike(smooth_a.at<cv::Vec3b>(y, x), smooth_b.at<cv::Vec3b>(y, x));
    }
  }
  EXPECT_GT(compared, 2000);
  EXPECT_GT(depth_agrees, 0.85 * compared);  // the rest is occlusion
  EXPECT_GT(color_agrees, 0.85 * compared);
  EXPECT_LT(color_agrees_unmoved, 0.6 * compared);
}

TEST(Simulator, MasksCoverTheActorsAndNothingElse) {
  Scenario scenario = Perfect("walking_static");
  Simulator peopled = *Simulator::Create(scenario, 3);
  scenario.actors.clear();
  Simulator empty = *Simulator::Create(scenario, 3);
  EXPECT_EQ(peopled.actor_classes(), std::vector<std::string>({"person", "person"}));
  std::set<int> labels;
  for (const int index : {0, 90, 300}) {
    const SimulatedFrame with = peopled.Render(index), without = empty.Render(index);
    const cv::Mat is_static = with.mask == 0;
    cv::Mat difference;
    cv::absdiff(with.frame->depth, without.frame->depth, difference);
    EXPECT_EQ(cv::countNonZero((difference > 0) & is_static), 0);
    // A person is nearer than what it hides.
    EXPECT_EQ(cv::countNonZero((with.frame->depth >= without.frame->depth) & ~is_static), 0);
    for (const VisibleActor& actor : FindVisibleActors(with.mask)) {
      labels.insert(actor.label);
      EXPECT_GT(actor.num_pixels, 0);
      EXPECT_EQ(cv::countNonZero(with.mask == actor.label), actor.num_pixels);
      EXPECT_EQ(cv::countNonZero(with.mask(actor.box) == actor.label), actor.num_pixels);
    }
  }
  EXPECT_EQ(labels, std::set<int>({1, 2}));
}

TEST(Simulator, CarriedThingsHaveALabelOfTheirOwn) {
  Simulator simulator = *Simulator::Create(*LoadScenario("moving_box"), 1);
  EXPECT_EQ(simulator.actor_classes(), std::vector<std::string>({"person", "box", "box", "ball"}));
  std::set<int> seen;
  for (int i = 0; i < simulator.num_frames(); i += 60) {
    for (const VisibleActor& actor : FindVisibleActors(simulator.Render(i).mask))
      seen.insert(actor.label);
  }
  EXPECT_EQ(seen, std::set<int>({1, 2, 3, 4}));
}

TEST(Simulator, APushedChairIsBeforeThePusher) {
  Simulator simulator = *Simulator::Create(*LoadScenario("pushed_chair"), 1);
  EXPECT_EQ(simulator.actor_classes(), std::vector<std::string>({"person", "chair", "chair"}));
  int pictures_with_both = 0;
  for (int i = 0; i <= 75; i += 15) {  // on the way from left to right
    const std::vector<VisibleActor> visible = FindVisibleActors(simulator.Render(i).mask);
    if (visible.size() < 2 || visible[0].label != 1 || visible[1].label != 2) continue;
    ++pictures_with_both;
    const cv::Rect &person = visible[0].box, &chair = visible[1].box;
    EXPECT_GT(chair.x + chair.br().x, person.x + person.br().x) << i;
  }
  EXPECT_GE(pictures_with_both, 2);
}

TEST(Simulator, DarknessAndJumps) {
  const Scenario scenario = *LoadScenario("atlas");
  Simulator simulator = *Simulator::Create(scenario, 1);
  const SimulatedFrame before = simulator.Render(295), dark = simulator.Render(330),
                       after = simulator.Render(395);
  EXPECT_EQ(cv::countNonZero(dark.frame->depth), 0);
  EXPECT_EQ(cv::sum(dark.frame->color), cv::Scalar());
  EXPECT_GT(cv::countNonZero(before.frame->depth), 100000);
  EXPECT_GT(cv::countNonZero(after.frame->depth), 100000);
  // The camera is carried to another room in the dark.
  const double ordinary_m = 100.0 / 30 * scenario.path.speed_m_s;
  EXPECT_GT((after.T_wc.translation() - before.T_wc.translation()).norm(), 1.5 * ordinary_m);
  EXPECT_LT(before.T_wc.translation().x(), 6.2);
  EXPECT_GT(after.T_wc.translation().x(), 6.2);
  // Later it is back where it has been before the dark.
  double nearest_m = 9;
  for (int i = 920; i < simulator.num_frames(); i += 5) {
    for (int j = 0; j < 280; j += 5) {
      const Rigid3d between =
          simulator.PoseAt(simulator.TimeOf(i)).Inverse() * simulator.PoseAt(simulator.TimeOf(j));
      if (between.Angle() < 0.15) nearest_m = std::min(nearest_m, between.translation().norm());
    }
  }
  EXPECT_LT(nearest_m, 0.2);
}

TEST(Simulator, PoorLightAndBlindedDepth) {
  Scenario scenario = *LoadScenario("static");
  scenario.duration_s = 3;
  scenario.dimmings = {{1, 2, 0.2}};
  scenario.depth_gaps = {{2, 2.5}};
  EXPECT_EQ(scenario.LightAt(0.9), 1);
  EXPECT_NEAR(scenario.LightAt(1.1), 0.6, 1e-9);
  EXPECT_NEAR(scenario.LightAt(1.5), 0.2, 1e-9);
  Simulator simulator = *Simulator::Create(scenario, 1);
  const SimulatedFrame usual = simulator.Render(15), dim = simulator.Render(45),
                       blind = simulator.Render(68);
  EXPECT_NEAR(cv::mean(dim.frame->color)[1] / cv::mean(usual.frame->color)[1], 0.2, 0.04);
  EXPECT_GT(cv::countNonZero(dim.frame->depth), 100000);
  EXPECT_EQ(cv::countNonZero(blind.frame->depth), 0);
  EXPECT_GT(cv::mean(blind.frame->color)[1], 50);
  scenario.depth_gaps = {{2, 1}};
  EXPECT_FALSE(scenario.Check().ok());
}

// With a calibration that is off, what is seen lies farther from the middle than the calibration
// says.
TEST(Simulator, FocalErrorShowsInThePicturesOnly) {
  Scenario scenario = Perfect("static");
  scenario.focal_error = 0.02;
  Simulator simulator = *Simulator::Create(scenario, 1);
  EXPECT_EQ(simulator.camera().fx, 525);
  scenario.focal_error = 0;
  Simulator exact = *Simulator::Create(scenario, 1);
  const cv::Mat zoomed = simulator.Render(0).frame->depth, plain = exact.Render(0).frame->depth;
  int agree = 0, agree_unzoomed = 0;
  for (int y = 20; y < 460; y += 11) {
    for (int x = 20; x < 620; x += 11) {
      const int u = int(std::lround(319.5 + (x - 319.5) / 1.02)),
                v = int(std::lround(239.5 + (y - 239.5) / 1.02));
      agree += std::abs(zoomed.at<uint16_t>(y, x) - plain.at<uint16_t>(v, u)) < 60;
      agree_unzoomed += std::abs(zoomed.at<uint16_t>(y, x) - plain.at<uint16_t>(y, x)) < 60;
    }
  }
  EXPECT_GT(agree, 0.95 * 40 * 55);
  EXPECT_LT(agree_unzoomed, agree);
}

TEST(Simulator, GroundTruthCoversAllFramesFinely) {
  Simulator simulator = *Simulator::Create(*LoadScenario("rpy"), 1);
  const Trajectory truth = simulator.GroundTruth();
  EXPECT_LE(truth.front().time_s, simulator.TimeOf(0));
  EXPECT_GE(truth.back().time_s, simulator.TimeOf(simulator.num_frames() - 1));
  EXPECT_NEAR(static_cast<double>(truth.size()), 2500, 10);
  EXPECT_LT((truth[100].T_wc.Inverse() * simulator.PoseAt(truth[100].time_s)).Angle(), 1e-9);
}

TEST(Simulator, PicturesHaveCornersEverywhere) {
  for (const char* name : {"xyz", "two_room_loop"}) {
    Simulator simulator = *Simulator::Create(*LoadScenario(name), 1);
    int frames = 0, rich = 0, spread = 0;
    for (int i = 0; i < simulator.num_frames(); i += simulator.num_frames() / 12) {
      cv::Mat grey, corners;
      cv::cvtColor(simulator.Render(i).frame->color, grey, cv::COLOR_BGR2GRAY);
      cv::cornerMinEigenVal(grey, corners, 3);
      cv::Mat is_peak;
      cv::dilate(corners, is_peak, {});
      const cv::Mat strong = (corners >= is_peak) & (corners > 4e-4);
      int used_cells = 0;
      for (int cell = 0; cell < 48; ++cell) {
        used_cells += cv::countNonZero(strong(cv::Rect(cell % 8 * 80, cell / 8 * 80, 80, 80))) >= 4;
      }
      ++frames;
      rich += cv::countNonZero(strong) >= 1000;
      spread += used_cells >= 36;
    }
    EXPECT_GE(rich, 0.95 * frames) << name;
    EXPECT_GE(spread, 0.95 * frames) << name;
  }
}

TEST(Simulator, MotionBlurSmearsAlongTheMotion) {
  Scenario scenario = Perfect("rpy");
  Simulator sharp = *Simulator::Create(scenario, 1);
  scenario.color.blur_samples = 6;
  scenario.color.shutter_s = 0.03;
  Simulator blurred = *Simulator::Create(scenario, 1);
  const auto sharpness = [](const SimulatedFrame& simulated) {
    cv::Mat edges;
    cv::Laplacian(simulated.frame->color, edges, CV_32F);
    return cv::norm(edges, cv::NORM_L1) / static_cast<double>(edges.total());
  };
  const SimulatedFrame a = sharp.Render(100), b = blurred.Render(100);
  EXPECT_LT(sharpness(b), 0.7 * sharpness(a));
  EXPECT_TRUE(Same(a.frame->depth, b.frame->depth));
}

}  // namespace
}  // namespace msf
