// msf-slam detector info|quantize|time; the other subcommands have files of their own.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <fstream>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>
#include <optional>

#include "apps/arguments.h"
#include "apps/detector_arguments.h"
#include "apps/detector_training.h"
#include "apps/image_list.h"
#include "detection/calibration.h"
#include "detection/compiled_network.h"
#include "detection/model_summary.h"
#include "detection/onnx_editor.h"
#include "detection/onnx_reader.h"
#include "detection/sensitive_values.h"
#include "evaluation/json_text.h"
#include "io/image_reader.h"
#include "util/atomic_file.h"
#include "util/progress.h"

namespace msf {
namespace {

namespace fs = std::filesystem;

void AddInfo(CLI::App& detector) {
  struct Arguments {
    std::string model;
    int width = 640, height = 640;
  };
  CLI::App* command =
      detector.add_subcommand("info", "Print a model's layers, parameters and GFLOPs");
  const auto arguments = std::make_shared<Arguments>();
  command
      ->add_option("model", arguments->model,
                   "ONNX file, or the name of a model that comes with MSF-SLAM")
      ->required();
  command->add_option("--width", arguments->width, "image width for the GFLOPs, pixels")
      ->check(NetworkSide())
      ->capture_default_str();
  command->add_option("--height", arguments->height, "image height, pixels")
      ->check(NetworkSide())
      ->capture_default_str();
  command->callback([arguments] {
    const Graph graph = Require(ReadOnnx(Require(FindModel(arguments->model))));
    std::cout << FormatSummary(Require(Summarize(graph, arguments->height, arguments->width)));
  });
}

struct QuantizeArguments {
  std::string model;
  fs::path images, list_file, out;
  int count = 200;
  CalibrationOptions options;
  SensitivityOptions sensitivity;
};

// `count` images spread evenly over all.
std::vector<fs::path> Spread(const std::vector<fs::path>& images, int count) {
  const size_t wanted = std::min(images.size(), static_cast<size_t>(count));
  std::vector<fs::path> chosen;
  for (size_t i = 0; i < wanted; ++i) chosen.push_back(images[i * images.size() / wanted]);
  return chosen;
}

ActivationRanges CalibrateWithProgress(const Graph& graph, const QuantizeArguments& arguments,
                                       const CalibrationImages& images) {
  Progress progress("quantize", "runs", 2 * images.count);
  return Require(
      Calibrate(graph, arguments.options, images, [&](int done) { progress.Update(done); }));
}

SensitiveValues CompareWithProgress(const Graph& graph, const ActivationRanges& ranges,
                                    const QuantizeArguments& arguments,
                                    const CalibrationImages& images) {
  std::optional<Progress> progress;  // the number of trials is not known before the first
  return Require(FindSensitiveValues(graph, ranges, arguments.options, arguments.sensitivity,
                                     images, [&](int done, int total) {
                                       if (!progress) progress.emplace("compare", "trials", total);
                                       progress->Update(done);
                                     }));
}

void Quantize(const QuantizeArguments& arguments) {
  DetectorOptions size;
  size.width = arguments.options.width;
  size.height = arguments.options.height;
  Require(size.Check());
  RequireWritableFile(arguments.out);
  const std::vector<fs::path> files =
      Spread(Require(FindImages(arguments.images, arguments.list_file)), arguments.count);
  const std::string bytes = Require(ReadModelBytes(Require(FindModel(arguments.model))));
  const Graph graph = Require(ParseOnnx(bytes, arguments.model));
  ImageReader reader;
  const CalibrationImages images{static_cast<int>(files.size()), [&](int i) {
                                   return reader.ReadColor(files[static_cast<size_t>(i)]);
                                 }};
  ActivationRanges ranges = CalibrateWithProgress(graph, arguments, images);
  const SensitiveValues sensitive = CompareWithProgress(graph, ranges, arguments, images);
  for (const std::string& name : sensitive.names) ranges.erase(name);
  const std::string halved = Require(HalveOnnxWeights(bytes));
  const std::string calibrated =
      Require(SetOnnxMetadata(halved, {{kActivationRangesKey, FormatActivationRanges(ranges)}}));
  Require(WriteFileAtomically(arguments.out, calibrated));
  std::cout << fmt::format("{}: {:.2f} MB, {} activation ranges from {} images\n",
                           arguments.out.string(), static_cast<double>(calibrated.size()) * 1e-6,
                           ranges.size(), images.count);
  std::cout << fmt::format(
      "not in 8 bits: {} ({:.1f} % of the multiply-adds); that brings the error of scores from "
      "{:.4f} to {:.4f}\n",
      sensitive.names.empty() ? "only the heads"
                              : fmt::format("{}", fmt::join(sensitive.names, ", ")),
      100 * sensitive.share, sensitive.error_with, sensitive.error_without);
}

void AddQuantize(CLI::App& detector) {
  CLI::App* command =
      detector.add_subcommand("quantize", "Calibrate a model on images so that it can run in int8");
  const auto arguments = std::make_shared<QuantizeArguments>();
  command
      ->add_option("model", arguments->model,
                   "ONNX file, or the name of a model that comes with MSF-SLAM")
      ->required();
  command
      ->add_option("--images", arguments->images,
                   "calibration images: folder, VOC data set or RGB-D sequence")
      ->required();
  command->add_option("--list", arguments->list_file,
                      "file that names the images to use, e.g. ImageSets/Main/trainval.txt");
  command->add_option("--count", arguments->count, "how many of them, spread evenly")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command->add_option("--width", arguments->options.width,
                      "input width, pixels (0: the model's own, or 416)");
  command->add_option("--height", arguments->options.height,
                      "input height, pixels (0: the model's own, or 320)");
  command
      ->add_option("--keep-higher", arguments->sensitivity.max_values,
                   "at most so many values inside the network, those that int8 harms most, stay in "
                   "the higher precision (0: only the heads)")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  command
      ->add_option("--higher-share", arguments->sensitivity.max_share,
                   "of the multiply-adds, at most so many may take the higher precision for that")
      ->check(NumberFrom(0, 1))
      ->capture_default_str();
  command->add_option("--out", arguments->out, "the new model file")->required();
  command->callback([arguments] { Quantize(*arguments); });
}

double ThreadCpuTimeMs() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

double ResidentMemoryMB() {
  std::ifstream statm("/proc/self/statm");
  int64_t total = 0, resident = 0;
  statm >> total >> resident;
  return static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE)) * 1e-6;
}

struct TimeArguments {
  DetectorArguments detector;
  int runs = 50;
  fs::path json_file;
};

// A picture with something to look at, of the common camera's size.
cv::Mat TestPicture() {
  cv::Mat picture(480, 640, CV_8UC3);
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      picture.at<cv::Vec3b>(y, x) = {static_cast<uchar>(x / 3), static_cast<uchar>(y / 2),
                                     static_cast<uchar>((x ^ y) & 255)};
    }
  }
  return picture;
}

void Time(TimeArguments& arguments) {
  using Clock = std::chrono::steady_clock;
  RequireWritableFile(arguments.json_file);
  // OpenCV spreads over all cores by itself; its setting is global, which only a program may touch.
  cv::setNumThreads(arguments.detector.options.threads);
  const cv::Mat picture = TestPicture();
  const double memory_before = ResidentMemoryMB(), cpu_before = ThreadCpuTimeMs();
  const Clock::time_point start = Clock::now();
  const std::unique_ptr<Detector> detector = arguments.detector.Make();
  Require(detector->DetectInImage(picture));
  const double first_wall_s = std::chrono::duration<double>(Clock::now() - start).count();
  const double first_cpu_s = (ThreadCpuTimeMs() - cpu_before) * 1e-3;
  std::vector<double> times_ms;
  for (int i = 0; i < arguments.runs; ++i) {
    const double before = ThreadCpuTimeMs();
    Require(detector->DetectInImage(picture));
    times_ms.push_back(ThreadCpuTimeMs() - before);
  }
  std::sort(times_ms.begin(), times_ms.end());
  const double median = times_ms[times_ms.size() / 2], memory = ResidentMemoryMB() - memory_before;
  std::cout << fmt::format(
      "{}: {:.2f} ms CPU per image (median of {}, fastest {:.2f}), first detection after {:.3f} s "
      "({:.3f} s CPU), {:.0f} MB\n",
      detector->description(), median, arguments.runs, times_ms.front(), first_wall_s, first_cpu_s,
      memory);
  if (arguments.json_file.empty()) return;
  const nlohmann::json json = {
      {"model", detector->description()},     {"cpu_ms_median", median},
      {"cpu_ms_least", times_ms.front()},     {"first_detection_s", first_wall_s},
      {"first_detection_cpu_s", first_cpu_s}, {"memory_MB", memory}};
  Require(WriteFileAtomically(arguments.json_file, JsonText(json)));
}

void AddTime(CLI::App& detector) {
  CLI::App* command =
      detector.add_subcommand("time", "Measure a detector's speed and memory on this machine");
  const auto arguments = std::make_shared<TimeArguments>();
  arguments->detector.AddTo(*command);
  command->add_option("--runs", arguments->runs, "images")
      ->capture_default_str()
      ->check(CLI::Range(1, 100000));
  command->add_option("--json", arguments->json_file, "file for the figures");
  command->callback([arguments] { Time(*arguments); });
}

}  // namespace

void AddDetectorEvaluateCommand(CLI::App& detector);

void AddDetectorCommands(CLI::App& app) {
  CLI::App* detector = DetectorCommand(app);
  AddInfo(*detector);
  AddDetectorEvaluateCommand(*detector);
  AddQuantize(*detector);
  AddTime(*detector);
}

}  // namespace msf
