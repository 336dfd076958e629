#include "detection/detector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "detection/class_names.h"
#include "detection/head_decoder.h"
#include "detection/letterbox.h"
#include "detection/onednn_detector.h"
#include "detection/test_networks.h"

namespace msf {
namespace {

namespace fs = std::filesystem;

fs::path Write(const std::string& name, const std::string& content) {
  fs::path file = fs::path(testing::TempDir()) / name;
  std::ofstream(file, std::ios::binary) << content;
  return file;
}

cv::Mat Picture(int width, int height) {
  cv::Mat picture(height, width, CV_8UC3);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      picture.at<cv::Vec3b>(y, x) = {static_cast<uchar>(x * 2), static_cast<uchar>(y * 3),
                                     static_cast<uchar>(x ^ y)};
    }
  }
  return picture;
}

TEST(Letterbox, CentresAndMapsBoxesBack) {
  const Letterbox letterbox({640, 480}, {416, 320});  // scaled by 0.65 to 416 x 312
  const ImageBox box = letterbox.ToNetwork({100, 100, 200, 300});
  EXPECT_NEAR(box.x0, 65, 1e-3);
  EXPECT_NEAR(box.y0, 65 + 4, 1e-3);
  const ImageBox back = letterbox.ToImage(box);
  EXPECT_NEAR(back.y1, 300, 1e-3);
  EXPECT_FLOAT_EQ(letterbox.ToImage({-50, -50, 1000, 1000}).x1, 640);  // cut at the image
  std::vector<uint8_t> pixels(416 * 320 * 3);
  letterbox.Fill(cv::Mat(480, 640, CV_8UC3, cv::Scalar(10, 20, 30)), pixels.data());
  EXPECT_EQ(pixels[0], 114);
  EXPECT_EQ(pixels[4 * 416 * 3], 30);  // red first
  EXPECT_EQ(pixels[4 * 416 * 3 + 2], 10);
}

TEST(ClassNames, InAllForms) {
  EXPECT_EQ(ParseClassNames(R"(["person", "dog"])").value(),
            (std::vector<std::string>{"person", "dog"}));
  EXPECT_EQ(ParseClassNames("{0: 'person', 1: \"traffic light\"}").value(),
            (std::vector<std::string>{"person", "traffic light"}));
  for (const char* damaged :
       {"", "{0: 'person'", "{1: 'person'}", "{0: person}", "[1, 2]", "{0: 'a' 1: 'b'}", "{0"}) {
    EXPECT_FALSE(ParseClassNames(damaged).ok()) << damaged;
  }
  EXPECT_EQ(ReadClassNames(Write("names.txt", "person\r\ndog\n\n")).value().size(), 2u);
  EXPECT_FALSE(ReadClassNames(Write("gap.txt", "person\n\ndog\n")).ok());
  EXPECT_FALSE(ReadClassNames(Write("empty.txt", "\n")).ok());
  EXPECT_EQ(MatchClasses({"airplane", "Sofa", "zebra"}, {"sofa", "aeroplane"}),
            (std::vector<int>{1, 0, -1}));
}

TEST(DetectorOptions, ThreadsAreCounted) {
  DetectorOptions options;
  for (const int threads : {-1, 0, 257, 1000000}) {
    options.threads = threads;
    EXPECT_NE(options.Check().message().find("1 to 256"), std::string::npos) << threads;
  }
  options.threads = 256;
  EXPECT_TRUE(options.Check().ok());
}

// Raw heads for a 32 x 32 image: 4 x 4, 2 x 2 and 1 cells. All sides point at bin `bin`, scores are
// low.
struct Heads {
  explicit Heads(size_t bin) {
    for (const int64_t stride : {8, 16, 32}) {
      const int64_t n = 32 / stride;
      storage.push_back(std::vector<float>(static_cast<size_t>(64 * n * n), 0.0f));
      for (size_t p = 0; p < static_cast<size_t>(n * n); ++p) {
        for (size_t side = 0; side < 4; ++side) storage.back()[p * 64 + side * 16 + bin] = 50;
      }
      storage.push_back(std::vector<float>(static_cast<size_t>(2 * n * n), -9.0f));
      outputs.push_back({"box_" + std::to_string(stride), {1, 64, n, n}, true, nullptr});
      outputs.push_back({"class_" + std::to_string(stride), {1, 2, n, n}, true, nullptr});
    }
    for (size_t i = 0; i < 6; ++i) outputs[i].data = storage[i].data();
  }
  std::vector<std::vector<float>> storage;
  std::vector<NetworkOutput> outputs;
};

TEST(HeadDecoder, RawHeadsByHand) {
  Heads heads(1);
  heads.storage[3][2 * 2 + 1] = 2;  // class 1 in the lower left cell of stride 16
  const HeadDecoder decoder = HeadDecoder::Make(heads.outputs, "test").value();
  EXPECT_EQ(decoder.num_classes(), 2);
  const std::vector<Detection> found = decoder.Decode(heads.outputs, 0.25f, false);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].class_id, 1);
  EXPECT_NEAR(found[0].score, 1 / (1 + std::exp(-2.0)), 1e-6);
  // Centre (8, 24), one stride to every side.
  EXPECT_NEAR(found[0].box.x0, -8, 1e-4);
  EXPECT_NEAR(found[0].box.y0, 8, 1e-4);
  EXPECT_NEAR(found[0].box.x1, 24, 1e-4);
  EXPECT_NEAR(found[0].box.y1, 40, 1e-4);
}

TEST(HeadDecoder, OneOrEveryClass) {
  Heads heads(1);
  heads.storage[5] = {1, 2};
  const HeadDecoder decoder = HeadDecoder::Make(heads.outputs, "test").value();
  EXPECT_EQ(decoder.Decode(heads.outputs, 0.25f, true).size(), 2u);
  ASSERT_EQ(decoder.Decode(heads.outputs, 0.25f, false).size(), 1u);
  EXPECT_EQ(decoder.Decode(heads.outputs, 0.25f, false)[0].class_id, 1);
}

TEST(HeadDecoder, SingleOutputByHand) {
  // 1 class, 6 boxes; rows: centre x, y, width, height, score.
  std::vector<float> data(5 * 6, 0.0f);
  const float box[] = {20, 30, 8, 4, 0.75f};
  for (size_t i = 0; i < 5; ++i) data[i * 6 + 3] = box[i];
  const std::vector<NetworkOutput> outputs{{"output0", {1, 5, 6}, false, data.data()}};
  const std::vector<Detection> found =
      HeadDecoder::Make(outputs, "test").value().Decode(outputs, 0.5f, false);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_FLOAT_EQ(found[0].score, 0.75f);
  EXPECT_FLOAT_EQ(found[0].box.x0, 16);
  EXPECT_FLOAT_EQ(found[0].box.y1, 32);
}

TEST(HeadDecoder, RefusesOtherNetworks) {
  const StatusOr<HeadDecoder> decoder =
      HeadDecoder::Make({{"logits", {1, 1000}, false, nullptr}}, "net.onnx");
  ASSERT_FALSE(decoder.ok());
  EXPECT_NE(decoder.message().find("net.onnx"), std::string::npos);
  EXPECT_NE(decoder.message().find("logits 1x1000"), std::string::npos);
  Heads heads(1);
  heads.outputs[2].shape = {1, 64, 4, 4};
  EXPECT_FALSE(HeadDecoder::Make(heads.outputs, "test").ok());
}

DetectorOptions OptionsFor(const fs::path& model, const std::string& backend = "onednn") {
  DetectorOptions options;
  options.model = model.string();
  options.backend = backend;
  options.precision = "fp32";
  options.width = 96;
  options.height = 64;
  options.confidence = 0.3;
  return options;
}

void ExpectSameDetections(const fs::path& model, DetectorOptions options) {
  // Which of two equal boxes stays, or keeps its score, is chance.
  options.max_iou = 1;
  options.overlap_decay = 0;
  const auto onednn = MakeDetector(options).value();
  options.backend = "opencv";
  const auto opencv = MakeDetector(options).value();
  const Detections a = onednn->DetectInImage(Picture(120, 70)).value(),
                   b = opencv->DetectInImage(Picture(120, 70)).value();
  ASSERT_GT(a.objects.size(), 3u) << "random weights found nothing in " << model;
  ASSERT_EQ(a.objects.size(), b.objects.size());
  for (const Detection& d : a.objects) {  // equal scores may come in another order
    const bool found = std::any_of(b.objects.begin(), b.objects.end(), [&](const Detection& other) {
      return other.class_id == d.class_id && std::abs(other.score - d.score) < 1e-3f &&
             std::abs(other.box.x0 - d.box.x0) + std::abs(other.box.y0 - d.box.y0) < 0.5f &&
             std::abs(other.box.x1 - d.box.x1) + std::abs(other.box.y1 - d.box.y1) < 0.5f;
    });
    EXPECT_TRUE(found) << "score " << d.score;
  }
}

TEST(Detector, BackendsAgreeOnRawHeads) {
  TestNetworkOptions network;
  network.msf = true;
  const fs::path model = Write("raw.onnx", TestNetwork(network).builder().Bytes());
  ExpectSameDetections(model, OptionsFor(model));
}

TEST(Detector, OverlappingDetectionsLoseScore) {
  const fs::path model = Write("overlaps.onnx", TestNetwork({}).builder().Bytes());
  DetectorOptions options = OptionsFor(model);
  options.overlap_decay = 0;
  const Detections kept = MakeDetector(options).value()->DetectInImage(Picture(120, 70)).value();
  options.overlap_decay = 0.5;
  const Detections lowered = MakeDetector(options).value()->DetectInImage(Picture(120, 70)).value();
  const auto sum = [](const Detections& detections) {
    double scores = 0;
    for (const Detection& d : detections.objects) scores += d.score;
    return scores;
  };
  EXPECT_LT(sum(lowered), sum(kept));
  for (const Detection& d : lowered.objects) EXPECT_GE(d.score, options.confidence);
}

TEST(Detector, ReadsACommonExportWithClassesFile) {
  TestNetworkOptions network;
  network.single_output = true;
  network.attention = true;
  network.height = 64;
  network.width = 96;
  const fs::path model = Write("single.onnx", TestNetwork(network).builder().Bytes());
  DetectorOptions options = OptionsFor(model);
  options.width = options.height = 0;  // the model's own
  options.classes = Write("three.txt", "person\ndog\ncar\n").string();
  const auto detector = MakeDetector(options).value();
  EXPECT_EQ(detector->input_size(), cv::Size(96, 64));
  EXPECT_EQ(detector->class_names()[2], "car");
  EXPECT_TRUE(detector->DetectInImage(Picture(50, 50)).ok());
  options.width = 128;
  options.height = 64;
  EXPECT_NE(MakeDetector(options).message().find("exported for images of 96x64 only"),
            std::string::npos);
}

TEST(Detector, SaysWhatIsWrong) {
  TestNetwork network{{}};
  network.builder().Metadata("names", R"(["person", "dog"])");
  const fs::path model = Write("two_names.onnx", network.builder().Bytes());
  EXPECT_NE(MakeDetector(OptionsFor(model)).message().find("3 classes but"), std::string::npos);
  EXPECT_NE(MakeDetector(OptionsFor("nowhere.onnx")).message().find("nowhere.onnx"),
            std::string::npos);
  DetectorOptions options = OptionsFor(model);
  options.width = 100;
  EXPECT_NE(MakeDetector(options).message().find("multiple of 32"), std::string::npos);
  options = OptionsFor(model);
  options.precision = "int8";
  options.classes = Write("three.txt", "a\nb\nc\n").string();
  EXPECT_NE(MakeDetector(options).message().find("quantize"), std::string::npos);
  options.precision = "fp32";
  const auto detector = MakeDetector(options).value();
  EXPECT_FALSE(detector->DetectInImage(cv::Mat()).ok());
  EXPECT_FALSE(detector->DetectInImage(cv::Mat(9, 9, CV_16UC1)).ok());
  EXPECT_TRUE(detector->DetectInImage(cv::Mat(9, 9, CV_8UC1, cv::Scalar(7))).ok());
}

TEST(Detector, FrameIdAndTimeComeAlong) {
  const fs::path model = Write("raw2.onnx", TestNetwork({}).builder().Bytes());
  const auto detector = MakeDetector(OptionsFor(model)).value();
  RgbdFrame frame;
  frame.id = FrameId(7);
  frame.time_s = 1.5;
  frame.color = Picture(96, 64);
  const Detections detections = detector->Detect(frame).value();
  EXPECT_EQ(detections.frame, FrameId(7));
  EXPECT_EQ(detections.time_s, 1.5);
}

TEST(FindModel, LooksIntoTheDataFolder) {
  const fs::path data = fs::path(testing::TempDir()) / "data";
  fs::create_directories(data / "models");
  std::ofstream(data / "models" / "special.onnx") << "x";
  EXPECT_FALSE(FindModel("special.onnx").ok());
  setenv("MSF_SLAM_DATA", data.c_str(), 1);
  EXPECT_EQ(FindModel("special.onnx").value(), data / "models" / "special.onnx");
  unsetenv("MSF_SLAM_DATA");
}

}  // namespace
}  // namespace msf
