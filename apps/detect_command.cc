// msf-slam detect: finds objects in images.
#include <fmt/format.h>

#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/detector_arguments.h"
#include "apps/image_list.h"
#include "apps/overlay.h"
#include "io/image_reader.h"
#include "io/png_encoder.h"
#include "util/atomic_file.h"
#include "util/progress.h"

namespace msf {
namespace {

namespace fs = std::filesystem;

struct DetectArguments {
  DetectorArguments detector;
  fs::path source, list_file, json_file, overlay_folder;
};

// [class name, score, x0, y0, x1, y1], numbers short enough to read.
nlohmann::json RowOf(const Detection& d, const std::vector<std::string>& names) {
  const auto rounded = [](float x, double step) { return std::round(x / step) * step; };
  const auto pixels = [&](float x) {
    return nlohmann::json::parse(fmt::format("{:.2f}", rounded(x, 0.01)));
  };
  return {names[static_cast<size_t>(d.class_id)],
          nlohmann::json::parse(fmt::format("{:.5f}", d.score)),
          pixels(d.box.x0),
          pixels(d.box.y0),
          pixels(d.box.x1),
          pixels(d.box.y1)};
}

void PrintRows(const std::string& stem, const Detections& detections,
               const std::vector<std::string>& names) {
  for (const Detection& d : detections.objects) {
    std::cout << fmt::format("{} {} {:.3f} {:.1f} {:.1f} {:.1f} {:.1f}\n", stem,
                             names[static_cast<size_t>(d.class_id)], d.score, d.box.x0, d.box.y0,
                             d.box.x1, d.box.y1);
  }
}

void Detect(DetectArguments& arguments) {
  const std::vector<fs::path> images = Require(FindImages(arguments.source, arguments.list_file));
  const std::unique_ptr<Detector> detector = arguments.detector.Make();
  std::cerr << detector->description() << "\n";
  if (!arguments.overlay_folder.empty()) {
    std::error_code failure;
    fs::create_directories(arguments.overlay_folder, failure);
    if (failure)
      throw CommandFailure(arguments.overlay_folder.string() +
                           ": cannot be made: " + failure.message());
  }
  nlohmann::json json = nlohmann::json::object();
  ImageReader reader;
  Progress progress("detect", "images", static_cast<int>(images.size()));
  for (size_t i = 0; i < images.size(); ++i) {
    const cv::Mat image = Require(reader.ReadColor(images[i]));
    const Detections detections = Require(detector->DetectInImage(image));
    const std::string stem = images[i].stem().string();
    if (arguments.json_file.empty()) PrintRows(stem, detections, detector->class_names());
    json[stem] = nlohmann::json::array();
    for (const Detection& d : detections.objects)
      json[stem].push_back(RowOf(d, detector->class_names()));
    if (!arguments.overlay_folder.empty()) {
      const cv::Mat drawn = DrawDetections(image, detections.objects, detector->class_names());
      Require(WriteFileAtomically(arguments.overlay_folder / (stem + ".png"), EncodePng(drawn)));
    }
    progress.Update(static_cast<int>(i) + 1);
  }
  if (!arguments.json_file.empty())
    Require(WriteFileAtomically(arguments.json_file, json.dump() + "\n"));
}

}  // namespace

void AddDetectCommand(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("detect", "Find objects in an image, a folder of images or a data set");
  const auto arguments = std::make_shared<DetectArguments>();
  command->add_option("source", arguments->source, "image, folder, VOC data set or RGB-D sequence")
      ->required();
  arguments->detector.held = "any";
  arguments->detector.mirrored = true;
  arguments->detector.AddForPictures(*command);
  command->add_option("--list", arguments->list_file,
                      "file that names the wanted images by their stems, one per line");
  command->add_option("--confidence", arguments->detector.options.confidence, "least score")
      ->capture_default_str();
  command->add_option(
      "--json", arguments->json_file,
      "write {image stem: [[class, score, x0, y0, x1, y1], ...]}, pixels of the original image");
  command->add_option("--overlay", arguments->overlay_folder,
                      "folder for copies of the images with the boxes drawn in");
  command->callback([arguments] { Detect(*arguments); });
}

}  // namespace msf
